//! The stops that a servo may have.
//!
//! Their angles are not estimated: the shaft rests there. Whether they are stops, prediction decides, as it does for terms: a load that full
//! drive does not overcome holds the shaft as well.

use super::level_crests::level_crests;
use crate::data::column::{extent, mean};
use crate::data::{Record, white_noise};
use crate::diagnostics::{
    moves_beyond, outermost_rests, stops_of_rests, stops_of_several_commands,
};
use servoid_dynamics::{ServoParameters, Stops};

/// Stops that are tried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PossibleStops {
    /// All of them.
    pub(super) all: Stops,
    /// Those among them that rests or crests speak for.
    pub(super) seen: Stops,
    /// Those among these that the record shows by itself.
    pub(crate) shown: Stops,
    /// Those that several commands show, or crests: one command alone may be held by a load, friction or play.
    sure: Stops,
    /// The least and the largest command of the record.
    pub(super) commands: (f64, f64),
}

impl PossibleStops {
    /// Those at the outputs `known`, or else where the rests of the record show them; and where its crests are level, of a servo with the sign of this `gain`.
    pub(crate) fn of(record: &Record, known: &[f64], gain: f64) -> Self {
        let shown = match known {
            [] => among(record, &stops_of_rests(record)),
            _ => among(record, known),
        };
        let level: Vec<f64> = level_crests(record, gain).into_iter().flatten().collect();
        let level = among(record, &level);
        let sure = match known {
            [] => among(record, &stops_of_several_commands(record)),
            _ => shown,
        };
        let or_level = |stops: Stops| Stops {
            lower: stops.lower.or(level.lower),
            upper: stops.upper.or(level.upper),
        };
        let all = or_level(shown);
        Self {
            all,
            seen: all,
            shown,
            sure: or_level(sure),
            commands: extent(record.inputs()).unwrap_or_default(),
        }
    }

    /// The same with one where the servo rests under the outermost command, on each side that has none, where it never moves beyond and where the rest `may_be_a_stop`,
    /// a command and an output. `None` where it rests under none.
    ///
    /// That speaks for no stop: it is for a servo whose load is none but at the ends, or that goes on without one.
    pub(crate) fn with_outermost_rests(
        &self,
        record: &Record,
        may_be_a_stop: impl Fn(&[f64; 2]) -> bool,
    ) -> Option<Self> {
        let outermost = outermost_rests(record)?.into_iter().filter(may_be_a_stop);
        let stay = outermost.filter(|end| !moves_beyond(record, *end));
        let ends: Vec<f64> = stay.map(|[_, rest]| rest).collect();
        let outermost = among(record, &ends);
        let all = Stops {
            lower: self.all.lower.or(outermost.lower),
            upper: self.all.upper.or(outermost.upper),
        };
        Some(Self { all, ..*self })
    }

    /// The choices among them that have all that are shown, and that `tried` has not.
    pub(crate) fn further_choices(&self, tried: &Self) -> Vec<Stops> {
        let tried = tried.choices();
        let is_further = |choice: &Stops| self.missing(*choice) == 0 && !tried.contains(choice);
        self.choices().into_iter().filter(is_further).collect()
    }

    /// The choices among them: each is taken or left by its own evidence.
    pub(crate) fn choices(&self) -> Vec<Stops> {
        let lower = Stops {
            upper: None,
            ..self.all
        };
        let upper = Stops {
            lower: None,
            ..self.all
        };
        let mut choices = vec![Stops::default()];
        for choice in [lower, upper, self.all] {
            if !choices.contains(&choice) {
                choices.push(choice);
            }
        }
        choices
    }

    /// How many that are shown are not among the `chosen`: without one the servo has other terms in its place.
    pub(crate) fn missing(&self, chosen: Stops) -> usize {
        beyond(self.shown, chosen)
    }

    /// How many stops of a `servo` are guesses, which nothing but prediction speaks for: neither rests nor crests, nor a command under which the servo stays
    /// nowhere but beyond them.
    pub(crate) fn guessed(&self, servo: &ServoParameters) -> usize {
        let [least, largest] = servo.range();
        let free = servo.without_stops();
        let [_, highest_below] = free.staying_angles(self.commands.0);
        let [lowest_above, _] = free.staying_angles(self.commands.1);
        let (low, high) = (highest_below < least, lowest_above > largest);
        let [lower, upper] = if servo.gain < 0.0 {
            [high, low]
        } else {
            [low, high]
        };
        let Stops { lower: a, upper: b } = servo.stops;
        let not_passed = Stops {
            lower: a.filter(|_| !lower),
            upper: b.filter(|_| !upper),
        };
        beyond(not_passed, self.seen)
    }

    /// Whether full drive does not bring a `servo` without its stops to the command beyond one of them: it may be the load alone that holds the shaft there.
    pub(crate) fn may_be_load(&self, servo: &ServoParameters) -> bool {
        let free = servo.without_stops();
        let Some(limit) = free.drive_limit() else {
            return false;
        };
        let [up, down] = limit.both_ways();
        let is_stalled = |command: f64, drive: f64| {
            let short = command - free.resting_angle(command);
            short / free.error_of(drive) > 1.0
        };
        let [low, high] = if servo.gain < 0.0 {
            [servo.stops.upper, servo.stops.lower]
        } else {
            [servo.stops.lower, servo.stops.upper]
        };
        (low.is_some() && is_stalled(self.commands.0, -down))
            || (high.is_some() && is_stalled(self.commands.1, up))
    }

    /// How many of the `chosen` one command alone shows, or nothing but prediction.
    pub(crate) fn open(&self, chosen: Stops) -> usize {
        beyond(chosen, self.sure)
    }
}

/// How many of some stops are not among others.
fn beyond(some: Stops, others: Stops) -> usize {
    let more = |a: Option<f64>, b: Option<f64>| usize::from(a.is_some() && b.is_none());
    more(some.lower, others.lower) + more(some.upper, others.upper)
}

/// Part of the travel by which a stop may give.
const GIVES: f64 = 0.02;

/// Standard deviations of the noise that are no motion.
const BY_NOISE: f64 = 5.0;

/// Where more than this part of the samples is farther out there is no stop: neither noise nor glitches are so many.
const PASSED: f64 = 0.01;

/// The lower and the upper stop among some outputs: the output is nowhere beyond a stop.
fn among(record: &Record, at: &[f64]) -> Stops {
    let stops = on_their_sides(record, at);
    // Runs may have offsets of their own, by which the same stop is elsewhere.
    if stops == Stops::default() || record.runs().len() != 1 {
        return stops;
    }
    let travel = extent(record.outputs()).map_or(0.0, |(low, high)| high - low);
    let noise = white_noise(record).unwrap_or_default();
    let gives = (GIVES * travel).max(BY_NOISE * noise);
    let is_passed = |is_beyond: &dyn Fn(f64) -> bool| {
        let known = record.outputs().filter(|y| !y.is_nan());
        let (beyond, all) = known.fold((0.0, 0.0), |(beyond, all), y| {
            (beyond + f64::from(is_beyond(y)), all + 1.0)
        });
        beyond > PASSED * all
    };
    Stops {
        lower: (stops.lower).filter(|stop| !is_passed(&|y| y < stop - gives)),
        upper: (stops.upper).filter(|stop| !is_passed(&|y| y > stop + gives)),
    }
}

/// The first of these outputs below the mean of the output, and above it.
fn on_their_sides(record: &Record, at: &[f64]) -> Stops {
    let middle = mean(&record.outputs().collect::<Vec<f64>>());
    let of = |is_beyond: fn(f64, f64) -> bool| {
        let mut ends = at.iter().copied();
        ends.find(|end| middle.is_some_and(|middle| is_beyond(*end, middle)))
    };
    Stops {
        lower: of(|end, middle| end < middle),
        upper: of(|end, middle| end > middle),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_dynamics::{DriveLimit, Friction, Load};

    /// Levels that are held for 40 samples behind a lag of three, up to a stop at 6.
    fn record() -> Record<'static> {
        let levels = [
            0.0, 5.0, -10.0, 10.0, -5.0, 8.0, -7.0, 3.0, 9.0, -2.0, 7.0, 1.0,
        ];
        let input: Vec<f64> = (0..960).map(|k| levels[k / 40 % 12]).collect();
        let mut y = 0.0;
        let follow = |(k, u): (usize, &f64)| {
            y = f64::min(y + (u - y) / 3.0, 6.0);
            y + 0.01 * (0.7 * (k * k) as f64).sin()
        };
        let output: Vec<f64> = input.iter().enumerate().map(follow).collect();
        Record::of_run(0.01, input, output).unwrap()
    }

    #[test]
    fn where_the_servo_goes_beyond_it_there_is_no_stop() {
        let record = record();
        // Between 5 and 6, under commands of 7, 8, 9 and 10.
        let upper = |at: f64| among(&record, &[at]).upper;
        assert_eq!(upper(5.5), None);
        assert_eq!(upper(6.0), Some(6.0));
    }

    #[test]
    fn stops_that_are_known_are_taken_and_else_those_of_the_rests() {
        let record = record();
        let possible = |known: &[f64]| {
            let found = PossibleStops::of(&record, known, 1.0);
            assert_eq!(found.all, found.shown);
            found.all
        };
        let found = possible(&[]);
        assert_eq!(found.lower, None);
        assert!((found.upper.unwrap() - 6.0).abs() < 0.01, "{found:?}");
        let known = possible(&[6.1, -10.1]);
        assert_eq!((known.lower, known.upper), (Some(-10.1), Some(6.1)));
        let lower = possible(&[-10.1]);
        assert_eq!((lower.lower, lower.upper), (Some(-10.1), None));
    }

    #[test]
    fn each_stop_is_tried_with_and_without_the_other() {
        let counts = |lower, upper| {
            let all = Stops { lower, upper };
            let possible = PossibleStops {
                all,
                seen: all,
                shown: all,
                sure: all,
                commands: (0.0, 0.0),
            };
            let choices = possible.choices();
            choices.iter().map(Stops::count).collect::<Vec<_>>()
        };
        assert_eq!(counts(None, None), [0]);
        assert_eq!(counts(Some(-1.0), None), [0, 1]);
        assert_eq!(counts(None, Some(1.0)), [0, 1]);
        assert_eq!(counts(Some(-1.0), Some(1.0)), [0, 1, 1, 2]);
    }

    #[test]
    fn the_outermost_rest_is_tried_beside_the_stop_that_is_shown() {
        let record = record();
        let possible = PossibleStops::of(&record, &[], 1.0);
        let wider = possible.with_outermost_rests(&record, |_| true).unwrap();
        assert_eq!(
            (wider.shown, wider.all.upper),
            (possible.shown, possible.all.upper)
        );
        assert!((wider.all.lower.unwrap() + 10.0).abs() < 0.01, "{wider:?}");
        assert_eq!(wider.further_choices(&possible), [wider.all]);
        let guessed = |stops, friction, load| {
            let friction = Friction {
                coulomb: friction,
                at_rest: None,
                of_gears: 0.0,
            };
            wider.guessed(&ServoParameters {
                gain: 0.9,
                dead_band: Some(0.3),
                friction: Some(friction),
                load: Load::Constant(load),
                stops,
                ..ServoParameters::linear(100.0, 20.0)
            })
        };
        // The command of -10 leads to -9, which is not as far as -10, and to half a unit beyond a stop at -8.5.
        assert_eq!(guessed(wider.all, 0.0, 0.0), 1);
        assert_eq!(guessed(possible.all, 0.0, 0.0), 0);
        let lower = Some(-8.5);
        let before = Stops { lower, ..wider.all };
        assert_eq!(guessed(before, 10.0, 0.0), 0);
        assert_eq!(guessed(before, 50.0, 0.0), 1);
        // A load that pushes to smaller angles adds to the command, the other one holds the shaft off.
        assert_eq!(guessed(before, 50.0, 40.0), 0);
        assert_eq!(guessed(before, 10.0, -40.0), 1);
        assert_eq!(possible.further_choices(&possible), []);
    }

    /// Full drive is 1000, which a load that grows by 150 for each unit of the angle holds at 6.7: before the command of 10, and beyond the stop at 6.
    #[test]
    fn a_stop_beside_a_load_that_full_drive_does_not_overcome_may_be_the_load() {
        let record = record();
        let possible = PossibleStops::of(&record, &[], 1.0);
        let with = |rate| ServoParameters {
            limit: Some(DriveLimit {
                up: 1000.0,
                down_to_up: 1.0,
                motor_damping: 10.0,
                at_one_stiffness: false,
            }),
            load: Load::Spring {
                constant: 0.0,
                rate,
            },
            stops: possible.all,
            ..ServoParameters::linear(1000.0, 60.0)
        };
        assert!(possible.may_be_load(&with(150.0)));
        assert!(!possible.may_be_load(&with(50.0)));
    }

    #[test]
    fn a_record_whose_rests_follow_has_none() {
        let record = record();
        let run = &record.runs()[0];
        let free: Vec<f64> = run
            .input()
            .iter()
            .scan(0.0, |y, u| {
                *y += (u - *y) / 3.0;
                Some(*y)
            })
            .collect();
        let record = Record::of_run(0.01, run.input().to_vec(), free).unwrap();
        assert!(PossibleStops::of(&record, &[], 1.0).all.are_none());
    }
}
