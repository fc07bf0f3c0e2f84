//! Sequences behind the noise filter, in the rows of the regression.

use std::ops::Range;

use crate::data::Run;

/// The value, 0 where it is missing.
pub(crate) fn present(value: f64) -> f64 {
    if value.is_nan() { 0.0 } else { value }
}

/// The input of `run` relative to `centre`, with `history` samples before its first: those at rest. 0 where it is not known.
pub(crate) fn with_history(run: &Run, history: usize, centre: f64) -> Vec<f64> {
    let mut input = Vec::with_capacity(history + run.len());
    let at_rest = run.input_at_rest().map_or(0.0, |u| present(u - centre));
    input.resize(history, at_rest);
    input.extend(run.input().iter().map(|u| present(u - centre)));
    input
}

/// `values` in `rows`, 0 elsewhere.
pub(crate) fn only(rows: &[Range<usize>], mut values: Vec<f64>) -> Vec<f64> {
    let mut kept = 0;
    for row in rows {
        values[kept..row.start].fill(0.0);
        kept = row.end;
    }
    values[kept..].fill(0.0);
    values
}

/// sum_i d_i x(k-i) for each k, what is before the first value left out. A pass for each i, so that
/// each can be done in vector registers.
pub(crate) fn filtered(values: &[f64], d: &[f64]) -> Vec<f64> {
    let mut filtered = vec![0.0; values.len()];
    for (i, di) in d.iter().enumerate() {
        for (sum, value) in filtered.iter_mut().skip(i).zip(values) {
            *sum += di * value;
        }
    }
    filtered
}
