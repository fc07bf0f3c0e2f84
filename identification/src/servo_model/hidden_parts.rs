//! Parts that the equation does not have, and whose errors have a known shape.
//!
//! A fit takes most of what such a part does for other values of its own parameters, and the errors that are left are small.
//! Each is looked for by a [score test](super::score_test) of its own, and what of it may hide below the noise is part of every interval.

use super::coordinates::Point;
use super::descent_step::MOST;
use super::error_row::Row;
use super::noise_at_rest::NoiseAtRest;
use super::score_test::score_test;
use super::stretches::Stretch;
use super::{current_limit, stiction};
use servoid_dynamics::{Grid, ServoParameters};

/// The standard deviation of the size of a part before a record is looked at, relative to that of its shape.
const BEFOREHAND: f64 = 2.0;

/// What a part would take from the output of a servo in each sample of a stretch \[output\]; `None` for a servo that cannot have it.
type Shortfall = fn(&ServoParameters, &Stretch, &Grid) -> Option<Vec<f64>>;

/// What a record says of a part.
pub(super) struct HiddenPart {
    /// Whether the errors are those of it, beyond chance.
    pub(super) is_seen: bool,
    /// J'e for an error of the size that may hide in the record, by coordinate.
    pub(super) hidden: [f64; MOST],
}

/// Looks for each part in the errors of `point`, where a servo of its terms can have it.
pub(super) fn hidden_parts(
    stretches: &[Stretch],
    point: &Point,
    grid: &Grid,
    rows: &[Vec<Row>],
    noise: &NoiseAtRest,
) -> Vec<HiddenPart> {
    let shortfalls: [Shortfall; 2] = [current_limit::shortfall, stiction::shortfall];
    let looked_for = |shortfall: Shortfall| {
        let of_stretch = |stretch: &Stretch| {
            let servo = point.servo_of(stretch, |_, value| value);
            let samples = shortfall(&servo, stretch, grid)?;
            Some(samples.into_iter().map(|error| [error]).collect())
        };
        let shape: Vec<_> = stretches.iter().map(of_stretch).collect::<Option<_>>()?;
        part(&shape, point.values.len(), rows, noise)
    };
    shortfalls.into_iter().filter_map(looked_for).collect()
}

/// A part that takes `shape`, by stretch and sample, from the output.
fn part(
    shape: &[Vec<[f64; 1]>],
    count: usize,
    rows: &[Vec<Row>],
    noise: &NoiseAtRest,
) -> Option<HiddenPart> {
    let score = score_test(rows, count, shape, noise)?;
    let size = (score.information + BEFOREHAND.powi(-2)).powf(-0.5);
    let mut hidden = [0.0; MOST];
    let samples = rows.iter().flatten().zip(shape.iter().flatten());
    for (row, [error]) in samples.filter(|(row, _)| !row.error.is_nan()) {
        for (hidden, slope) in hidden.iter_mut().zip(row.slope) {
            *hidden += size * error * slope;
        }
    }
    Some(HiddenPart {
        is_seen: score.is_beyond_chance(),
        hidden,
    })
}
