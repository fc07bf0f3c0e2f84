//! How long a whole stroke takes, as the model has it: the time of a data sheet is that at top speed alone.

use super::model::ServoModel;
use servoid_dynamics::{Grid, ServoParameters, Start, simulate};

/// The part of a stroke within which it counts as ended, as settling times have it.
const ENDED: f64 = 0.02;

/// Time between two outputs \[s\].
const PERIOD_S: f64 = 0.5e-3;

/// The longest time that a stroke is followed, behind the delay \[s\]. A slow winch takes a second for 60 degrees.
const LONGEST_S: f64 = 3.0;

impl ServoModel {
    /// The times from a change of the command until the output stays within 2 % of a stroke of `size` \[output\] from where it comes to rest, up and
    /// down, about the middle of the commands of the record \[s\]. `None` where the servo does not end such a stroke, or where the
    /// record does not show how it would: its commands are narrower, and its top speed is not determined.
    #[must_use]
    pub fn stroke_times_s(&self, size: f64) -> Option<[f64; 2]> {
        let commands = self.commands?;
        let servo = self.parameters(0);
        let is_recorded = 2.0 * commands.amplitude() * servo.gain.abs() >= size;
        if !self.predicts() || !(is_recorded || self.has_top_speed()) {
            return None;
        }
        let half = 0.5 * size / servo.gain;
        let [low, high] = [-half, half].map(|from| commands.middle() + from);
        Some([
            stroke_s(&servo, [low, high], size)?,
            stroke_s(&servo, [high, low], size)?,
        ])
    }

    /// Whether the record determines the top speed in both directions.
    fn has_top_speed(&self) -> bool {
        use super::quantity_kind::QuantityKind::{TopSpeedDownwards, TopSpeedUpwards};
        let of = |kind| self.quantity(kind).is_some_and(|found| found.determined);
        of(TopSpeedUpwards) && of(TopSpeedDownwards)
    }
}

/// The time of a stroke between two commands \[s\]; `None` where it is not of this size.
fn stroke_s(servo: &ServoParameters, [from, to]: [f64; 2], size: f64) -> Option<f64> {
    let begin = servo.resting_output(from);
    let grid = Grid::for_stiffness(PERIOD_S, 0.0, servo.stiffness);
    let samples = ((servo.delay_s.max(0.0) + LONGEST_S) / PERIOD_S) as usize;
    let mut outputs = Vec::with_capacity(samples);
    let start = Start::at_rest(begin, Some(from));
    simulate(servo, &grid, &start, &vec![to; samples], |_, y| {
        outputs.push(y)
    });
    let end = *outputs.last()?;
    let near = ENDED * size;
    let late = outputs.iter().rposition(|y| (y - end).abs() > near)?;
    let is_whole = ((end - begin).abs() - size).abs() <= near;
    // One that still moves at the end has not ended.
    let has_ended = late < samples - samples / 10;
    (is_whole && has_ended).then(|| (late + 1) as f64 * PERIOD_S)
}

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_dynamics::{DriveLimit, Load, Stops};

    fn servo() -> ServoParameters {
        ServoParameters {
            delay_s: 0.02,
            stiffness: 6400.0,
            damping: 160.0,
            gain: 1.0,
            offset: 0.0,
            limit: None,
            dead_band: None,
            friction: None,
            load: Load::None,
            stops: Stops::default(),
        }
    }

    /// A servo of second order with two equal poles at p is within 2 % after the time at which (1 + pt) exp(-pt) is 0.02: pt = 5.834.
    #[test]
    fn a_linear_servo_takes_its_settling_time() {
        let found = stroke_s(&servo(), [-30.0, 30.0], 60.0).unwrap();
        assert!(
            (found - 0.02 - 5.834 / 80.0).abs() < 2.0 * PERIOD_S,
            "{found}"
        );
    }

    /// At 400 deg/s the speed takes 150 ms of 60 degrees, and the whole stroke longer by delay, acceleration and braking.
    #[test]
    fn a_limited_servo_takes_longer_than_its_speed_alone() {
        let limit = Some(DriveLimit {
            up: 16_000.0,
            down_to_up: 1.0,
            motor_damping: 40.0,
        });
        let limited = ServoParameters { limit, ..servo() };
        let found = stroke_s(&limited, [-30.0, 30.0], 60.0).unwrap();
        assert!((0.19..0.26).contains(&found), "{found}");
    }

    #[test]
    fn a_stroke_that_a_stop_cuts_short_has_no_time() {
        let stops = Stops {
            lower: None,
            upper: Some(10.0),
        };
        let stopped = ServoParameters { stops, ..servo() };
        assert_eq!(stroke_s(&stopped, [-30.0, 30.0], 60.0), None);
    }
}
