//! Where the load stalls the drive: a servo that is sent farther stays there.

use super::ServoModel;
use crate::numerics::halved;
use servoid_dynamics::{Friction, ServoParameters, Stops};

/// From where on the load stalls the drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stall {
    /// The command from which on the drive is full at rest \[command\].
    pub command: f64,
    /// Where the servo comes to rest under the last command of the record, against load and friction: it gets no farther, but for what its speed carries it \[output\].
    pub output: f64,
}

impl ServoModel {
    /// Where the load stalls the drive, by the model, under commands of the record below their middle and above it.
    #[must_use]
    pub fn stalls(&self) -> [Option<Stall>; 2] {
        let servo = self.parameters(0);
        self.commands.map_or([None; 2], |commands| {
            [commands.least, commands.largest].map(|end| stall(&servo, commands.middle(), end))
        })
    }
}

/// Between a command in the middle, which is reached, and one at an end. What a stop ends is no stall: the load alone would let it go farther.
fn stall(servo: &ServoParameters, middle: f64, end: f64) -> Option<Stall> {
    let free = &ServoParameters {
        stops: Stops::default(),
        ..*servo
    };
    if stalls_under(free, middle) || !stalls_under(free, end) {
        return None;
    }
    (free.resting_output(end) == servo.resting_output(end)).then(|| Stall {
        command: halved(middle, end, |command| !stalls_under(free, command)),
        output: comes_to(free, end, middle),
    })
}

/// Where a servo comes to rest under the command `end` from the side of `middle`: friction in motion stops it before drive and load balance.
fn comes_to(servo: &ServoParameters, end: f64, middle: f64) -> f64 {
    let moving = ServoParameters {
        friction: servo.friction.map(|friction| Friction {
            at_rest: None,
            ..friction
        }),
        ..*servo
    };
    let [low, high] = moving.staying_angles(end);
    let angle = if end < middle { high } else { low };
    angle * servo.gain + servo.offset
}

/// Whether the drive is full at rest.
fn stalls_under(servo: &ServoParameters, command: f64) -> bool {
    let error = command - servo.resting_angle(command);
    servo.drive_limit().is_some_and(|limit| {
        let [up, down] = limit.both_ways();
        !(servo.error_of(-down)..=servo.error_of(up)).contains(&error)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_dynamics::{DriveLimit, Load};

    /// A drive of 1000 against a spring of 100 a unit holds 10 units, where the loop of 900 a unit is sent 10 + 1000/900.
    #[test]
    fn a_spring_stalls_the_drive_where_it_is_as_strong() {
        let servo = ServoParameters {
            limit: Some(DriveLimit {
                up: 1000.0,
                down_to_up: 2.0,
                motor_damping: 3.0,
                at_one_stiffness: false,
            }),
            load: Load::Spring {
                constant: 0.0,
                rate: 100.0,
            },
            gain: 2.0,
            ..ServoParameters::linear(900.0, 60.0)
        };
        let found = stall(&servo, 0.0, 15.0).unwrap();
        assert!((found.output - 20.0).abs() < 1e-6, "{found:?}");
        assert!(
            (found.command - (10.0 + 1000.0 / 900.0)).abs() < 1e-6,
            "{found:?}"
        );
        // Coulomb friction of 200 leaves 800 of the drive.
        let rubbing = ServoParameters {
            friction: Some(Friction {
                coulomb: 200.0,
                of_gears: 0.0,
                at_rest: None,
            }),
            ..servo
        };
        let found = stall(&rubbing, 0.0, 15.0).unwrap();
        assert!((found.output - 16.0).abs() < 1e-6, "{found:?}");
        // A stop before that is no stall.
        let stopped = ServoParameters {
            stops: Stops {
                lower: None,
                upper: Some(15.0),
            },
            ..servo
        };
        assert_eq!(stopped.resting_output(15.0), 15.0);
        assert_eq!(stall(&stopped, 0.0, 15.0), None);
        // The other way it has twice the drive.
        assert_eq!(stall(&servo, 0.0, -15.0), None);
        assert_eq!(stall(&servo, 0.0, 11.0), None);
    }
}
