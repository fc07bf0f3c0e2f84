//! Where a servo rests, against its command.
//!
//! Friction and a dead band hold a servo on the side that it comes from, so what they leave changes its sign with the direction of the
//! stroke. A zero that is off, or a load, does not. A gain that is not one makes errors that grow with the command, so the rests are split into three:
//!
//! ```text
//! y = c + g (u - m) + f s        s = 1 after a stroke upwards, -1 downwards
//! ```
//!
//! With m the middle of the commands, the servo rests c - m from its command there; with a gain that is surely not one, what counts is where
//! it rests under command 0. Under two levels every stroke upwards ends at the same command, and g and f are one.
//!
//! Where the columns have different units, one cannot be subtracted from the other; where a unit is not known, they may have, and then the rests
//! have to lie about their commands: with a gain near 1, and off by less than the travel.
//!
//! Rests at a stop are left out: the stop holds them off their commands. Where rests change along the recording by half as much as they are off,
//! that is a drift of the sensor, which says nothing about its zero.

use super::model_metadata::unit_meant;
use super::units::Units;
use servoid_identification::column::{mean, span};
use servoid_identification::diagnostics::stops_of_rests;
use servoid_identification::results::{Advice, Check};
use servoid_identification::{Record, Run};

/// The shortest hold in which a servo may come to rest (s), and its samples.
const SHORTEST_S: f64 = 0.3;
const SHORTEST_SAMPLES: usize = 8;
/// Rests that are needed to distinguish the two parts.
const RESTS: usize = 4;
/// A part of the travel that matters.
const MATTERS: f64 = 0.01;
/// A slope of the rests over their commands from which on both columns are one angle.
const ONE_ANGLE: std::ops::RangeInclusive<f64> = 0.8..=1.25;
/// The same where a unit is not known: 4096 counts for 360 degrees of 10 µs are a slope of 1.14, and no angle.
const ONE_UNKNOWN_ANGLE: std::ops::RangeInclusive<f64> = 0.95..=1.05;
/// Standard deviations of the mean beyond which it is not chance.
const BEYOND_CHANCE: f64 = 4.0;

/// Parts of a recording that are compared for a drift, and the rests that each has at least.
const PARTS: usize = 8;
const RESTS_OF_PART: usize = 4;

/// A rest under a held command.
pub(crate) struct CommandedRest {
    pub(crate) command: f64,
    pub(crate) position: f64,
    upwards: bool,
}

/// All rests of a record; none where it has no position.
pub(crate) fn rests_of(record: &Record) -> Vec<CommandedRest> {
    let hold = (SHORTEST_S / record.sample_period_s()).ceil() as usize;
    let hold = hold.max(SHORTEST_SAMPLES);
    let runs = record.runs();
    let travel = span(runs.iter().flat_map(Run::output).copied()).unwrap_or_default();
    let of_run = |run| rests(run, hold, MATTERS * travel);
    runs.iter().flat_map(of_run).collect()
}

/// What to do about a servo that rests off its command.
const LOOK_AT: &str = "Look at the zero of the sensor, at the horn on its spline and at a load that pulls to one side. The step response does not \
    depend on it.";

/// Advice where the servo rests off its command by more than its friction explains.
pub(super) fn advice(record: &Record, units: Units<'_>) -> Option<Advice> {
    let is_known = match [units.input, units.output].map(|unit| unit.and_then(unit_meant)) {
        [Some(input), Some(output)] if input != output => return None,
        // A position without a unit is in counts of the sensor, or in degrees.
        [Some(input), None] if input == "us" => return None,
        [input, output] => input.is_some() && output.is_some(),
    };
    let travel = span(record.outputs())?;
    let mut all = rests_of(record);
    let stops = stops_of_rests(record);
    let is_at_stop = |rest: &CommandedRest| {
        let mut ways = stops.iter().map(|stop| (rest.position - stop).abs());
        ways.any(|way| way < MATTERS * travel)
    };
    all.retain(|rest| !is_at_stop(rest));
    let upwards = all.iter().filter(|rest| rest.upwards).count();
    if all.len() < RESTS || upwards.min(all.len() - upwards) < 2 {
        return None;
    }
    let line = Line::through(&all)?;
    let may_be_one = match is_known {
        true => ONE_ANGLE.contains(&line.slope),
        false => ONE_UNKNOWN_ANGLE.contains(&line.slope) && line.at_middle.0.abs() < travel,
    };
    if !may_be_one {
        return None;
    }
    // What a gain that is not one adds is no zero that is off. Under two levels it cannot be distinguished from friction.
    let of_gain =
        line.friction.is_some() && (line.slope - 1.0).abs() > BEYOND_CHANCE * line.slope_sd;
    let (off, off_sd) = match of_gain {
        true => line.at_zero,
        false => line.at_middle,
    };
    let least = MATTERS * travel;
    let beside = line.friction.map_or(line.direction, f64::abs);
    let chance = BEYOND_CHANCE * off_sd;
    let is_off = off.abs() > beside.max(least).max(chance).max(2.0 * line.drift());
    let unit = (units.output).map_or_else(String::new, |unit| format!(" {unit}"));
    is_off.then(|| {
        Advice::new(
            Check::Zeros,
            match of_gain {
                true => format!(
                    "A straight line through {} rests is at {off:.2}{unit} where the command is 0.",
                    all.len()
                ),
                false => format!(
                    "{} rests {off:+.2}{unit} from its command (mean of {} rests).",
                    match is_known {
                        true => "The servo",
                        false => "If command and position have one unit, the servo",
                    },
                    all.len()
                ),
            },
            off,
            beside,
            match line.friction {
                Some(_) => LOOK_AT.to_owned(),
                // A stop at one of two levels is as an offset and a gain.
                None => format!(
                    "{LOOK_AT} Or one of the two levels is beyond a stop, which stairs or random levels show."
                ),
            },
        )
    })
}

/// What keeps a servo short of its commands, of the way between the outermost ones, which are reached from the inside.
pub(crate) struct ShortOfCommand {
    /// What changes with the direction of the stroke, the same at all levels; `None` of what is chance.
    pub(crate) by_direction: Option<f64>,
    /// What grows with the command.
    pub(crate) by_gain: Option<f64>,
}

impl ShortOfCommand {
    /// `None` where the command changes with the direction, so that nothing distinguishes the two.
    pub(crate) fn of(rests: &[CommandedRest], commanded: f64) -> Option<Self> {
        let line = Line::through(rests)?;
        let by_direction = -2.0 * line.friction?;
        let by_gain = (1.0 - line.slope) * commanded;
        let beyond = |short: f64, sd: f64| (short > BEYOND_CHANCE * sd).then_some(short);
        Some(Self {
            by_direction: beyond(by_direction, 2.0 * line.friction_sd),
            by_gain: beyond(by_gain, line.slope_sd * commanded),
        })
    }
}

/// The rests of a run: holds whose last quarter has one mean in both of its halves, to within `still`.
fn rests(run: &Run<'_>, hold: usize, still: f64) -> Vec<CommandedRest> {
    let (input, output) = (run.input(), run.output());
    let mut found = Vec::new();
    let mut begin = 0;
    for stretch in input.chunk_by(|a, b| a == b) {
        let end = begin + stretch.len();
        let before = begin.checked_sub(1).and_then(|k| input.get(k)).copied();
        let before = before.or(run.input_at_rest());
        let command = stretch.first().copied().unwrap_or(f64::NAN);
        let quarter = stretch.len() / 4;
        let halves = [end - quarter..end - quarter / 2, end - quarter / 2..end];
        let means =
            halves.map(|half| mean(output.get(half).unwrap_or_default()).unwrap_or(f64::NAN));
        begin = end;
        let Some(before) = before.filter(|before| *before != command) else {
            continue;
        };
        if stretch.len() >= hold && (means[0] - means[1]).abs() < still {
            found.push(CommandedRest {
                command,
                position: (means[0] + means[1]) / 2.0,
                upwards: command > before,
            });
        }
    }
    found
}

/// Share of the scatter of the directions that must not follow the command, for friction to be known beside the gain.
const SEPARATE: f64 = 0.05;

/// The line through the rests, beside the direction that they were reached in.
struct Line {
    /// Position at the middle of the commands, less that command, and its standard deviation.
    at_middle: (f64, f64),
    /// Position under command 0, and its standard deviation.
    at_zero: (f64, f64),
    slope: f64,
    slope_sd: f64,
    /// What changes with the direction of the stroke, to each side: less than nothing of a servo that is held back. `None` where the command changes
    /// with it.
    friction: Option<f64>,
    /// Its standard deviation.
    friction_sd: f64,
    /// The same with what the command adds, where nothing distinguishes the two.
    direction: f64,
    /// What the line leaves of each rest.
    errors: Vec<f64>,
}

impl Line {
    /// `None` for rests of one command.
    fn through(rests: &[CommandedRest]) -> Option<Self> {
        let column = |of: fn(&CommandedRest) -> f64| -> Vec<f64> { rests.iter().map(of).collect() };
        let commands = column(|rest| rest.command);
        let positions = column(|rest| rest.position);
        let directions = column(|rest| if rest.upwards { 1.0 } else { -1.0 });
        let (u, y, s) = (mean(&commands)?, mean(&positions)?, mean(&directions)?);
        let [du, dy, ds] = [(commands, u), (positions, y), (directions, s)]
            .map(|(values, mean)| values.iter().map(|value| value - mean).collect::<Vec<_>>());
        let square = product(&du, &du);
        if square <= 0.0 {
            return None;
        }
        let along = product(&ds, &du) / square;
        let beside: Vec<f64> = ds.iter().zip(&du).map(|(s, u)| s - along * u).collect();
        let separate = product(&beside, &beside);
        let is_separate = separate > SEPARATE * product(&ds, &ds);
        let f = match is_separate {
            true => product(&dy, &beside) / separate,
            false => 0.0,
        };
        let slope = product(&dy, &du) / square - f * along;
        let count = rests.len() as f64;
        let left = dy.iter().zip(du.iter().zip(&ds));
        let left: Vec<f64> = left.map(|(y, (u, s))| y - slope * u - f * s).collect();
        let variance = product(&left, &left) / (count - 3.0).max(1.0);
        let of_friction = if is_separate { s * s / separate } else { 0.0 };
        // The commands may lie to one side of their middle.
        let range = rests.iter().map(|rest| rest.command);
        let (low, high) = range.fold((f64::MAX, f64::MIN), |(low, high), u| {
            (low.min(u), high.max(u))
        });
        let middle = f64::midpoint(low, high);
        let of_friction_in_slope = if is_separate {
            along * along / separate
        } else {
            0.0
        };
        let at = |command: f64| {
            let of_slope = (command - u).powi(2) / square;
            let of_both = 1.0 / count + of_friction + of_slope;
            (
                y - f * s + slope * (command - u),
                (variance * of_both).sqrt(),
            )
        };
        let (position, sd) = at(middle);
        let errors = dy.iter().zip(&du).map(|(y, u)| y - u);
        let direction = errors.zip(&ds).map(|(error, s)| error * s).sum::<f64>();
        Some(Self {
            at_middle: (position - middle, sd),
            at_zero: at(0.0),
            slope,
            slope_sd: (variance * (1.0 / square + of_friction_in_slope)).sqrt(),
            friction: is_separate.then_some(f),
            friction_sd: (variance / separate).sqrt(),
            direction: (direction / product(&ds, &ds)).abs(),
            errors: left,
        })
    }

    /// The range of the means of the errors over parts of the recording; 0 of too few.
    fn drift(&self) -> f64 {
        let parts = (self.errors.len() / RESTS_OF_PART).min(PARTS);
        let size = self.errors.len().div_ceil(parts.max(1));
        let means = self.errors.chunks(size).filter_map(mean);
        span(means).unwrap_or_default()
    }
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEGREES: Units<'static> = Units {
        input: Some("deg"),
        output: Some("deg"),
    };

    /// A servo that rests `off` its command and is held back by `friction`, under steps of this travel to each side.
    fn record(off: f64, friction: f64) -> Record<'static> {
        let command = |k: usize| {
            if (k / 50).is_multiple_of(2) {
                -100.0
            } else {
                100.0
            }
        };
        let input: Vec<f64> = (0..600).map(command).collect();
        let output = (0..600).map(|k| {
            let noise = ((k * k * 7919) % 101) as f64 / 1000.0;
            let target = command(k) + off - friction * command(k).signum();
            match k % 50 {
                0..5 => 0.0,
                _ => target + noise,
            }
        });
        let output: Vec<f64> = output.collect();
        Record::of_run(0.02, input, output).unwrap()
    }

    #[test]
    fn an_offset_is_distinguished_from_friction() {
        let found = advice(&record(3.0, 1.0), DEGREES).unwrap();
        assert!((found.value - 3.05).abs() < 0.1, "{}", found.value);
        assert!((found.threshold - 1.0).abs() < 0.1, "{}", found.threshold);
        assert!(found.finding.contains("rests +3.0"), "{}", found.finding);
        assert_eq!(advice(&record(1.0, 0.0), DEGREES), None);
        assert_eq!(advice(&record(3.0, 4.0), DEGREES), None);
    }

    #[test]
    fn a_drift_is_no_zero_that_is_off() {
        let drifting = |rise: f64| {
            let (mut input, mut output) = (Vec::new(), Vec::new());
            let still = record(0.0, 0.0);
            let run = &still.runs()[0];
            for (k, (u, y)) in run.input().iter().zip(run.output()).enumerate() {
                input.push(*u);
                output.push(y + 3.0 + rise * k as f64 / 600.0);
            }
            Record::of_run(0.02, input, output).unwrap()
        };
        assert!(advice(&drifting(0.0), DEGREES).is_some());
        assert!(advice(&drifting(1.0), DEGREES).is_some());
        // It begins at the command and ends ten off.
        let from_zero = drifting(10.0);
        let run = &from_zero.runs()[0];
        let output: Vec<f64> = run.output().iter().map(|y| y - 3.0).collect();
        let from_zero = Record::of_run(0.02, run.input().to_vec(), output).unwrap();
        assert_eq!(advice(&from_zero, DEGREES), None);
    }

    /// Levels at random, of a servo without friction or offset that stops at 12 of 20.
    #[test]
    fn a_stop_is_no_zero_that_is_off() {
        let level = |hold: usize| ((hold * 7919 + 3) % 41) as f64 - 20.0;
        let input: Vec<f64> = (0..3000).map(|k| level(k / 50)).collect();
        let output = |k: usize| {
            let noise = ((k * k * 7919) % 101) as f64 / 1000.0 - 0.05;
            match k % 50 {
                0..5 => 0.0,
                _ => input[k].min(12.0) + noise,
            }
        };
        let output: Vec<f64> = (0..3000).map(output).collect();
        let record = Record::of_run(0.02, input.clone(), output).unwrap();
        assert_eq!(advice(&record, DEGREES), None);
    }

    #[test]
    fn nothing_is_subtracted_from_another_unit() {
        let of = |input, output| Units { input, output };
        let us = |output| of(Some("us"), output);
        // Counts of 10 µs for a degree, about another middle.
        let (still, unknown) = (record(3.0, 1.0), Units::default());
        let counts = |gain: f64, middle: f64| {
            let run = &still.runs()[0];
            let output: Vec<f64> = run.output().iter().map(|y| gain * y + middle).collect();
            Record::of_run(0.02, run.input().to_vec(), output).unwrap()
        };
        assert_eq!(advice(&counts(1.08, 60.0), us(None)), None);
        for units in [us(None), us(Some("counts")), unknown] {
            assert_eq!(advice(&counts(1.138, -1602.0), units), None, "{units:?}");
            assert_eq!(advice(&counts(1.0, -1602.0), units), None, "{units:?}");
        }
        assert!(advice(&still, of(Some("deg"), Some("°"))).is_some());
        assert!(advice(&still, unknown).is_some());
        assert_eq!(advice(&still, us(Some("deg"))), None);
    }

    /// Five levels about `middle`, each reached from below and from above, of a servo with this gain and friction that rests `off` under command 0.
    fn five_levels(gain: f64, friction: f64, off: f64, middle: f64) -> Option<Advice> {
        let level = |hold: usize| middle + 10.0 * [0.0, 1.0, -1.0, 2.0, 1.0, -2.0, -1.0][hold % 7];
        let input: Vec<f64> = (0..1600).map(|k| level(k / 50)).collect();
        let output = (0..1600).map(|k| {
            let upwards = level(k / 50) > level(k / 50 + 6);
            let noise = ((k * k * 7919) % 101) as f64 / 1000.0 - 0.05;
            let side = if upwards { -friction } else { friction };
            match k % 50 {
                0..5 => 0.0,
                _ => gain * input[k] + off + side + noise,
            }
        });
        let output: Vec<f64> = output.collect();
        let record = Record::of_run(0.02, input.clone(), output).unwrap();
        advice(&record, DEGREES)
    }

    /// With a gain that is not one, what is off is what is left under command 0.
    #[test]
    fn a_gain_is_no_zero_that_is_off() {
        let found = five_levels(0.9, 0.5, 2.0, 20.0).unwrap();
        let finding = &found.finding;
        assert!(finding.starts_with("A straight line through "), "{finding}");
        assert!(finding.contains(" rests is at 2.0"), "{finding}");
        assert!(finding.ends_with(" where the command is 0."), "{finding}");
        assert!((found.value - 2.0).abs() < 0.1, "{}", found.value);
        // In the middle of its commands it rests 2 beside them.
        assert_eq!(five_levels(0.9, 0.5, 0.0, 20.0), None);
        let of_one = five_levels(1.0, 0.5, 2.0, 20.0).unwrap();
        let said = "The servo rests +2.0";
        assert!(of_one.finding.starts_with(said), "{}", of_one.finding);
    }

    /// Five levels, the inner ones reached from both sides, of a servo that is held back by half a degree, of one with a gain of 0.9, and of one with both.
    #[test]
    fn what_holds_back_is_distinguished_from_a_gain() {
        let of = |gain: f64, held_back: f64| {
            let level = |k: usize| 10.0 * [0.0, 1.0, -1.0, 2.0, 1.0, -2.0, -1.0][k % 7];
            let rest = |k: usize| {
                let upwards = level(k) > level(k + 6);
                let side = if upwards { -held_back } else { held_back };
                let noise = ((k * k * 7919) % 101) as f64 / 1000.0 - 0.05;
                CommandedRest {
                    command: level(k),
                    position: gain * level(k) + side + noise,
                    upwards,
                }
            };
            let rests: Vec<CommandedRest> = (1..42).map(rest).collect();
            let found = ShortOfCommand::of(&rests, 40.0).unwrap();
            [found.by_direction, found.by_gain].map(|short| short.map(|short| short.round()))
        };
        assert_eq!(of(1.0, 0.5), [Some(1.0), None]);
        assert_eq!(of(0.9, 0.0), [None, Some(4.0)]);
        assert_eq!(of(0.9, 0.5), [Some(1.0), Some(4.0)]);
        // Two levels do not show it.
        let rest = |k: usize| CommandedRest {
            command: [10.0, -10.0][k % 2],
            position: [9.0, -9.0][k % 2],
            upwards: k.is_multiple_of(2),
        };
        let two: Vec<CommandedRest> = (0..12).map(rest).collect();
        assert!(ShortOfCommand::of(&two, 20.0).is_none());
    }
}
