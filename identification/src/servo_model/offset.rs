//! The output at rest under command 0, and how far it is open.
//!
//! With the load: a record that knows where the servo rests may not know whether a load holds it there. In a dead band the load decides at
//! which edge the shaft rests, and friction how much of the band is open. Where the record does not show the side of that, the shaft may rest at
//! either edge: the output at rest jumps there, and derivatives do not see it.

use crate::results::Interval;
use servoid_dynamics::ServoParameters;

/// A number of a servo, from it and the middle of the commands.
pub(super) type Formula = fn(&ServoParameters<f64>, f64) -> Option<f64>;

/// The output at rest under command 0.
pub(super) fn at_rest(servo: &ServoParameters, _middle: f64) -> Option<f64> {
    Some(servo.resting_output(0.0))
}

/// The output at rest at either edge of the dead band: that of the same servo without it, under a command that is as far off.
pub(super) const EDGES: [Formula; 2] = [
    |servo, _| at_edge(servo, -1.0),
    |servo, _| at_edge(servo, 1.0),
];

/// Drives that hold the shaft at rest under command 0.
const HOLDING: [Formula; 2] = [|servo, _| holding(servo, 0), |servo, _| holding(servo, 1)];

/// Whether the edge is known at which the shaft rests: by the intervals of formulas.
pub(super) fn side_is_known(interval: impl Fn(Formula) -> Option<Interval>) -> bool {
    let is_known = |drive: &Formula| match interval(*drive) {
        Some(Interval {
            lower: Some(lower),
            upper: Some(upper),
            ..
        }) => lower > 0.0 || upper < 0.0,
        // Without a dead band there are no edges.
        None => true,
        _ => false,
    };
    HOLDING.iter().all(is_known)
}

fn at_edge(servo: &ServoParameters, side: f64) -> Option<f64> {
    let width = servo.dead_band?;
    let without = ServoParameters {
        dead_band: None,
        ..*servo
    };
    Some(without.resting_output(side * width))
}

fn holding(servo: &ServoParameters, which: usize) -> Option<f64> {
    servo.dead_band?;
    let load = servo.load.at(servo.resting_angle(0.0));
    Some(servo.holding_drives(load)[which])
}
