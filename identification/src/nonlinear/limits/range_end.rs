//! The ends of the commanded range: whether the servo softens or stops there.
//!
//! The gain from one level to the next at each end of the range is held against that of most of the range. Where not even a stop would
//! show, by rests that scatter or levels that are close to each other, it is left open. An end is reached from one side alone, and its
//! neighbour from both, so hysteresis makes
//! it fall short. A servo that friction holds rests a little off at each level, and at some ends by more than at
//! other levels by chance. What hysteresis and the others explain is no stop.

use super::level_table::{LevelMean, Table};
use super::open_question::OpenQuestion;
use crate::results::Interval;
use crate::thresholds::{HARD_STOP, LEVELS_FOR_ENDS, RANGE_END_FALSE_ALARM, SOFT_END, STOP_SHORT};
use serde::{Deserialize, Serialize};

/// One end of the commanded range.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RangeEnd {
    /// Whether the gain falls there; `None` when the recording does not show it.
    pub softens: Option<bool>,
    /// The last level commanded on this side.
    pub command: f64,
    /// Where the servo rests at that command.
    pub reached: Interval,
    /// Gain of the last segment relative to that of most of the range.
    pub gain_ratio: Interval,
    /// The finding as a sentence.
    pub statement: String,
    /// What to record where this recording does not show it, as a sentence; `None` where it does.
    #[serde(default)]
    pub remedy: Option<String>,
}

impl RangeEnd {
    /// The same end of a servo that is known to rest at the output `stop` there, where the levels alone do not show it: of levels at random, few are
    /// visited twice.
    pub(super) fn at_stop(self, stop: f64) -> Self {
        if self.softens == Some(true) {
            return self;
        }
        Self {
            softens: Some(true),
            statement: format!(
                "The output ends at {stop:.3}, as at a stop: the last command there is {:.3}.",
                self.command
            ),
            remedy: None,
            ..self
        }
    }
}

impl Table {
    /// The low and the high end of the range.
    pub(super) fn ends(&self) -> Option<[RangeEnd; 2]> {
        let (low, high) = (self.levels.first()?, self.levels.last()?);
        Some([self.end("low", low, false), self.end("high", high, true)])
    }

    fn end(&self, name: &str, level: &LevelMean, high: bool) -> RangeEnd {
        let open = OpenQuestion {
            finding: format!(
                "This recording does not determine whether the servo softens or stops at a command of \
                 {:.3}, where it reaches {:.3}",
                level.command, level.mean
            ),
            remedy: format!(
                "Record stairs of at least {LEVELS_FOR_ENDS} levels, both ends included, each visited at \
                 least twice and held for at least {:.2} s.",
                self.needed_s
            ),
        };
        let mut end = RangeEnd {
            softens: None,
            command: level.command,
            reached: self.around(level.mean, 1.0 / level.visits as f64),
            gain_ratio: Interval::default(),
            statement: open.statement(),
            remedy: Some(open.remedy),
        };
        if self.levels.len() < LEVELS_FOR_ENDS || self.degrees < 2 {
            return end;
        }
        let mut segments: Vec<(f64, f64)> = self
            .levels
            .windows(2)
            .map(|pair| {
                let width = pair[1].command - pair[0].command;
                ((pair[1].mean - pair[0].mean) / width, width)
            })
            .collect();
        let (last, neighbours) = if high {
            (segments.pop(), &self.levels[self.levels.len() - 2..])
        } else {
            (Some(segments.remove(0)), &self.levels[..2])
        };
        let Some(((gain, width), others)) = last.zip(usual_gain(&segments)) else {
            return end;
        };
        let share: f64 = neighbours
            .iter()
            .map(|level| 1.0 / level.visits as f64)
            .sum();
        let way = width * others.abs();
        let sd = (self.variance * share).sqrt() / way;
        let ratio = gain / others;
        let explained = self.without_stop(&segments, others) / way;
        end.gain_ratio = self.within(ratio, sd).widened(self.by_hysteresis() / way);
        let by_chance = self.critical(RANGE_END_FALSE_ALARM) * sd;
        let softens = SOFT_END - ratio > by_chance + explained;
        let is_short = 1.0 - ratio > by_chance + explained;
        // Where not even a stop would show, that there is none says nothing.
        if !softens && SOFT_END <= by_chance + explained {
            return end;
        }
        (end.softens, end.remedy) = (Some(softens), None);
        end.statement = match (softens, ratio < HARD_STOP) {
            (false, _) if !is_short && 1.0 - ratio > by_chance => format!(
                "No stop at the {name} end: {:.3} is reached at a command of {:.3}, with {:.0} % of the gain elsewhere. That is short \
                 by no more than hysteresis, the other levels or 1 % of the travel explain.",
                level.mean,
                level.command,
                100.0 * ratio
            ),
            (false, _) if is_short => format!(
                "The {name} end falls short: {:.3} is reached at a command of {:.3}, with {:.1} % of the gain elsewhere, by a stop or by \
                 a gain that falls.",
                level.mean,
                level.command,
                100.0 * ratio
            ),
            (false, _) => format!(
                "No stop at the {name} end: {:.3} is reached at a command of {:.3}.",
                level.mean, level.command
            ),
            // The level before rests at the same angle: two commands end there.
            (true, true) if ratio.abs() <= by_chance + explained => {
                format!("Hard stop at {:.3} (the {name} end).", level.mean)
            }
            (true, true) => format!(
                "The {name} end falls short of one command, as at a hard stop: {:.3} is reached at a command of {:.3}, with {:.1} % of the gain \
                 elsewhere. A second command beyond it would show whether it is one.",
                level.mean,
                level.command,
                100.0 * ratio
            ),
            (true, false) => format!(
                "The {name} end softens: the last {:.3} of command move the output by only {:.3}.",
                neighbours[1].command - neighbours[0].command,
                (neighbours[1].mean - neighbours[0].mean).abs()
            ),
        };
        end
    }

    /// By how much hysteresis may make an end fall short \[output\].
    fn by_hysteresis(&self) -> f64 {
        let hysteresis = self.hysteresis();
        let size = hysteresis.size.upper.or(hysteresis.size.value);
        let found = size.filter(|_| hysteresis.found == Some(true));
        found.unwrap_or_default()
    }

    /// By how much it may without a stop \[output\]: by hysteresis, and by how far others of the `segments` between levels, gain and width, go beyond
    /// that of the gain `usual`. Those that fall short of it may be beyond the same stop.
    fn without_stop(&self, segments: &[(f64, f64)], usual: f64) -> f64 {
        let beyond = segments
            .iter()
            .map(|(gain, width)| (gain / usual - 1.0) * (width * usual).abs());
        let travel = segments.iter().map(|(gain, width)| gain * width);
        let least = STOP_SHORT * travel.sum::<f64>().abs();
        (self.by_hysteresis() + beyond.fold(0.0, f64::max)).max(least)
    }
}

/// The gain in most of the range of the command, of `segments` between levels, gain and width: beyond a stop there may be more levels than before it.
fn usual_gain(segments: &[(f64, f64)]) -> Option<f64> {
    let mut segments = segments.to_vec();
    segments.sort_by(|a, b| a.0.total_cmp(&b.0));
    let range: f64 = segments.iter().map(|(_, width)| width).sum();
    let mut passed = 0.0;
    let at_half = |(_, width): &&(f64, f64)| {
        passed += width;
        2.0 * passed >= range
    };
    segments.iter().find(at_half).map(|(gain, _)| *gain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nonlinear::limits::visits::Visit;

    /// Visits of a servo of gain 1 which is stopped at ±`stop`: `often` at each of these levels, from below.
    fn stopped(levels: &[f64], stop: f64, often: usize) -> Vec<Visit> {
        let visits = levels.iter().flat_map(|command| {
            (0..often).map(move |k| Visit {
                command: *command,
                before: command - 1.0,
                rest: command.clamp(-stop, stop) + 0.02 * ((k * 7 % 5) as f64 - 2.0),
                moved: 0.0,
            })
        });
        visits.collect()
    }

    fn high_end(levels: &[f64], stop: f64) -> Option<bool> {
        let table = Table::new(&stopped(levels, stop, 5), 0.1, 0.0, Some(0.99));
        table.ends().unwrap()[1].softens
    }

    #[test]
    fn a_stop_is_found_where_most_levels_are_beyond_it() {
        // A switch whose two positions are others in each run.
        let levels = [-39.4, -35.0, -31.0, -28.7, 28.7, 31.0, 35.0, 39.4];
        assert_eq!(high_end(&levels, 27.0), Some(true));
        assert_eq!(high_end(&levels, 50.0), Some(false));
    }

    #[test]
    fn levels_that_are_closer_than_rests_scatter_leave_it_open() {
        let levels = [-5.0, -2.0, 0.0, 3.0, 4.98, 5.0];
        assert_eq!(high_end(&levels, 50.0), None);
        assert_eq!(high_end(&levels, 4.6), None);
    }
}
