//! What a fit makes of the input of a record, beside what was measured: the tests of the errors look at
//! the beginning of it.

use std::borrow::Cow;

use crate::convolution::causal_filter;
use crate::gls::GlsFit;
use crate::moments::Moments;
use crate::record::{Record, Run};

/// Samples at the beginning of a record that are looked at: what cannot be seen in them is too small
/// to matter.
pub(crate) const SAMPLES: usize = 1 << 15;

/// One run, or its beginning; simulation and errors are relative to the centre of the moments.
pub(crate) struct Simulated<'a> {
    pub(crate) run: Cow<'a, Run>,
    /// ŷ(k); NaN where an input is missing.
    pub(crate) output: Vec<f64>,
    /// y(k) - ŷ(k); NaN where either is missing.
    pub(crate) errors: Vec<f64>,
}

/// The runs of a record up to [`SAMPLES`], by the response of `fit`, which is one of `moments`.
pub(crate) fn simulated<'a>(
    record: &'a Record,
    moments: &Moments,
    fit: &GlsFit,
) -> Vec<Simulated<'a>> {
    let (impulse, offset) = (fit.impulse(), fit.solution.offset());
    let centre = moments.centre;
    beginnings(record.runs(), SAMPLES)
        .map(|run| {
            let input: Vec<f64> = run.input().iter().map(|u| u - centre.0).collect();
            let at_rest = run.input_at_rest().map(|u| u - centre.0);
            let mut output = causal_filter(&impulse, &input, at_rest);
            for value in &mut output {
                *value += offset;
            }
            let of_output = |(y, s): (&f64, &f64)| y - centre.1 - s;
            let errors = run.output().iter().zip(&output).map(of_output).collect();
            Simulated {
                run,
                output,
                errors,
            }
        })
        .collect()
}

/// The first `samples` samples of `runs`, run by run.
pub(crate) fn beginnings(runs: &[Run], samples: usize) -> impl Iterator<Item = Cow<'_, Run>> {
    runs.iter()
        .scan(samples, |left, run| {
            let taken = run.len().min(*left);
            *left -= taken;
            Some(if taken == run.len() {
                Cow::Borrowed(run)
            } else {
                Cow::Owned(run.part(0..taken))
            })
        })
        .filter(|run| !run.is_empty())
}
