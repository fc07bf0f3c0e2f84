//! How long a whole stroke takes, as the model has it: the time of a data sheet is that at top speed alone.

use super::ServoModel;
use super::top_speed_reached::AT_TOP_SPEED;
use crate::servo_model::motion::reached_speeds::{STROKE_S, fastest};
use servoid_dynamics::{Grid, ServoParameters, Start, simulate};

/// The part of a stroke within which it counts as ended, as settling times have it.
const ENDED: f64 = 0.02;

/// The part of a stroke by which its ends stay away from stops: there the servo brakes by itself, and where it rests depends on load and friction, too.
const FREE: f64 = 0.05;

/// Time between two outputs \[s\].
const PERIOD_S: f64 = 0.5e-3;

/// A stroke that is so many times as fast as any in the record may meet a limit that the record does not show. Twice as fast are, behind a linear servo, strokes
/// twice as large. A limit that the model has, but the record does not determine, may be anywhere above the speeds of the record.
const FASTER_IF_LINEAR: f64 = 2.0;

/// A stroke of this size moves by so much of it at the least: less is one that something holds.
const LEAST_PART: f64 = 0.8;

/// By this part of it a stroke may miss its size: a tenth of what its end is looked at with.
const CLOSE: f64 = 2e-3;

/// Strokes that are tried until one is of the size. Springs make what is missing smaller by their part of the loop each time.
const TRIALS: usize = 8;

/// The longest time that a stroke is followed, behind the delay \[s\]. A slow winch takes a second for 60 degrees.
const LONGEST_S: f64 = 3.0;

impl ServoModel {
    /// The times from a change of the command until the output stays within 2 % of a stroke of `size` \[output\] from where it comes to rest, up and
    /// down, about the middle of the commands of the record, or as near to it as the stops leave it free \[s\]. `None` where the servo does not end
    /// such a stroke, or where the
    /// record does not show how it would: its commands are narrower, or it had no stroke so fast, and its top speed is not determined.
    #[must_use]
    pub fn stroke_times_s(&self, size: f64) -> Option<[f64; 2]> {
        let commands = self.commands?;
        let servo = self.parameters(0);
        let is_recorded = 2.0 * commands.amplitude() * servo.gain.abs() >= size;
        let has_top_speed = self.has_top_speed();
        if !self.predicts() || !(is_recorded || has_top_speed) {
            return None;
        }
        let [low, high] = between_stops(&servo, commands.middle(), size)?;
        let reached = (self.reached).filter(|_| !has_top_speed);
        let faster = match self.terms.is_limited() {
            true => AT_TOP_SPEED.recip(),
            false => FASTER_IF_LINEAR,
        };
        let known = reached.map_or([f64::INFINITY; 2], |reached| {
            reached.measured().map(|speed| faster * speed)
        });
        let of = |ends: [f64; 2], fastest: f64| {
            let stroke = Stroke::of_size(&servo, ends, size)?;
            (stroke.fastest <= fastest).then_some(stroke.time_s)
        };
        Some([of([low, high], known[0])?, of([high, low], known[1])?])
    }

    /// Whether the record determines the top speed in both directions.
    fn has_top_speed(&self) -> bool {
        use crate::servo_model::quantities::quantity_kind::QuantityKind::{
            TopSpeedDownwards, TopSpeedUpwards,
        };
        let of = |kind| self.quantity(kind).is_some_and(|found| found.determined);
        of(TopSpeedUpwards) && of(TopSpeedDownwards)
    }
}

/// The commands from and to which a stroke of `size` goes, as near to the command `middle` as the stops leave it free. `None` where they are too near to each
/// other.
fn between_stops(servo: &ServoParameters, middle: f64, size: f64) -> Option<[f64; 2]> {
    let reach = (0.5 + FREE) * size;
    let lowest = servo
        .stops
        .lower
        .map_or(f64::NEG_INFINITY, |stop| stop + reach);
    let highest = servo.stops.upper.map_or(f64::INFINITY, |stop| stop - reach);
    let output = (lowest <= highest).then_some(servo.gain * middle + servo.offset)?;
    let middle = middle + (output.clamp(lowest, highest) - output) / servo.gain;
    let half = 0.5 * size / servo.gain;
    Some([middle - half, middle + half])
}

/// A stroke between two commands.
struct Stroke {
    /// From the change of the command to its end \[s\].
    time_s: f64,
    /// Its highest speed, as the [speeds that were reached](crate::servo_model::motion::reached_speeds) are measured \[output/s\].
    fastest: f64,
}

impl Stroke {
    /// The stroke of this size about the middle of these commands, which a load, play or a dead band let end elsewhere; `None` where the servo ends none.
    fn of_size(servo: &ServoParameters, commands: [f64; 2], size: f64) -> Option<Self> {
        let mut between = commands;
        for _ in 0..TRIALS {
            let (stroke, moved) = Self::of(servo, between, size)?;
            if (moved - size).abs() <= CLOSE * size {
                return Some(stroke);
            }
            between = stretched(between, size / moved);
        }
        None
    }

    /// The stroke between these commands and how far it goes, as one of about this size; `None` where it has no end.
    fn of(servo: &ServoParameters, [from, to]: [f64; 2], size: f64) -> Option<(Self, f64)> {
        let begin = servo.resting_output(from);
        let grid = Grid::for_stiffness(PERIOD_S, 0.0, servo.stiffness);
        let samples = ((servo.delay_s.max(0.0) + LONGEST_S) / PERIOD_S) as usize;
        let mut outputs = Vec::with_capacity(samples);
        let start = Start::at_rest(begin, Some(from));
        simulate(servo, &grid, &start, &vec![to; samples], |_, y| {
            outputs.push(y)
        });
        let end = *outputs.last()?;
        let late = (outputs.iter()).rposition(|y| (y - end).abs() > ENDED * size)?;
        let moved = (end - begin).abs();
        // One that still moves at the end has not ended.
        let has_ended = late < samples - samples / 10;
        let is_like_it = (LEAST_PART..=LEAST_PART.recip()).contains(&(moved / size));
        let (up, down) = fastest(&outputs, (STROKE_S / PERIOD_S) as usize);
        let stroke = Self {
            time_s: (late + 1) as f64 * PERIOD_S,
            fastest: up.max(down) / PERIOD_S,
        };
        (is_like_it && has_ended).then_some((stroke, moved))
    }
}

/// The commands about the same middle, this many times as far apart.
fn stretched([from, to]: [f64; 2], times: f64) -> [f64; 2] {
    let (middle, half) = (f64::midpoint(from, to), times * (to - from) / 2.0);
    [middle - half, middle + half]
}

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_dynamics::{DriveLimit, Load, Stops};

    fn servo() -> ServoParameters {
        ServoParameters {
            delay_s: 0.02,
            ..ServoParameters::linear(6400.0, 160.0)
        }
    }

    /// A servo of second order with two equal poles at p is within 2 % after the time at which (1 + pt) exp(-pt) is 0.02: pt = 5.834.
    #[test]
    fn a_linear_servo_takes_its_settling_time() {
        let found = Stroke::of_size(&servo(), [-30.0, 30.0], 60.0).unwrap();
        let time_s = found.time_s;
        assert!(
            (time_s - 0.02 - 5.834 / 80.0).abs() < 2.0 * PERIOD_S,
            "{time_s}"
        );
        // p²t exp(-pt) is p/e at its peak, and means over 20 ms on both sides of it are less.
        let peak = 60.0 * 80.0 / std::f64::consts::E;
        assert!((0.6 * peak..peak).contains(&found.fastest));
    }

    /// At 400 deg/s the speed takes 150 ms of 60 degrees, and the whole stroke longer by delay, acceleration and braking.
    #[test]
    fn a_limited_servo_takes_longer_than_its_speed_alone() {
        let limit = Some(DriveLimit {
            up: 16_000.0,
            down_to_up: 1.0,
            motor_damping: 40.0,
            at_one_stiffness: false,
        });
        let limited = ServoParameters { limit, ..servo() };
        let found = Stroke::of_size(&limited, [-30.0, 30.0], 60.0)
            .unwrap()
            .time_s;
        assert!((0.19..0.26).contains(&found), "{found}");
    }

    /// A spring of 4 % of the loop and a play of 1 degree take 3.3 degrees off a command of 60.
    #[test]
    fn a_stroke_that_a_load_ends_early_is_made_whole() {
        let softer = ServoParameters {
            load: Load::Spring {
                constant: 0.0,
                rate: 0.04 * servo().stiffness,
            },
            play: Some(1.0),
            ..servo()
        };
        let (_, moved) = Stroke::of(&softer, [-30.0, 30.0], 60.0).unwrap();
        assert!((56.0..58.0).contains(&moved), "{moved}");
        let whole = Stroke::of_size(&softer, [-30.0, 30.0], 60.0).unwrap();
        // Its stiffness is 1.04 times as large, and the play takes 1 degree to cross.
        assert!((0.08..0.11).contains(&whole.time_s), "{}", whole.time_s);
    }

    #[test]
    fn a_stroke_that_a_stop_cuts_short_has_no_time() {
        let stops = Stops {
            lower: None,
            upper: Some(10.0),
        };
        let stopped = ServoParameters { stops, ..servo() };
        assert!(Stroke::of_size(&stopped, [-30.0, 30.0], 60.0).is_none());
    }

    #[test]
    fn a_stroke_keeps_away_from_stops() {
        let between = |lower, upper| {
            let stops = Stops { lower, upper };
            let gain = 0.5;
            between_stops(
                &ServoParameters {
                    stops,
                    gain,
                    offset: 4.0,
                    ..servo()
                },
                12.0,
                60.0,
            )
        };
        // About an output of 10.
        assert_eq!(between(None, None), Some([-48.0, 72.0]));
        assert_eq!(between(Some(-40.0), Some(50.0)), Some([-48.0, 72.0]));
        // Three below the stop: the middle is at -1.
        assert_eq!(between(None, Some(32.0)), Some([-70.0, 50.0]));
        assert_eq!(between(Some(-20.0), None), Some([-42.0, 78.0]));
        assert_eq!(between(Some(-32.0), Some(32.0)), None);
    }

    /// A lag that was recorded under `command` of so many degrees by time \[s\].
    fn times(command: fn(f64) -> f64) -> Option<[f64; 2]> {
        let input: Vec<f64> = (0..1500).map(|k| command(0.01 * f64::from(k))).collect();
        let follow = |y: &mut f64, (k, u): (usize, &f64)| {
            *y += 0.2 * (u - *y);
            Some(*y + 0.02 * (0.7 * (k * k) as f64).sin())
        };
        let output: Vec<f64> = input.iter().enumerate().scan(0.0, follow).collect();
        let record = crate::Record::of_run(0.01, input, output).unwrap();
        let model = crate::servo_model::fit(&record, &Default::default()).unwrap();
        model.stroke_times_s(60.0)
    }

    /// A tester that sweeps over 90 degrees does not show how fast the servo is.
    #[test]
    fn a_slow_sweep_says_nothing_of_a_quick_stroke() {
        let steps = |t: f64| 30.0 * (f64::from((t / 0.7) as i32 * 7 % 5) - 2.0);
        assert!(times(steps).is_some());
        let sweep = |t: f64| {
            45.0 * (2.0 / std::f64::consts::PI) * (std::f64::consts::TAU * t / 6.0).sin().asin()
        };
        assert_eq!(times(sweep), None);
    }
}
