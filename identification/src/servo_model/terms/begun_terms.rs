//! Where terms begin that a servo gets from another one: a descent from there has to lead somewhere.

use crate::servo_model::descent::coordinates::{Coordinate, Point, Terms};
use crate::servo_model::descent::starting_values::Shown;

/// The largest share of full drive that friction takes in the beginning.
const MOST_FRICTION: f64 = 0.2;

/// The servo `made` of another one, with less friction where that did not have any, and the drive would not move the shaft at all: no descent leads from there.
pub(super) fn that_moves(from: &Point, mut made: Point) -> Point {
    let is_new = from.get(Coordinate::Friction).is_none();
    let friction = made.get(Coordinate::Friction).filter(|_| is_new);
    if let Some((friction, full_at)) = friction.zip(full_drive_at(&made)) {
        made.set(Coordinate::Friction, friction.min(MOST_FRICTION * full_at));
    }
    made
}

/// The error of full drive \[command\].
fn full_drive_at(point: &Point) -> Option<f64> {
    let servo = point.physics(0, |_, value| value);
    Some(servo.drive_limit()?.up / servo.stiffness)
}

/// Below this share of the spread of the command a drive is full at hardly any error: it is a relay.
const RELAY: f64 = 0.02;

/// The `servos` that were made of another one, and where its drive is a relay and they have friction as it has not, these with a loop that is full at a quarter of the spread: what
/// friction leaves of the ends of strokes, a relay without it leaves, too.
pub(super) fn with_softer_loop(from: &Point, mut servos: Vec<Point>, shown: &Shown) -> Vec<Point> {
    let is_relay = full_drive_at(from).is_some_and(|full_at| full_at < RELAY * shown.spread);
    let gets_friction = |servo: &Point| servo.terms.friction && !from.terms.friction;
    if is_relay && servos.iter().any(gets_friction) {
        let soft = |servo: &Point| softer(servo, 0.25 * shown.spread);
        let others: Vec<Point> = servos.iter().filter_map(soft).collect();
        servos.extend(others);
    }
    servos
}

/// `servo` with the same motor behind a well damped loop whose drive is full at the error `full_at`.
fn softer(servo: &Point, full_at: f64) -> Option<Point> {
    let motor = servo.physics(0, |_, value| value).drive_limit()?;
    let mut soft = servo.clone();
    let stiffness = motor.up / full_at;
    let damping = (1.6 * stiffness.sqrt()).max(1.1 * motor.motor_damping);
    for (coordinate, value) in [
        (Coordinate::LnStiffness, stiffness.ln()),
        (Coordinate::LnDamping, damping.ln()),
        (Coordinate::MotorShare, motor.motor_damping / damping),
    ] {
        soft.set(coordinate, value);
    }
    Some(soft)
}

/// The servo `plain`, which was made from another one, and where it rests off its command by one term more than that, others that share alike how far the other one rests off:
/// a small share beside the whole of the others is in another valley. One that gets play or loses it rests as far off by play alone, or without it, too.
pub(super) fn with_shared_rest(from: &Point, plain: Point) -> Vec<Point> {
    let held_by = |terms: Terms| {
        let all = [
            (terms.dead_band, Coordinate::DeadBand, 1.0),
            (terms.friction, Coordinate::Friction, 1.0),
            (terms.play, Coordinate::Play, 2.0),
        ];
        all.into_iter().filter(|(has, ..)| *has)
    };
    if held_by(from.terms).count() == 0 || held_by(from.terms).eq(held_by(plain.terms)) {
        return vec![plain];
    }
    let rest: f64 = held_by(from.terms)
        .map(|(_, at, width)| from.get(at).unwrap_or(0.0) / width)
        .sum();
    let shared = |share: &dyn Fn(Coordinate) -> f64| {
        let mut shared = plain.clone();
        for (_, at, width) in held_by(plain.terms) {
            shared.set(at, share(at) * rest * width);
        }
        that_moves(from, shared)
    };
    let count = held_by(plain.terms).count();
    let alike = shared(&|_| 1.0 / count as f64);
    let mut all = vec![plain.clone(), alike];
    if plain.terms.play && count > 1 {
        all.push(shared(&|at| if at == Coordinate::Play { 0.9 } else { 0.1 }));
    }
    all
}
