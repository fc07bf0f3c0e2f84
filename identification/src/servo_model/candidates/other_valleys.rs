//! Servos in other valleys of the surface, which the record hardly distinguishes from the best one: with the same terms, but for one that the ladder
//! does not try.
//!
//! The covariance of a fit knows its own valley alone. Three others are known to hide below the noise, and a fourth by the
//! [speed at which friction at rest is gone](super::friction_speed). Where all strokes are alike,
//! a limit of the drive acts as a linear servo does: a low top speed and a stiff drive, or a soft drive that is never full. A drive that is there at once differs from a quick one by a delay of less than a sample. And a drive whose limits
//! differ at one stiffness moves as one under a load, with friction in the place of most of its dead band.

use crate::servo_model::descent::coordinates::{Coordinate, LoadKind, Point, Terms};
use crate::servo_model::descent::fit::Problem;
use crate::servo_model::motion::simulated_motion::largest_error;
use crate::servo_model::terms::ladder::misses;
use servoid_dynamics::Load;

/// Steps of each descent.
const STEPS: usize = 30;

/// The error of full drive from which the soft drive is looked for, as a share of the largest error in the record: where no error
/// reaches it, nothing shows how the fit depends on it.
const FULL_AT: f64 = 0.7;

/// Logarithm of the factor by which a drive that is there at once is stiffer and more damped.
const QUICKER: f64 = 2.0;

/// The servo as `point` with a soft drive, unless it misses the record by more than chance beside it. `linear` is the linear servo
/// of the record, `simulated` are the outputs of `point` by stretch, `blocks` the number of blocks.
pub(super) fn with_soft_drive(
    problem: &Problem<'_>,
    point: &Point,
    linear: &Point,
    simulated: &[Vec<f64>],
    blocks: usize,
) -> Option<Point> {
    let servo = point.physics(0, |_, value| value);
    let errors = (problem.stretches.iter().zip(simulated))
        .map(|(stretch, output)| largest_error(&servo, &stretch.input, output));
    let full_at = FULL_AT * errors.fold(0.0, f64::max);
    let mut soft = soft_drive(point, linear, full_at)?;
    problem.descend(&mut soft, STEPS);
    let [own, other] = [point, &soft].map(|servo| problem.by_block(servo, blocks));
    (!misses(&other, &own)).then_some(soft)
}

/// The servo as `point` with a drive that brings it to its speed at once, unless it misses the record by more than chance beside it. Where the
/// motor takes less than a sample period for that, a longer delay makes nearly the same motion, and the logarithm of an endless
/// drive is beyond any interval.
pub(super) fn with_quick_drive(
    problem: &Problem<'_>,
    point: &Point,
    blocks: usize,
) -> Option<Point> {
    let motor_lag_s = 1.0 / point.physics(0, |_, value| value).limit?.motor_damping;
    if motor_lag_s > problem.grid.period_s {
        return None;
    }
    let mut quick = point.clone();
    for faster in [Coordinate::LnStiffness, Coordinate::LnDamping] {
        let (_, most) = faster.range(problem.longest_delay_s);
        quick.set(faster, (point.get(faster)? + QUICKER).min(most));
    }
    let gained_s = motor_lag_s * (1.0 - (-QUICKER).exp());
    let delay_s = point.get(Coordinate::Delay)? + gained_s;
    quick.set(Coordinate::Delay, delay_s.min(problem.longest_delay_s));
    problem.descend(&mut quick, STEPS);
    let [own, other] = [point, &quick].map(|servo| problem.by_block(servo, blocks));
    (!misses(&other, &own)).then_some(quick)
}

/// The servo as `point` whose limits of the drive differ at one stiffness, where it may be.
pub(super) fn with_unequal_limits(problem: &Problem<'_>, point: &Point) -> Option<Point> {
    let mut unequal = unequal_limits(point)?;
    problem.descend(&mut unequal, STEPS);
    Some(unequal)
}

/// `point` with the drive of the linear servo, full beyond the error `full_at`; `None` where its own drive is as soft.
fn soft_drive(point: &Point, linear: &Point, full_at: f64) -> Option<Point> {
    let of_servo = point.physics(0, |_, value| value);
    if of_servo.limit?.up > full_at * of_servo.stiffness {
        return None;
    }
    let mut soft = point.clone();
    for shared in [
        Coordinate::Delay,
        Coordinate::LnStiffness,
        Coordinate::LnDamping,
    ] {
        soft.set(shared, linear.get(shared)?);
    }
    // A+/B with A+ = E k and B = share c.
    let servo = linear.physics(0, |_, value| value);
    let motor_damping = point.get(Coordinate::MotorShare)? * servo.damping;
    let top_speed = full_at * servo.stiffness / motor_damping;
    soft.set(Coordinate::LnTopSpeed, top_speed.ln());
    top_speed.ln().is_finite().then_some(soft)
}

/// `point` with limits of the drive that differ at one stiffness instead of a constant load and unequal drives; `None` where it has neither. What
/// dead band and friction leave at rest together is halved between them.
fn unequal_limits(point: &Point) -> Option<Point> {
    let terms = point.terms;
    let has_other_load = !matches!(terms.load, LoadKind::None | LoadKind::Constant);
    let is_even = !terms.two_speeds && terms.load == LoadKind::None;
    if has_other_load || is_even || terms.speed_limit {
        return None;
    }
    let servo = point.physics(0, |_, value| value);
    let limit = servo.limit?;
    let load = match servo.load {
        Load::Constant(load) => load,
        _ => 0.0,
    };
    let [up, down] = limit.both_ways();
    let [up, down] = [up - load, down + load];
    if !(up > 0.0 && down > 0.0) {
        return None;
    }
    let is_own_stiffness = |at: &&Coordinate| matches!(at, Coordinate::LnOwnStiffness(_));
    let controllers = 1 + point.coordinates.iter().filter(is_own_stiffness).count();
    let terms = Terms {
        two_speeds: true,
        one_stiffness: true,
        dead_band: true,
        friction: true,
        load: LoadKind::None,
        ..terms
    };
    let mut other = point.with_terms(terms, controllers, |_| 0.0);
    let friction = servo.friction.map_or(0.0, |friction| friction.coulomb);
    let at_rest = servo.dead_band.unwrap_or(0.0) + friction / servo.stiffness;
    let offset = servo.offset - servo.gain * load / servo.stiffness;
    for (coordinate, value) in [
        (Coordinate::LnTopSpeed, (up / limit.motor_damping).ln()),
        (Coordinate::LnDownToUp, (down / up).ln()),
        (Coordinate::Offset, offset),
        (Coordinate::DeadBand, 0.5 * at_rest),
        (Coordinate::Friction, 0.5 * at_rest),
    ] {
        other.set(coordinate, value);
    }
    Some(other)
}
