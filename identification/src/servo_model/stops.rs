//! The stops that a servo may have.
//!
//! Their angles are not estimated: the shaft rests there. Whether they are stops, prediction decides, as it does for terms: a load that full
//! drive does not overcome holds the shaft as well.

use crate::data::Record;
use crate::data::column::mean;
use crate::diagnostics::{TravelEnd, extreme_rests};
use servoid_dynamics::Stops;

/// The stops to be tried: the outputs `known`, or else those that the rests of the record show; with one of them, and in its place, the other
/// end of what is commanded, which is a stop where a single level lies beyond it. Empty where nothing shows one.
pub(super) fn possible(record: &Record, known: &[f64]) -> Vec<Stops> {
    let mut at = known.to_vec();
    if at.is_empty() {
        let of_rests = TravelEnd::of_rests(record).into_iter().flatten();
        at.extend(of_rests.map(|end| end.rest));
    }
    let shown = among(record, &at);
    if shown.are_none() {
        return Vec::new();
    }
    let extremes = extreme_rests(record).map(|ends| among(record, &ends));
    let ends = extremes.unwrap_or_default();
    let both = Stops {
        lower: shown.lower.or(ends.lower),
        upper: shown.upper.or(ends.upper),
    };
    let other = match (shown.lower, shown.upper) {
        (Some(_), None) => Stops {
            lower: None,
            ..both
        },
        (None, Some(_)) => Stops {
            upper: None,
            ..both
        },
        _ => Stops::default(),
    };
    let mut all = vec![shown, both, other];
    all.dedup();
    all.retain(|stops| !stops.are_none());
    all
}

/// The lower and the upper stop among some outputs: the output is nowhere beyond a stop, so its mean is between them.
fn among(record: &Record, at: &[f64]) -> Stops {
    let outputs = record.runs().iter().flat_map(|run| run.output());
    let middle = mean(&outputs.copied().collect::<Vec<f64>>());
    let of = |is_beyond: fn(f64, f64) -> bool| {
        at.iter()
            .copied()
            .find(|end| middle.is_some_and(|middle| is_beyond(*end, middle)))
    };
    Stops {
        lower: of(|end, middle| end < middle),
        upper: of(|end, middle| end > middle),
    }
}
