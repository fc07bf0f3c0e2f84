//! Limits of speed and travel, and hysteresis, from the recording alone.
//!
//! Each detector reports its finding with an interval, or that the recording does not show it and which
//! recording would. They find nothing in linear servos of any damping, because a false alarm would start a
//! search for a fault that does not exist.
//!
//! The record needs holds: a command that is exactly constant between its steps. Sweeps and random
//! references do not show these limits.

mod directed_strokes;
mod hysteresis;
mod level_table;
mod missed_rests;
mod open_question;
mod range_end;
mod rate;
mod rests_apart;
mod speed_drift;
mod speed_limits;
mod time_to_rest;
mod visits;

use serde::{Deserialize, Serialize};

use crate::data::column::extent;
use crate::data::{EXACTLY, Record, Run, holds, sensor_step, shorter_exact_hold, usual_exact_hold};
use crate::diagnostics::followed_after;
use crate::results::{Interval, Model};
use crate::thresholds::MARGIN;
use directed_strokes::strokes_by_direction;
use time_to_rest::time_to_rest;
use visits::{Visit, visits, visits_at_rest};

pub use hysteresis::Hysteresis;
pub use level_table::{Cell, Side};
pub use missed_rests::MissedRest;
pub use range_end::RangeEnd;
pub use rate::{Rate, RateVerdict};
pub use speed_limits::SpeedLimits;

/// The limits of a servo as far as one record shows them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// Speed of strokes upwards: the output grows.
    pub rate_up: Rate,
    /// Speed of strokes downwards.
    pub rate_down: Rate,
    /// Dependence of the rest position on the direction of approach.
    pub hysteresis: Hysteresis,
    /// The ends of the commanded range, low and high; `None` when no hold is long enough.
    pub ends: Option<[RangeEnd; 2]>,
    /// The level table.
    pub levels: Vec<Cell>,
}

impl Limits {
    /// The limits found in `record`, with intervals of the confidence `level` (0 to 1). The N of its linear
    /// `model` gives the length of a response.
    ///
    /// The intervals come from the scatter of strokes and rests, not from the errors of the linear model. So
    /// they hold where that model's own bounds are withdrawn, as those of a limited servo often are.
    ///
    /// ```
    /// use servoid_identification::nonlinear::{Limits, RateVerdict};
    /// use servoid_identification::{identify, Options, Record, Settling};
    /// let u: Vec<f64> = (0..4000).map(|k| [0.0, 4.0, 2.0, 6.0, 4.0, 6.0, 2.0][k / 100 % 7]).collect();
    /// let y: Vec<f64> = u.iter().enumerate().scan(0.0, |y, (k, u)| {
    ///     *y += 0.2 * (u - *y); Some(*y + 0.002 * ((k * 7919 % 101) as f64 - 50.0) / 50.0)
    /// }).collect();
    /// let record = Record::of_run(0.002, &u, &y)?;
    /// let options = Options { settling: Settling::Samples(61), ..Options::default() };
    /// let limits = Limits::of(&record, &identify(&record, &options)?, options.level);
    /// assert_eq!(limits.rate_up.verdict, RateVerdict::Proportional);
    /// assert_eq!(limits.hysteresis.found, Some(false));
    /// # Ok::<(), servoid_identification::Error>(())
    /// ```
    pub fn of(record: &Record, model: &Model, level: f64) -> Self {
        let rests = Rests::of(record, model);
        let reversed = model.impulse_response().iter().sum::<f64>() < 0.0;
        let [up, down] = strokes_by_direction(record, rests.settling, reversed);
        let table = rests.table(Some(level));
        let of_one_zero = rests.seen_from_one_zero();
        Self {
            rate_up: Rate::new("up", &up, level),
            rate_down: Rate::new("down", &down, level),
            hysteresis: (of_one_zero.table(Some(level)).hysteresis())
                .beside(of_one_zero.apart(level)),
            ends: table.ends().map(|ends| with_stops(ends, &model.stops)),
            levels: table.cells,
        }
    }

    /// The level table alone: rest positions by level and side. Empty when no hold is long enough.
    pub fn level_table(record: &Record, model: &Model) -> Vec<Cell> {
        let rests = Rests::of(record, model);
        rests.table(model.level().into_valid()).cells
    }
}

impl Hysteresis {
    /// That of `record` alone, as among the [limits](Limits::of), and how far apart the rests under one command are \[output\], which play in the gears, a dead band or friction
    /// make: the largest distance, with bounds of the confidence `level` from the scatter of the rests. `None` where no level is reached from both sides, or no stroke is made again. The linear
    /// `model` of the record gives the length of a response.
    pub fn with_rests_apart(
        record: &Record,
        model: &Model,
        level: f64,
    ) -> (Self, Option<Interval>) {
        let rests = Rests::of(record, model).seen_from_one_zero();
        (rests.table(Some(level)).hysteresis(), rests.apart(level))
    }

    /// With how far rests are surely `apart`: in the mean over the directions strokes that overshoot and strokes that do not cancel.
    fn beside(self, apart: Option<Interval>) -> Self {
        let is_sure = |apart: &Interval| apart.lower.is_some_and(|lower| lower > 0.0);
        let bounds = |apart: Interval| Some((apart.value?, apart.lower?, apart.upper?));
        let mean = self.size.value;
        match apart.filter(is_sure).and_then(bounds).zip(mean) {
            Some(((value, lower, upper), mean)) => Self {
                statement: format!(
                    "Rests under one command are up to {value:.3} ({lower:.3} .. {upper:.3}) apart, by the strokes that led there: play, a dead band or friction \
                     leaves the servo where it came from, or beyond where it overshot. Their means from below and from above, which both kinds of strokes are in, \
                     are {mean:.3} apart."
                ),
                ..self
            },
            None => self,
        }
    }
}

/// The ends of the range, each with the one of the known `stops` \[output\] at which it rests.
fn with_stops(ends: [RangeEnd; 2], stops: &[f64]) -> [RangeEnd; 2] {
    let [low, high] = ends;
    let from = |end: &RangeEnd, stop: f64| (end.reached.value.unwrap_or(f64::NAN) - stop).abs();
    let is_low = |stop: &f64| from(&low, *stop) < from(&high, *stop);
    let (of_low, of_high): (Vec<f64>, Vec<f64>) = stops.iter().partition(|stop| is_low(stop));
    let at = |end: RangeEnd, stops: Vec<f64>| match stops.first() {
        Some(stop) => end.at_stop(*stop),
        None => end,
    };
    [at(low, of_low), at(high, of_high)]
}

/// Of the lowest and the highest command under which the servo comes to rest, those whose rests in `simulated`, run by run, are off by more than 1 % of the way
/// between the farthest rests, and rests under one command are [`apart`](Hysteresis::with_rests_apart) \[output\] in the record. The linear `model` of the record gives the length of a
/// response.
#[must_use]
pub fn missed_rests(
    record: &Record,
    simulated: &[Vec<f64>],
    model: &Model,
    apart: f64,
) -> Vec<MissedRest> {
    let pairs = record.runs().iter().zip(simulated);
    let by_model = pairs.map(|(run, output)| run.with_output(output.clone()));
    let by_model: Vec<Run> = by_model.collect();
    let settling = settling(record, model);
    let [measured, modelled] =
        [record.runs(), &by_model].map(|runs| visits(runs, settling).concat());
    let commanded = extent(record.inputs());
    commanded.map_or_else(Vec::new, |(least, largest)| {
        missed_rests::missed(&measured, &modelled, apart, [least, largest])
    })
}

/// Where a servo rests in a record: what the level table and the distance of rests are made of.
struct Rests {
    /// Those of each run.
    visits: Vec<Vec<Visit>>,
    /// Zeros of runs that were taken out.
    zeros_taken_out: usize,
    /// Samples that the response takes to settle.
    settling: usize,
    sample_period_s: f64,
    /// The steps of the sensor \[output\]; 0 where noise dithers them.
    step: f64,
}

impl Rests {
    fn of(record: &Record, model: &Model) -> Self {
        let settling = settling(record, model);
        let at_rest = runs_at_rest(record, model);
        Self {
            visits: visits_at_rest(record.runs(), &at_rest, settling),
            zeros_taken_out: 0,
            settling,
            sample_period_s: record.sample_period_s(),
            step: sensor_step(record).unwrap_or(0.0),
        }
    }

    /// The same for distances between rests, to which the zero of the sensor, or of a linkage, is nothing: where all runs make the same strokes, each has a zero
    /// of its own taken out. Their mean and every distance stay; what is left scatters as rests within a run do.
    fn seen_from_one_zero(mut self) -> Self {
        if let Some(zeros_taken_out) = visits::with_one_zero(&mut self.visits) {
            self.zeros_taken_out = zeros_taken_out;
        }
        self
    }

    fn table(&self, level: Option<f64>) -> level_table::Table {
        // The last quarter of such a hold begins well after the response is over, in other noise, too.
        let needed_s = 2.0 * self.settling as f64 * self.sample_period_s;
        let visits = self.visits.concat();
        level_table::Table::new((&visits, self.zeros_taken_out), needed_s, self.step, level)
    }

    fn apart(&self, level: f64) -> Option<Interval> {
        rests_apart::rests_apart(
            &self.visits.concat(),
            self.zeros_taken_out,
            self.step,
            level,
        )
    }
}

/// The runs of a record as their rests are read from them.
fn runs_at_rest<'a>(record: &'a Record, model: &Model) -> Vec<Run<'a>> {
    match is_described(model) {
        true => without_motion(record, model),
        false => record.runs().to_vec(),
    }
}

/// Whether the linear model describes the servo, so that its motion may be taken out of the rests and its settling time is that of the servo.
fn is_described(model: &Model) -> bool {
    model.linear && model.level().valid().is_some()
}

/// Samples that the response takes to settle. N is longer by a margin, which a model that does not describe the servo needs: other strokes take longer. It may
/// as well be far too long for the servo, whose output is at rest before. A servo that has not followed the command is not at rest: in the short holds of a sweep it moves so
/// evenly that it passes for that.
fn settling(record: &Record, model: &Model) -> usize {
    let all = model.structure.settling_samples;
    let longest = match is_described(model) {
        true => (all as f64 / MARGIN).ceil() as usize,
        false => all,
    };
    time_to_rest(record).map_or(longest, |seen| {
        // Of holds of several lengths, the response moves again after the shorter ones.
        let holds = [usual_exact_hold(record), shorter_exact_hold(record)];
        if RESTS * seen <= holds[1] {
            return seen.min(longest);
        }
        let followed = holds.map(|hold| followed_in_holds(&model.step.value, hold));
        seen.max(followed[0].min(followed[1])).min(longest)
    })
}

/// An output that stays where it is for all but this part of a hold is at rest: even motion passes for rest in the second half of a hold alone, and the long end of a linear model of play and friction is
/// none of the servo.
const RESTS: usize = 4;

/// Share of a response that has to be over at the end of the usual hold for that to be the answer to one step.
const ANSWERED: f64 = 0.5;

/// Samples until the `step` response follows. Behind play or a dead band, which a step in the other direction has to cross first, a linear model has some of the answer in the next
/// `hold`, and the servo rests before.
fn followed_in_holds(step: &[f64], hold: usize) -> usize {
    // The last element gathers what comes later.
    let (_, before_last) = step.split_last().unwrap_or((&0.0, step));
    let within = before_last.get(..hold).unwrap_or(before_last);
    let is_answer = |(end, last): (&f64, &f64)| end / last > ANSWERED;
    match within.last().zip(step.last()).is_some_and(is_answer) {
        true => followed_after(within),
        false => followed_after(step),
    }
}

/// The runs less the motion that the linear model predicts from each sample of a hold to its end, so that ringing does not pass for rest, and the
/// rest is where the servo was. Missing where the model has no full history.
fn without_motion<'a>(record: &'a Record, model: &Model) -> Vec<Run<'a>> {
    let still = |run: &'a Run| {
        let moving = model.simulate(run);
        let mut output = run.output().to_vec();
        for hold in holds(run, EXACTLY) {
            let end = moving[hold.samples.end - 1];
            for k in hold.samples {
                output[k] -= moving[k] - end;
            }
        }
        let still = Run::new(run.input(), output).ok()?;
        Some(match run.input_at_rest() {
            Some(input) => still.with_input_at_rest(input),
            None => still,
        })
    };
    // `Run::new` cannot fail for the same lengths and finite values.
    record.runs().iter().filter_map(still).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn end(command: f64, reached: f64) -> RangeEnd {
        RangeEnd {
            softens: Some(false),
            command,
            reached: Interval::new(reached, reached - 0.1, reached + 0.1),
            gain_ratio: Interval::default(),
            statement: "No stop".to_owned(),
            remedy: None,
        }
    }

    #[test]
    fn a_part_of_the_answer_in_the_next_hold_is_play_and_a_slow_servo_has_not_followed() {
        // Three quarters within 12 samples of a hold of 60, and the rest when the servo is sent back.
        let mut play: Vec<f64> = (0..120)
            .map(|k| 0.75 * (f64::from(k) / 12.0).min(1.0))
            .collect();
        play.push(1.0);
        assert_eq!(followed_in_holds(&play, 60), 11);
        let slow: Vec<f64> = (0..120)
            .map(|k| 1.0 - (f64::from(k) / -30.0).exp())
            .collect();
        assert!(followed_in_holds(&slow, 15) > 60);
    }

    #[test]
    fn a_known_stop_is_that_of_the_end_that_is_nearer() {
        let ends = || [end(-30.0, -29.9), end(27.0, 21.99)];
        let [low, high] = with_stops(ends(), &[22.0]);
        assert_eq!(low, end(-30.0, -29.9));
        assert_eq!(high.softens, Some(true));
        assert!(high.statement.contains("ends at 22.000"), "{high:?}");
        let [low, high] = with_stops(ends(), &[22.0, -30.0]);
        assert_eq!((low.softens, high.softens), (Some(true), Some(true)));
        assert_eq!(with_stops(ends(), &[]), ends());
    }
}
