//! Missing samples of a run: how many there are, and which rows are complete without them.

use super::Run;
use std::ops::Range;

impl Run<'_> {
    /// Number of samples that lack the input or the output.
    pub fn missing(&self) -> usize {
        self.input
            .iter()
            .zip(self.output.iter())
            .filter(|(u, y)| u.is_nan() || y.is_nan())
            .count()
    }

    /// The longest stretches of complete rows. Row k is complete when the output is known from
    /// k-`output_lags`+1 to k and the input from k-`input_lags`+1 to k. Before the first sample only the
    /// input is known, and only when the run began at rest.
    pub fn complete_rows(&self, input_lags: usize, output_lags: usize) -> Vec<Range<usize>> {
        let mut spans = Vec::new();
        let (inputs, outputs) = (input_lags.max(1), output_lags.max(1));
        let history = if self.at_rest.is_some() {
            0
        } else {
            inputs - 1
        };
        // The first row whose history no earlier gap interrupts.
        let mut from = history.max(outputs - 1);
        let samples = self.input.iter().zip(self.output.iter()).enumerate();
        for (k, (u, y)) in samples.filter(|(_, (u, y))| u.is_nan() || y.is_nan()) {
            if from < k {
                spans.push(from..k);
            }
            for (missing, lags) in [(u.is_nan(), inputs), (y.is_nan(), outputs)] {
                if missing {
                    from = from.max(k + lags);
                }
            }
        }
        if from < self.len() {
            spans.push(from..self.len());
        }
        spans
    }
}
