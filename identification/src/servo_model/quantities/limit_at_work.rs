//! Whether the limits of drive and speed were at work in a record, in each direction.
//!
//! A servo that hardly needs its limit upwards moves as well with one that is twice as large, or with none. The equation
//! hides that: it has one limit for both directions, or stiffness and limit that are in one ratio, so the limit of the other direction stands
//! for both. Such a fit has a top speed with a narrow interval that nothing has shown. So the limit of each direction is taken away from the best
//! servo, and the errors are asked whether they exclude that ([score test](crate::servo_model::uncertainty::score_test)): they are regressed on the derivatives of the fit and
//! on what the output would be more. The coefficient of that is 0 with the limit and 1 without.

use super::Quantity;
use super::quantity_kind::QuantityKind;
use crate::results::Interval;
use crate::servo_model::descent::coordinates::Point;
use crate::servo_model::motion::simulated_motion::Fastest;
use crate::servo_model::stretches::Stretch;
use crate::servo_model::uncertainty::covariance::Uncertainty;
use crate::servo_model::uncertainty::score_test::score_test;
use crate::servo_model::uncertainty::stepped_outputs::{step_s, stepped_outputs};
use crate::thresholds::SERVO_LIMIT_AT_WORK;
use servoid_dynamics::{Grid, ServoParameters, Stepper};

/// A servo without one of its limits towards larger or smaller θ.
type Without = fn(Stepper<f64>, bool) -> Stepper<f64>;

/// Whether the record excludes that a limit is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LimitsAtWork {
    /// That of the drive, towards larger and smaller outputs.
    drive: [bool; 2],
    /// That from which the top speed follows, likewise: of the speed itself, or of the drive.
    speed: [bool; 2],
    /// That of the drive towards larger θ, of which the error of full drive is.
    of_error: bool,
}

impl LimitsAtWork {
    /// Those of the best servo `point`, whose uncertainty is `found`. Where nothing is at rest there are no intervals to open.
    pub(crate) fn of(
        stretches: &[Stretch],
        point: &Point,
        grid: &Grid,
        found: &Uncertainty,
    ) -> Self {
        let is_at_work = |without: Without, towards_larger: bool| -> Option<bool> {
            let noise = found.at_rest.as_ref()?;
            let more = |stretch: &Stretch| {
                let servo = point.servo_of(stretch, |_, value| value);
                let more = without_limit(&servo, stretch, grid, |all| without(all, towards_larger));
                more.into_iter().map(|more| [more]).collect()
            };
            let shape: Vec<_> = stretches.iter().map(more).collect();
            let score = score_test(&found.rows, point.values.len(), &shape, noise)?;
            Some(score.information.sqrt() - score.deviations > SERVO_LIMIT_AT_WORK)
        };
        let sides = |without| [true, false].map(|side| is_at_work(without, side).unwrap_or(true));
        let servo = point.physics(0, |_, value| value);
        let of_drive = sides(Stepper::without_limit);
        let of_speed = match point.terms.speed_limit {
            true => sides(Stepper::without_speed_limit),
            false => of_drive,
        };
        Self {
            drive: servo.upwards_first(of_drive),
            speed: servo.upwards_first(of_speed),
            of_error: of_drive[0],
        }
    }

    /// Takes the bounds that rest on a limit which was not at work.
    pub(crate) fn open(self, quantities: &mut [Quantity], fastest: &Fastest) {
        for quantity in quantities {
            let (at_work, reached) = match quantity.kind() {
                Some(QuantityKind::TopSpeedUpwards) => (self.speed[0], Some(fastest.upwards)),
                Some(QuantityKind::TopSpeedDownwards) => (self.speed[1], Some(fastest.downwards)),
                Some(QuantityKind::AccelerationUpwards) => (self.drive[0], None),
                Some(QuantityKind::AccelerationDownwards) => (self.drive[1], None),
                Some(QuantityKind::ErrorOfFullDrive) => (self.of_error, None),
                _ => continue,
            };
            if at_work || quantity.interval.valid().is_none() {
                continue;
            }
            quantity.determined = false;
            quantity.interval = quantity.interval.map(|interval| Interval {
                lower: reached
                    .map(|reached| interval.lower.map_or(reached, |low| low.min(reached))),
                upper: None,
                ..interval
            });
        }
    }
}

/// What the output is more where the steps are as `without` leaves them, by sample.
fn without_limit(
    servo: &ServoParameters,
    stretch: &Stretch,
    grid: &Grid,
    without: impl FnOnce(Stepper<f64>) -> Stepper<f64>,
) -> Vec<f64> {
    let limited = Stepper::new(servo, step_s(grid));
    let outputs = |stepper: Stepper<f64>| {
        stepped_outputs(servo, stretch, grid, |state, command| {
            stepper.advance(state, command);
        })
    };
    let own = outputs(limited);
    let free = outputs(without(limited));
    free.iter().zip(own).map(|(free, own)| free - own).collect()
}
