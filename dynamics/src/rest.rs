//! Where a servo rests: the one definition, for what is stated, for the start of a simulation, and for exports.
//!
//! Under a held command the shaft rests where the drive balances the load, and with friction also where the two differ by no more than
//! that holds. All such angles lie between two ends. At the lower end friction helps the load, at the upper one the drive; without
//! friction both are one. **The angle at rest is the middle between the ends.** An end is where the shaft comes to that is let go at
//! its command, slowly: with a dead band, that is the edge to which the load pushes it, and the command itself where nothing does.
//!
//! A load that full drive does not hold has no rest. What is given then is the rest of a drive without limit.

use crate::dual::{Dual, Scalar};
use crate::equation::{Friction, ServoParameters};
use crate::stepper::nearer_zero;

/// How often the distance from the command is doubled in the search for a place where the drive holds the load.
const DOUBLINGS: usize = 8;

/// How often the stretch that has the end is halved then: to the last digit.
const HALVINGS: usize = 60;

/// An end of the angles at rest, by the place of its drive in [`ServoParameters::holding_drives`].
#[derive(Clone, Copy)]
enum End {
    /// The least drive that holds the shaft, and the largest angle.
    Upper = 0,
    /// The largest drive, and the least angle.
    Lower = 1,
}

impl<S: Scalar> ServoParameters<S> {
    /// The middle of the commands that hold the shaft at rest at `angle`.
    #[must_use]
    pub fn holding_command(&self, angle: S) -> S {
        let drives = self.holding_drives(self.load.at(angle));
        let [least, most] = drives.map(|drive| self.error_of(drive));
        angle + (least + most) * 0.5
    }

    /// The angle at rest under `command`.
    #[must_use]
    pub fn resting_angle(&self, command: S) -> S {
        let [upper, lower] = [End::Upper, End::Lower].map(|end| self.end(command, end));
        (self.between_stops(upper) + self.between_stops(lower)) * 0.5
    }

    /// The least and the largest angle at which the shaft stays under `command` once it has come to rest there, by friction or within a dead band.
    #[must_use]
    pub fn staying_angles(&self, command: S) -> [S; 2] {
        let drives = self.holding_drives(self.load.at(self.resting_angle(command)));
        let width = self.dead_band.unwrap_or(S::constant(0.0));
        let [high, low] = [(End::Upper, -1.0), (End::Lower, 1.0)].map(|(end, side)| {
            // Nothing pushes it within the dead band.
            let angle = match drives[end as usize].value() {
                0.0 => command - width * side,
                _ => self.end(command, end),
            };
            self.between_stops(angle)
        });
        [low, high]
    }

    /// The angle, or the stop before it.
    fn between_stops(&self, angle: S) -> S {
        let [low, high] = self.range();
        match angle.value() {
            angle if angle < low.value() => low,
            angle if angle > high.value() => high,
            _ => angle,
        }
    }

    /// The output at rest under `command`.
    #[must_use]
    pub fn resting_output(&self, command: S) -> S {
        self.resting_angle(command) * self.gain + self.offset
    }

    /// The least and the largest drive under which a shaft at rest with the load `load` stays there. Friction that holds any drive
    /// counts as none: it gives no angle.
    #[must_use]
    pub fn holding_drives(&self, load: S) -> [S; 2] {
        let Some(friction) = self.friction.map(|friction| friction.at_rest()) else {
            return [load; 2];
        };
        if friction.of_gears.value() >= 1.0 {
            return [load; 2];
        }
        // drive = load ± (coulomb + of_gears |drive + load|); what is within the bars has the sign of 2 load ± coulomb.
        [-1.0, 1.0].map(|side| {
            let one = S::constant(1.0);
            let pressed = load * 2.0 + friction.coulomb * side;
            let share = friction.of_gears * side * pressed.value().signum();
            (load * (one + share) + friction.coulomb * side) / (one - share)
        })
    }

    /// The error at rest under which a drive without limit is `drive`.
    #[must_use]
    pub fn error_of(&self, drive: S) -> S {
        let none = S::constant(0.0);
        let width = self.dead_band.unwrap_or(none);
        let sign = match drive.value() {
            0.0 => 0.0,
            drive => drive.signum(),
        };
        drive / (self.stiffness * self.loop_ratio(drive)) + width * sign
    }

    /// The strength of the loop where the drive has the sign of `signed`, relative to that upwards.
    fn loop_ratio(&self, signed: S) -> S {
        match self.drive_limit() {
            Some(limit) if signed.value() < 0.0 => limit.loop_down_to_up(),
            _ => S::constant(1.0),
        }
    }

    /// The drive at rest under an error.
    fn drive_at_rest(&self, error: S) -> S {
        let seen = match self.dead_band {
            None => error,
            Some(width) => nearer_zero(error, width),
        };
        let wanted = seen * self.stiffness * self.loop_ratio(seen);
        let most = self.drive_limit().map(|limit| {
            let [up, down] = limit.both_ways();
            if seen.value() < 0.0 { down } else { up }
        });
        match most {
            Some(most) if wanted.value().abs() > most.value() => most * seen.value().signum(),
            _ => wanted,
        }
    }

    /// By how much the drive is more than the one that just holds the shaft at this end.
    fn excess(&self, command: S, angle: S, end: End) -> S {
        let held = self.holding_drives(self.load.at(angle))[end as usize];
        self.drive_at_rest(command - angle) - held
    }

    /// The angle of an end.
    fn end(&self, command: S, end: End) -> S {
        let held = self.holding_drives(self.load.at(command))[end as usize];
        let unlimited = command - self.error_of(held);
        let Some(angle) = self.balance(command, held, end) else {
            return unlimited;
        };
        // The derivatives by command and parameters, from those of the balance.
        let plain = self.map(|_, value| Dual::<1>::constant(value.value()));
        let by_angle = plain.excess(
            Dual::constant(command.value()),
            Dual::variable(angle, 0),
            end,
        );
        match by_angle.slope[0] {
            // Nothing pushes it within the dead band.
            0.0 => unlimited,
            slope => {
                let angle = S::constant(angle);
                angle - self.excess(command, angle, end) * slope.recip()
            }
        }
    }

    /// Where the drive is `held` first, on the way from the command to where that pulls; `None` where it is so nowhere.
    fn balance(&self, command: S, held: S, end: End) -> Option<f64> {
        let side = -held.value().signum();
        let angle = |distance: f64| command.value() + side * distance;
        let pulled = |distance: f64| {
            let angle = S::constant(angle(distance));
            side * self.excess(command, angle, end).value() > 0.0
        };
        let (mut near, mut far) = (0.0, self.error_of(held).value().abs());
        for _ in 0..DOUBLINGS {
            if pulled(far) {
                (near, far) = (far, 2.0 * far);
            }
        }
        if pulled(far) {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (near + far);
            if pulled(middle) {
                near = middle;
            } else {
                far = middle;
            }
        }
        Some(angle(far))
    }
}

impl<S: Scalar> Friction<S> {
    /// That of a shaft at rest.
    fn at_rest(self) -> Self {
        let excess = self.at_rest.map(|at_rest| at_rest.excess);
        let factor = S::constant(1.0) + excess.unwrap_or(S::constant(0.0));
        Self {
            coulomb: self.coulomb * factor,
            of_gears: self.of_gears * factor,
            at_rest: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equation::{AtRest, DriveLimit, Load, PARAMETERS, Stops};
    use crate::{State, Stepper};

    /// 50 rad/s, with full drive beyond 3 units upwards.
    fn servo() -> ServoParameters {
        ServoParameters {
            gain: 2.0,
            offset: 0.5,
            limit: Some(DriveLimit {
                up: 7500.0,
                down_to_up: 1.0,
                motor_damping: 25.0,
                at_one_stiffness: false,
            }),
            ..ServoParameters::linear(2500.0, 80.0)
        }
    }

    fn friction(coulomb: f64, of_gears: f64, excess: f64) -> Option<Friction<f64>> {
        Some(Friction {
            coulomb,
            of_gears,
            at_rest: Some(AtRest {
                excess,
                speed: 15.0,
            }),
        })
    }

    /// The words of the glossary.
    #[test]
    fn gears_hold_a_loaded_shaft_farther() {
        let (coulomb, of_gears, excess, load) = (0.25, 0.12, 0.25, 1.2);
        let held = |load: f64| {
            let servo = ServoParameters {
                friction: friction(coulomb * 2500.0, of_gears, excess),
                load: Load::Constant(load * 2500.0),
                ..servo()
            };
            let [low, high] = servo.staying_angles(4.0);
            (0.5 * (high - low), servo.resting_error().unwrap())
        };
        let (coulomb, of_gears) = (coulomb * (1.0 + excess), of_gears * (1.0 + excess));
        let (free, error) = held(0.0);
        assert!((free - coulomb / (1.0 - of_gears)).abs() < 1e-9 && (free - error).abs() < 1e-9);
        let (loaded, unchanged) = held(load);
        let expected = (coulomb + 2.0 * of_gears * load) / (1.0 - of_gears * of_gears);
        assert!((loaded - expected).abs() < 1e-9, "{loaded} {expected}");
        assert_eq!(unchanged, error);
    }

    /// The angle after four seconds under `command`, from `angle` on.
    fn left_alone(servo: &ServoParameters, command: f64, angle: f64) -> f64 {
        let stepper = Stepper::new(servo, 1e-4);
        let mut state = State::at_rest(angle);
        for _ in 0..40_000 {
            stepper.advance(&mut state, command);
        }
        state.angle
    }

    fn servos() -> Vec<ServoParameters> {
        let unequal = |ratio: f64| {
            servo().limit.map(|limit| DriveLimit {
                down_to_up: ratio,
                ..limit
            })
        };
        let weight = Load::Pendulum {
            gravity: 3000.0,
            from: 20.0,
            radians: 1f64.to_radians(),
        };
        let air = Load::Air {
            constant: 500.0,
            stiffening: 60.0,
            from: 5.0,
        };
        let spring = Load::Spring {
            constant: -900.0,
            rate: 80.0,
        };
        let limits_alone = servo().limit.map(|limit| DriveLimit {
            down_to_up: 0.6,
            at_one_stiffness: true,
            ..limit
        });
        let with = |dead_band, ratio, friction, load| ServoParameters {
            dead_band,
            limit: unequal(ratio),
            friction,
            load,
            ..servo()
        };
        vec![
            servo(),
            with(Some(0.6), 1.0, None, Load::None),
            with(Some(0.6), 1.0, None, Load::Constant(2000.0)),
            with(None, 0.5, None, Load::Constant(-1800.0)),
            with(Some(0.6), 0.7, None, weight),
            with(Some(0.6), 0.7, None, spring),
            with(None, 1.2, friction(400.0, 0.1, 0.5), spring),
            // Full drive does not lift this: it rests where the air holds it.
            with(Some(0.3), 1.3, None, air),
            with(Some(0.6), 0.7, friction(400.0, 0.1, 0.5), weight),
            with(
                None,
                0.6,
                friction(1500.0, 0.2, 0.3),
                Load::Constant(-700.0),
            ),
            ServoParameters {
                limit: limits_alone,
                ..with(Some(0.6), 1.0, friction(400.0, 0.1, 0.5), weight)
            },
        ]
    }

    #[test]
    fn a_servo_that_is_put_to_its_rest_stays_there() {
        for (n, servo) in servos().iter().enumerate() {
            for command in [-20.0, 0.0, 7.0, 30.0] {
                let rest = servo.resting_angle(command);
                let later = left_alone(servo, command, rest);
                assert!(
                    (later - rest).abs() < 1e-6,
                    "{n}, {command}: {rest} {later}"
                );
            }
        }
    }

    #[test]
    fn the_rest_of_load_and_dead_band_is_the_edge_to_which_the_load_pushes() {
        let all = servos();
        // (0.6 + 2000/2500) and -1800/(0.5 2500) of the command, by the gain of 2.
        assert!((all[2].resting_output(0.0) - (0.5 - 2.8)).abs() < 1e-12);
        assert!((all[3].resting_output(0.0) - (0.5 + 2.88)).abs() < 1e-12);
    }

    #[test]
    fn friction_holds_as_far_above_the_rest_as_below() {
        for servo in servos().iter().filter(|servo| servo.friction.is_some()) {
            // Steps of the integration take the share of the gears a little early, by up to 0.0013 of the unit here.
            let (command, rest) = (3.0, servo.resting_angle(3.0));
            let [upper, lower] = [End::Upper, End::Lower].map(|end| servo.end(command, end));
            assert!((rest - (upper + lower) / 2.0).abs() < 1e-9);
            for inside in [upper - 5e-3, lower + 5e-3] {
                assert_eq!(left_alone(servo, command, inside), inside);
            }
            assert!(left_alone(servo, command, upper + 5e-3) < upper + 1e-3);
            assert!(left_alone(servo, command, lower - 5e-3) > lower - 1e-3);
        }
    }

    /// A load that grows with the angle balances full drive before the command.
    #[test]
    fn a_shaft_that_full_drive_does_not_move_stays_between_two_angles() {
        let spring = Load::Spring {
            constant: 500.0,
            rate: 400.0,
        };
        let stalled = ServoParameters {
            friction: friction(400.0, 0.0, 0.5),
            load: spring,
            ..servo()
        };
        let [full, _] = stalled.limit.unwrap().both_ways();
        let [low, high] = stalled.staying_angles(40.0);
        // Friction at rest is 600.
        let held_at = |drive: f64| (drive - 500.0) / 400.0;
        assert!((low - held_at(full - 600.0)).abs() < 1e-9, "{low}");
        assert!((high - held_at(full + 600.0)).abs() < 1e-9, "{high}");
        for inside in [low + 5e-3, high - 5e-3] {
            assert_eq!(left_alone(&stalled, 40.0, inside), inside);
        }
        assert!(left_alone(&stalled, 40.0, low - 5e-3) > low - 1e-3);
        assert!(left_alone(&stalled, 40.0, high + 5e-3) < high + 1e-3);
    }

    /// Friction or a dead band keeps the shaft where it came to rest, between the angles and nowhere beyond them.
    #[test]
    fn a_shaft_stays_at_all_angles_between_two() {
        let [_, free, loaded, ..] = servos()[..] else {
            unreachable!("there are eight servos")
        };
        // Within the dead band nothing pushes it; a load pushes it to one edge.
        assert_eq!(free.staying_angles(3.0), [2.4, 3.6]);
        let [low, high] = loaded.staying_angles(3.0);
        assert!(low == high && (low - loaded.resting_angle(3.0)).abs() < 1e-12);
        let held = ServoParameters {
            friction: friction(400.0, 0.0, 0.5),
            ..free
        };
        // Friction at rest is 600 of the 2500 for each unit beyond the dead band.
        let [low, high] = held.staying_angles(3.0);
        assert!((low - 2.16).abs() < 1e-12 && (high - 3.84).abs() < 1e-12);
        for inside in [low + 5e-3, high - 5e-3] {
            assert_eq!(left_alone(&held, 3.0, inside), inside);
        }
        assert!(
            left_alone(&held, 3.0, low - 5e-3) > low && left_alone(&held, 3.0, high + 5e-3) < high
        );
    }

    #[test]
    fn a_holding_command_holds_and_is_the_command_of_the_rest_without_friction() {
        for (n, servo) in servos().iter().enumerate() {
            let angle = 4.0;
            let command = servo.holding_command(angle);
            let later = left_alone(servo, command, angle);
            assert!((later - angle).abs() < 1e-6, "{n}: {later}");
            if servo.friction.is_none() {
                let rest = servo.resting_angle(command);
                assert!((rest - angle).abs() < 1e-9, "{n}: {rest}");
            }
        }
    }

    #[test]
    fn derivatives_of_the_rest_are_those_of_differences() {
        for (n, servo) in servos().iter().enumerate() {
            let lifted = servo.map(|place, value| Dual::<PARAMETERS>::variable(value, place));
            let slopes = lifted.resting_output(Dual::constant(7.0)).slope;
            for (place, value) in servo.in_order().iter().enumerate() {
                let at = |sign: f64| {
                    let step = sign * 1e-5 * value.abs();
                    let moved = |at, value: f64| if at == place { value + step } else { value };
                    servo.map(moved).resting_output(7.0)
                };
                let difference = (at(1.0) - at(-1.0)) / (2e-5 * value.abs());
                let close = (slopes[place] - difference).abs() <= 1e-6 * difference.abs().max(1e-3);
                assert!(
                    close || *value == 0.0,
                    "{n}, {place}: {} {difference}",
                    slopes[place]
                );
            }
        }
    }

    /// Outputs of -1 and 4 are angles of -0.75 and 1.75.
    #[test]
    fn the_shaft_rests_at_a_stop_before_its_command_and_leaves_it_again() {
        let stops = Stops {
            lower: Some(-1.0),
            upper: Some(4.0),
        };
        let stopped = ServoParameters { stops, ..servo() };
        let turned = ServoParameters {
            gain: -2.0,
            ..stopped
        };
        for (servo, ends) in [(stopped, [-0.75, 1.75]), (turned, [-1.75, 0.75])] {
            for (command, end) in [(-10.0, ends[0]), (10.0, ends[1])] {
                assert_eq!(servo.resting_angle(command), end);
                assert_eq!(left_alone(&servo, command, 0.0), end);
                assert!(left_alone(&servo, 0.2, end).abs() < 0.21);
            }
            assert_eq!(servo.resting_angle(0.5), 0.5);
        }
    }

    #[test]
    fn a_load_that_no_drive_holds_gives_the_rest_without_limit() {
        let overloaded = ServoParameters {
            load: Load::Constant(10_000.0),
            ..servo()
        };
        assert_eq!(overloaded.resting_angle(1.0), -3.0);
    }
}
