//! The level table: rest positions by level and by direction of approach.
//!
//! Each hold that is long enough for the response to settle gives one visit: the mean output of its last
//! quarter, less the motion that a linear model which describes the servo still predicts there. Holds at one level, reached from one
//! side, form a cell. The scatter within cells is the measure of uncertainty, so that it includes all differences between visits; the motion that the model
//! takes out is in the intervals besides, because it is off by the same in each visit.

use super::visits::{Visit, share_of_variance};
use crate::results::Interval;
use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// The side from which a level was reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// By a stroke upwards.
    Below,
    /// By a stroke downwards.
    Above,
}

impl Side {
    fn of(visit: &Visit) -> Self {
        match visit.is_from_below() {
            true => Self::Below,
            false => Self::Above,
        }
    }
}

/// All visits to one level from one side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// The commanded level.
    pub command: f64,
    /// The side from which it was reached.
    pub from: Side,
    /// Mean of the output at rest, with its interval from the scatter between visits.
    pub reached: Interval,
    /// Number of visits.
    pub visits: usize,
}

/// The level table of a record.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Table {
    pub(super) cells: Vec<Cell>,
    /// Mean rest at each level, over both sides, ascending by command.
    pub(super) levels: Vec<LevelMean>,
    /// Variance within cells and its degrees of freedom.
    pub(super) variance: f64,
    pub(super) degrees: usize,
    /// Confidence level of intervals; `None` where they have no bounds.
    pub(super) level: Option<f64>,
    /// How far a rest may be off because the sensor has steps \[output\]. Each visit of a level is rounded alike, so scatter does not show it.
    pub(super) rounding: f64,
    /// Hold to record for further visits \[s\].
    pub(super) needed_s: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct LevelMean {
    pub(super) command: f64,
    pub(super) mean: f64,
    /// Its variance, as a share of that of one visit.
    pub(super) share: f64,
    pub(super) visits: usize,
}

impl Table {
    /// The table of `visits`, others of which take holds of `needed_s`, of a sensor with steps of `step`, which is 0 where noise dithers them. So many `zeros` of runs
    /// were taken out of their rests.
    pub(super) fn new(
        (visits, zeros): (&[Visit], usize),
        needed_s: f64,
        step: f64,
        level: Option<f64>,
    ) -> Self {
        let mut table = Self {
            cells: Vec::new(),
            levels: Vec::new(),
            variance: 0.0,
            degrees: 0,
            level,
            rounding: 0.5 * step,
            needed_s,
        };
        table.fill(visits, zeros);
        table
    }

    fn fill(&mut self, visits: &[Visit], zeros: usize) {
        let mut commands: Vec<f64> = visits.iter().map(|visit| visit.command).collect();
        commands.sort_by(f64::total_cmp);
        commands.dedup();
        let mut square = 0.0;
        let mut cells = Vec::new();
        for &command in &commands {
            let of_level = || visits.iter().filter(|visit| visit.command == command);
            for from in [Side::Below, Side::Above] {
                let of_side = || of_level().filter(|visit| Side::of(visit) == from);
                let count = of_side().count();
                if count == 0 {
                    continue;
                }
                let mean = of_side().map(|visit| visit.rest).sum::<f64>() / count as f64;
                square += of_side()
                    .map(|visit| (visit.rest - mean).powi(2))
                    .sum::<f64>();
                self.degrees += count - 1;
                let taken_out =
                    of_side().map(|visit| visit.taken_out.abs()).sum::<f64>() / count as f64;
                let share = share_of_variance(of_side(), visits);
                cells.push((command, from, (mean, taken_out), share, count));
            }
            let count = of_level().count();
            self.levels.push(LevelMean {
                command,
                mean: of_level().map(|visit| visit.rest).sum::<f64>() / count as f64,
                share: share_of_variance(of_level(), visits),
                visits: count,
            });
        }
        self.degrees = self.degrees.saturating_sub(zeros);
        self.variance = if self.degrees > 0 {
            square / self.degrees as f64
        } else {
            0.0
        };
        self.cells = cells
            .into_iter()
            .map(|(command, from, (mean, taken_out), share, visits)| Cell {
                command,
                from,
                reached: self.around(mean, share).reaching(taken_out, taken_out),
                visits,
            })
            .collect();
    }

    /// Student's interval of a rest whose variance is `share` of that of one visit.
    pub(super) fn around(&self, rest: f64, share: f64) -> Interval {
        let interval = self.within(rest, (self.variance * share).sqrt());
        interval.reaching(self.rounding, self.rounding)
    }

    /// Student's interval of a value with a standard deviation.
    pub(super) fn within(&self, value: f64, sd: f64) -> Interval {
        let half = self
            .level
            .map(|level| self.critical(0.5 - level / 2.0) * sd);
        Interval::around(value, half)
    }

    /// Student's quantile with `tail` above it; infinite without degrees of freedom.
    pub(super) fn critical(&self, tail: f64) -> f64 {
        StudentsT::new(0.0, 1.0, self.degrees as f64)
            .map_or(f64::INFINITY, |t| -t.inverse_cdf(tail))
    }
}
