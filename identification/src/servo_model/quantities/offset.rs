//! The output at rest under command 0, and how far it is open.
//!
//! Without the stops: commands in pulse widths are far from 0, and beyond every stop there. What is stated is where the servo would rest.
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
    Some(servo.without_stops().resting_output(0.0))
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
        ..servo.without_stops()
    };
    Some(without.resting_output(side * width))
}

fn holding(servo: &ServoParameters, which: usize) -> Option<f64> {
    servo.dead_band?;
    let load = servo.load.at(servo.without_stops().resting_angle(0.0));
    Some(servo.holding_drives(load)[which])
}

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_dynamics::{Friction, Load, Stops};

    #[test]
    fn the_edge_is_known_where_load_or_friction_decide_it() {
        let servo = |load: f64, coulomb: f64| ServoParameters {
            delay_s: 0.01,
            gain: -2.0,
            offset: 1.0,
            dead_band: Some(0.5),
            friction: Some(Friction {
                coulomb,
                of_gears: 0.0,
                at_rest: None,
            }),
            load: Load::Constant(load),
            ..ServoParameters::linear(100.0, 20.0)
        };
        // What holds the shaft is known to 10 either way.
        let is_known = |servo: ServoParameters| {
            side_is_known(|of| {
                let value = of(&servo, 0.0)?;
                Some(Interval::new(value, value - 10.0, value + 10.0))
            })
        };
        for (load, coulomb, known) in [
            (0.0, 0.0, false),
            (5.0, 0.0, false),
            (80.0, 0.0, true),
            // Friction holds it at both edges, and the rest is the middle.
            (5.0, 30.0, true),
            // It may or may not hold it against the load.
            (25.0, 30.0, false),
        ] {
            assert_eq!(is_known(servo(load, coulomb)), known, "{load} {coulomb}");
        }
        let without = ServoParameters {
            dead_band: None,
            ..servo(5.0, 0.0)
        };
        assert!(is_known(without));
        let edges = EDGES.map(|edge| edge(&servo(0.0, 0.0), 0.0));
        assert_eq!(edges, [Some(2.0), Some(0.0)]);
    }

    #[test]
    fn a_stop_does_not_move_the_offset() {
        let in_pulses = ServoParameters {
            delay_s: 0.01,
            gain: 0.09,
            offset: -135.0,
            stops: Stops {
                lower: Some(-40.0),
                upper: None,
            },
            ..ServoParameters::linear(100.0, 20.0)
        };
        assert_eq!(in_pulses.resting_output(0.0), -40.0);
        assert_eq!(at_rest(&in_pulses, 1500.0), Some(-135.0));
    }
}
