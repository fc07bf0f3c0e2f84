//! Servos whose friction at rest is half gone at another speed.
//!
//! Where that is a lower one, a stroke that the record does not have, a small one, may not move the shaft.
//!
//! That speed is no coordinate of the fit: left free, it ran to the least that the integration resolves, with which other recordings of
//! the same servo were predicted worse. It is one of a few, and another than [`FRICTION_SPEED_SHARE`] only where noise alone is left of the errors with it: with that
//! one something else is left as well, or more than by chance.

use crate::results::Reason;
use crate::servo_model::descent::chosen_terms::{Descent, STEPS};
use crate::servo_model::descent::coordinates::{Coordinate, FRICTION_SPEED_SHARE, Point};
use crate::servo_model::descent::fit::Problem;
use crate::servo_model::stretches::Stretch;
use crate::servo_model::uncertainty::covariance::{Uncertainty, uncertainty};
use crate::servo_model::uncertainty::validity::against;
use crate::thresholds::{SERVO_FRICTION_UNSHOWN, SERVO_LACK_OF_FIT};
use rayon::prelude::*;
use servoid_dynamics::ServoParameters;

/// The speeds, as shares of the top speed.
const SHARES: [f64; 5] = [FRICTION_SPEED_SHARE, 0.025, 0.012, 0.006, 0.003];

/// The excess of friction at rest from which such a servo is looked for, where the fit has found less.
const EXCESS: f64 = 1.0;

/// A servo with the speed that is its own.
pub(super) struct WithItsSpeed {
    pub(super) point: Point,
    pub(super) found: Uncertainty,
    /// The same with each of the other speeds; none where something else than its errors speaks against intervals.
    pub(super) others: Vec<Point>,
}

/// A rest lasts so long \[s\]: a shaft that breaks away is sooner gone.
const REST_S: f64 = 0.02;

/// Whether a rest in the motion of `point`, of which `found` is the uncertainty, shows the friction at rest that it has.
pub(super) fn shows_friction_at_rest(
    parts: &[Stretch],
    point: &Point,
    found: &Uncertainty,
    period_s: f64,
) -> bool {
    let servo = point.physics(0, |_, value| value);
    let held = servo.resting_error().unwrap_or(f64::INFINITY) + servo.dead_band.unwrap_or_default();
    let samples = (REST_S / period_s).ceil() as usize;
    let motion = found.motion.simulated.iter().zip(&found.motion.at_rest);
    let rests = parts.iter().zip(motion).map(|(part, (output, at_rest))| {
        let servo = point.servo_of(part, |_, value| value);
        largest_rest(&servo, (&part.input, output, at_rest), (samples, period_s))
    });
    held <= SERVO_FRICTION_UNSHOWN * (rests.fold(0.0, f64::max) + servo.half_play())
}

/// The farthest that the angle of `servo` is off the command in a rest of so many `samples` or more \[command\].
fn largest_rest(
    servo: &ServoParameters,
    (input, output, at_rest): (&[f64], &[f64], &[bool]),
    (samples, period_s): (usize, f64),
) -> f64 {
    // A command within a row acts from the next on.
    let late = (servo.delay_s.max(0.0) / period_s) as usize + 2;
    let angle = |y: f64| (y - servo.offset) / servo.gain;
    let still = at_rest
        .windows(samples)
        .map(|rest| rest.iter().all(|at_rest| *at_rest));
    let errors = input.iter().zip(output.iter().zip(still).skip(late));
    let of_rests = errors.filter(|(_, (_, still))| *still);
    of_rests
        .map(|(u, (y, _))| (u - angle(*y)).abs())
        .fold(0.0, f64::max)
}

/// The servos as `point` with each of the other speeds.
fn with_other_speeds(problem: &Problem<'_>, point: &Point) -> Vec<Point> {
    let Some(excess) = point.get(Coordinate::FrictionAtRest) else {
        return Vec::new();
    };
    let with = |friction_speed_share: f64| {
        let mut other = Point {
            friction_speed_share,
            ..point.clone()
        };
        other.set(Coordinate::FrictionAtRest, excess.max(EXCESS));
        problem.descend(&mut other, STEPS);
        other
    };
    let others = SHARES
        .into_par_iter()
        .filter(|share| *share != point.friction_speed_share);
    others.map(with).collect()
}

/// Whether the speed of `other` is the next to that of `best`, where that is none of the usual: the speed of the servo is between them, however well the record
/// distinguishes the two.
pub(super) fn is_next_to(best: &Point, other: &Point) -> bool {
    let place = |point: &Point| {
        let mut all = SHARES.into_iter();
        all.position(|share| share == point.friction_speed_share)
    };
    let places = place(best).zip(place(other));
    places.is_some_and(|(own, other)| own > 0 && other > 0 && own.abs_diff(other) == 1)
}

/// The servo `point`, or the one with another speed that leaves noise alone where that does not, or smaller errors beyond chance. The starts of `parts` are those of
/// that servo.
pub(super) fn with_its_speed(
    parts: &mut Vec<Stretch>,
    descent: &Descent<'_>,
    (point, found): (Point, Uncertainty),
    blocks: usize,
) -> WithItsSpeed {
    let reason = against(parts, &point, &found);
    let of_its_errors = matches!(reason, None | Some(Reason::ErrorsNotNoise));
    let Some(noise) = found.at_rest.as_ref().filter(|_| of_its_errors) else {
        let others = Vec::new();
        return WithItsSpeed {
            point,
            found,
            others,
        };
    };
    let polished = |from: Point| {
        let mut parts = parts.clone();
        let point = descent.polished(&mut parts, from);
        let found = uncertainty(&descent.problem(&parts), &point, blocks);
        (parts, point, found)
    };
    let leaves_noise = |(parts, point, other): &(Vec<Stretch>, Point, Uncertainty)| {
        (reason.is_some() || found.is_beaten_by(other, SERVO_LACK_OF_FIT))
            && against(parts, point, other).is_none()
            && shows_friction_at_rest(parts, point, other, descent.grid.period_s)
    };
    let others = with_other_speeds(&descent.problem(parts), &point);
    let all: Vec<_> = others.par_iter().cloned().map(polished).collect();
    let squares = |found: &Uncertainty| noise.white_squares(&found.errors());
    let chosen = (all.into_iter().filter(leaves_noise))
        .min_by(|(_, _, a), (_, _, b)| squares(a).total_cmp(&squares(b)));
    let Some((its_parts, point, found)) = chosen else {
        return WithItsSpeed {
            point,
            found,
            others,
        };
    };
    *parts = its_parts;
    WithItsSpeed {
        others: with_other_speeds(&descent.problem(parts), &point),
        point,
        found,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step of 3 that the shaft is held against, and one that it follows after its delay of two samples.
    #[test]
    fn a_command_that_has_not_arrived_is_no_rest_off_it() {
        const PERIOD_S: f64 = 0.005;
        let servo = ServoParameters {
            delay_s: 2.0 * PERIOD_S,
            ..ServoParameters::linear(2500.0, 100.0)
        };
        let input = [vec![0.0; 10], vec![3.0; 30]].concat();
        let still = vec![0.0; 40];
        let off = |output: &[f64], at_rest: &[bool]| {
            largest_rest(&servo, (&input, output, at_rest), (4, PERIOD_S))
        };
        assert_eq!(off(&still, &[true; 40]), 3.0);
        let follows = |k: usize| 3.0 * (k as f64 - 12.0).clamp(0.0, 8.0) / 8.0;
        let output: Vec<f64> = (0..40).map(follows).collect();
        let at_rest: Vec<bool> = (0..40).map(|k| !(13..=20).contains(&k)).collect();
        assert_eq!(off(&output, &at_rest), 0.0);
    }
}
