//! The ends of the commanded range: whether the servo softens or stops there.
//!
//! The gain from one level to the next at each end of the range is held against that of most of the range. Levels are compared by rests that
//! were reached from the same side, which hysteresis does not part: an end is reached from one side alone, and its neighbour mostly from both.
//! Where two levels have no side in common, hysteresis makes the further one fall short. A servo that friction holds rests a little off at
//! each level, and at some ends by more than at other levels by chance.
//!
//! What hysteresis and the others explain is not shown to be a stop, and not shown to be none where much is missing. Where not even a stop
//! would show, by rests that scatter or levels that are close to each other, it is left open, too.

use super::level_table::{Cell, LevelMean, Side, Table};
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
    /// The same end with `share` % of the gain elsewhere, where that is less than chance, and no more than others leave out.
    fn short_without_reason(self, share: f64) -> Self {
        let (command, reached) = (self.command, self.reached.value.unwrap_or_default());
        let open = OpenQuestion {
            finding: format!(
                "This recording does not determine whether the servo softens or stops at a command of {command:.3}: {reached:.3} is reached \
                 there, with {share:.0} % of the gain elsewhere, which is short by no more than hysteresis or the errors of other levels"
            ),
            remedy:
                "Record this level and one beyond it several times each, all from the same side."
                    .to_owned(),
        };
        Self {
            statement: open.statement(),
            remedy: Some(open.remedy),
            ..self
        }
    }

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
            reached: self.around(level.mean, level.share),
            gain_ratio: Interval::default(),
            statement: open.statement(),
            remedy: Some(open.remedy),
        };
        if self.levels.len() < LEVELS_FOR_ENDS || self.degrees < 2 {
            return end;
        }
        let mut segments: Vec<Segment> = self
            .levels
            .windows(2)
            .map(|pair| self.segment([&pair[0], &pair[1]]))
            .collect();
        let (last, neighbours) = if high {
            (segments.pop(), &self.levels[self.levels.len() - 2..])
        } else {
            (Some(segments.remove(0)), &self.levels[..2])
        };
        let Some((last, usual)) = last.zip(usual_gain(&segments)) else {
            return end;
        };
        let way = last.width * usual.abs();
        let sd = (self.variance * last.share).sqrt() / way;
        let ratio = last.gain / usual;
        let by_hysteresis = self.by_hysteresis(&last);
        let explained = (by_hysteresis + self.without_stop(&segments, usual)) / way;
        end.gain_ratio = self.within(ratio, sd).widened(by_hysteresis / way);
        let by_chance = self.critical(RANGE_END_FALSE_ALARM) * sd;
        let softens = SOFT_END - ratio > by_chance + explained;
        let is_short = 1.0 - ratio > by_chance + explained;
        // Where not even a stop would show, that there is none says nothing.
        if !softens && SOFT_END <= by_chance + explained {
            return end;
        }
        if !is_short && ratio < SOFT_END - by_chance {
            return end.short_without_reason(100.0 * ratio);
        }
        (end.softens, end.remedy) = (Some(softens), None);
        end.statement = match (softens, ratio < HARD_STOP) {
            (false, _) if !is_short && 1.0 - ratio > by_chance => format!(
                "No stop at the {name} end: {:.3} is reached at a command of {:.3}, with {:.0} % of the gain elsewhere. That is short \
                 by no more than hysteresis, the other levels or {:.0} % of the travel explain.",
                level.mean,
                level.command,
                100.0 * ratio,
                100.0 * STOP_SHORT
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

    /// What two neighbouring levels have between them, by the sides from which both were reached, and by all rests where there is none.
    fn segment(&self, [low, high]: [&LevelMean; 2]) -> Segment {
        let width = high.command - low.command;
        let of = |command: f64, side: Side| {
            let cell = |cell: &&Cell| cell.command == command && cell.from == side;
            let cell = self.cells.iter().find(cell)?;
            Some((cell.reached.value?, cell.visits as f64))
        };
        // Weights of the mean with the smallest variance.
        let (mut weights, mut sum) = (0.0, 0.0);
        for side in [Side::Below, Side::Above] {
            if let Some((lower, upper)) = of(low.command, side).zip(of(high.command, side)) {
                let weight = (lower.1.recip() + upper.1.recip()).recip();
                weights += weight;
                sum += weight * (upper.0 - lower.0);
            }
        }
        if weights > 0.0 {
            return Segment {
                gain: sum / weights / width,
                width,
                share: weights.recip(),
                has_common_side: true,
            };
        }
        Segment {
            gain: (high.mean - low.mean) / width,
            width,
            share: low.share + high.share,
            has_common_side: false,
        }
    }

    /// By how much hysteresis may make this `segment` fall short \[output\].
    fn by_hysteresis(&self, segment: &Segment) -> f64 {
        if segment.has_common_side {
            return 0.0;
        }
        let hysteresis = self.hysteresis();
        let size = hysteresis.size.upper.or(hysteresis.size.value);
        let found = size.filter(|_| hysteresis.found == Some(true));
        found.unwrap_or_default()
    }

    /// By how much an end may fall short without a stop and without hysteresis \[output\]: by how far others of the `segments` go beyond
    /// that of the gain `usual`. Those that fall short of it may be beyond the same stop.
    fn without_stop(&self, segments: &[Segment], usual: f64) -> f64 {
        let beyond = segments.iter().map(|segment| {
            let further = (segment.gain / usual - 1.0) * (segment.width * usual).abs();
            further - self.by_hysteresis(segment)
        });
        let travel = segments.iter().map(|segment| segment.gain * segment.width);
        let least = STOP_SHORT * travel.sum::<f64>().abs();
        beyond.fold(least, f64::max)
    }
}

/// What is between two neighbouring levels.
#[derive(Debug, Clone, Copy)]
struct Segment {
    /// Output for each unit of the command.
    gain: f64,
    /// Distance of their commands.
    width: f64,
    /// Variance of the difference of their rests, in that of one visit.
    share: f64,
    /// Whether both were reached from the same side.
    has_common_side: bool,
}

/// The gain in most of the range of the command: beyond a stop there may be more levels than before it.
fn usual_gain(segments: &[Segment]) -> Option<f64> {
    let mut segments = segments.to_vec();
    segments.sort_by(|a, b| a.gain.total_cmp(&b.gain));
    let range: f64 = segments.iter().map(|segment| segment.width).sum();
    let mut passed = 0.0;
    let at_half = |segment: &&Segment| {
        passed += segment.width;
        2.0 * passed >= range
    };
    segments.iter().find(at_half).map(|segment| segment.gain)
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
                samples: 10,
                taken_out: 0.0,
            })
        });
        visits.collect()
    }

    fn high_end(levels: &[f64], stop: f64) -> Option<bool> {
        let table = Table::new((&stopped(levels, stop, 5), 0), 0.1, 0.0, Some(0.99));
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

    /// The lower end of a servo with play of 0.8 that stops at `stop`: all levels but the end are reached from both sides.
    fn low_end_with_play(stop: f64) -> RangeEnd {
        let levels = [-50.0, -47.0, -42.0, -33.0, -18.0, 2.0, 22.0];
        let visit = |command: f64, side: f64, k: usize| Visit {
            command,
            before: command + side,
            rest: (command + 0.4 * side).max(stop) + 0.02 * ((k * 7 % 5) as f64 - 2.0),
            moved: 0.0,
            samples: 10,
            taken_out: 0.0,
        };
        let sides = |command: f64| {
            if command == -50.0 {
                vec![1.0]
            } else {
                vec![1.0, -1.0]
            }
        };
        let visits: Vec<Visit> = levels
            .iter()
            .flat_map(|&command| sides(command).into_iter().map(move |side| (command, side)))
            .flat_map(|(command, side)| (0..3).map(move |k| visit(command, side, k)))
            .collect();
        let [low, _] = Table::new((&visits, 0), 0.1, 0.0, Some(0.99))
            .ends()
            .unwrap();
        low
    }

    #[test]
    fn play_neither_makes_a_stop_nor_hides_one() {
        let free = low_end_with_play(-60.0);
        assert!(free.statement.starts_with("No stop"), "{}", free.statement);
        // Half of the last step is missing.
        let stopped = low_end_with_play(-48.1);
        assert_eq!(stopped.softens, Some(true), "{}", stopped.statement);
    }

    #[test]
    fn an_end_that_is_short_by_what_other_levels_are_is_open() {
        // A quarter of the last step is missing, 1 % of the travel.
        let end = low_end_with_play(-48.9);
        assert_eq!(end.softens, None, "{}", end.statement);
        assert!(
            end.statement.contains("of the gain elsewhere"),
            "{}",
            end.statement
        );
    }
}
