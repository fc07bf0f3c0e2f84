//! Parts that the equation does not have, and whose errors have a known shape.
//!
//! A fit takes most of what such a part does for other values of its own parameters, and the errors that are left are small.
//! Each is looked for by a [score test](crate::servo_model::uncertainty::score_test) of its own, and what of it may hide below the noise is part of every interval.

use super::noise_at_rest::NoiseAtRest;
use super::score_test::{Score, score_test};
use super::{current_limit, drive_lag, motor_beside_limit, play, stiction, unequal_sides};
use crate::servo_model::descent::coordinates::Point;
use crate::servo_model::descent::error_row::Row;
use crate::servo_model::descent::step::MOST;
use crate::servo_model::stretches::Stretch;
use servoid_dynamics::{Grid, ServoParameters};

/// The standard deviation of the size of a part before a record is looked at, relative to that of its shape.
const BEFOREHAND: f64 = 2.0;

/// What a part would take from the output of a servo in each sample of a stretch \[output\]; `None` for a servo that cannot have it. It comes
/// last, after parts that the equation has and the fit may have left out.
type Shortfalls<const N: usize> = fn(&ServoParameters, &Stretch, &Grid) -> Option<Vec<[f64; N]>>;

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
    (rows, simulated): (&[Vec<Row>], &[Vec<f64>]),
    noise: &NoiseAtRest,
) -> Vec<HiddenPart> {
    let errors = FitErrors {
        stretches,
        point,
        grid,
        rows,
        noise,
    };
    let parts = [
        errors.part(current_limit::shortfall, Occurrence::InSome),
        errors.part(drive_lag::shortfall, Occurrence::InAll),
        errors.part(motor_beside_limit::shortfall, Occurrence::InAll),
        errors.part(stiction::shortfall, Occurrence::InSome),
        errors.part(unequal_sides::limit_shortfalls, Occurrence::InSome),
        errors.part(unequal_sides::motor_shortfalls, Occurrence::InSome),
    ];
    let of_play = || {
        let shapes = play::shortfalls(simulated);
        part(
            &shapes,
            point.values.len(),
            (rows, noise),
            Occurrence::InAll,
        )
    };
    let of_play = (!point.terms.play).then(of_play).flatten();
    parts.into_iter().chain([of_play]).flatten().collect()
}

/// Where parts are looked for.
struct FitErrors<'a> {
    stretches: &'a [Stretch],
    point: &'a Point,
    grid: &'a Grid,
    rows: &'a [Vec<Row>],
    noise: &'a NoiseAtRest,
}

impl FitErrors<'_> {
    fn part<const N: usize>(
        &self,
        shortfalls: Shortfalls<N>,
        occurrence: Occurrence,
    ) -> Option<HiddenPart> {
        let of_stretch = |stretch: &Stretch| {
            let servo = self.point.servo_of(stretch, |_, value| value);
            shortfalls(&servo, stretch, self.grid)
        };
        let shapes: Vec<_> = self
            .stretches
            .iter()
            .map(of_stretch)
            .collect::<Option<_>>()?;
        let count = self.point.values.len();
        part(&shapes, count, (self.rows, self.noise), occurrence)
    }
}

/// Which servos have a part.
#[derive(Clone, Copy)]
enum Occurrence {
    /// All, more or less.
    InAll,
    /// Few: where the errors do not show it, it is not there.
    InSome,
}

/// The root mean square of the size of a part, by what is known beforehand and what the record says of it.
fn size_that_may_hide(score: &Score, occurrence: Occurrence) -> f64 {
    let information = score.information + BEFOREHAND.powi(-2);
    let mean = match occurrence {
        Occurrence::InAll => score.deviations * score.information.sqrt() / information,
        Occurrence::InSome => 0.0,
    };
    mean.hypot(information.powf(-0.5))
}

/// A part that takes the last of `shapes`, by stretch and sample, from the output.
fn part<const N: usize>(
    shapes: &[Vec<[f64; N]>],
    count: usize,
    (rows, noise): (&[Vec<Row>], &NoiseAtRest),
    occurrence: Occurrence,
) -> Option<HiddenPart> {
    let score = score_test(rows, count, shapes, noise)?;
    let size = size_that_may_hide(&score, occurrence);
    let mut hidden = [0.0; MOST];
    let samples = rows.iter().flatten().zip(shapes.iter().flatten());
    for (row, shapes) in samples.filter(|(row, _)| !row.error.is_nan()) {
        for (hidden, slope) in hidden.iter_mut().zip(row.slope) {
            *hidden += size * shapes[N - 1] * slope;
        }
    }
    Some(HiddenPart {
        is_seen: score.last_is_beyond_chance(),
        hidden,
    })
}
