//! Missing samples of a run: how many there are, and which rows are complete without them.

use super::Run;
use std::ops::Range;

impl Run<'_> {
    /// Number of samples that lack the input or the output.
    pub fn missing(&self) -> usize {
        self.missing_samples().count()
    }

    /// Samples that lack the input or the output, with their values. Most blocks lack none, and to see that costs a fraction of a
    /// look at each sample.
    fn missing_samples(&self) -> impl Iterator<Item = (usize, f64, f64)> {
        const BLOCK: usize = 64;
        let has_gap = |values: &[f64]| values.iter().fold(false, |gap, value| gap | value.is_nan());
        let blocks = self.input.chunks(BLOCK).zip(self.output.chunks(BLOCK));
        let blocks = (0..).step_by(BLOCK).zip(blocks);
        let with_gaps = blocks.filter(move |(_, (u, y))| has_gap(u) || has_gap(y));
        let samples = with_gaps.flat_map(|(first, (u, y))| (first..).zip(u.iter().zip(y)));
        let samples = samples.map(|(k, (u, y))| (k, *u, *y));
        samples.filter(|(_, u, y)| u.is_nan() || y.is_nan())
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
        for (k, u, y) in self.missing_samples() {
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
