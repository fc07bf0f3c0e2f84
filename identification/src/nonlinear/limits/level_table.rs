//! The level table: rest positions by level and by direction of approach.
//!
//! Each hold that is long enough for the response to settle gives one visit: the mean output of its last
//! quarter, less the motion that a linear model which describes the servo still predicts there. Holds at one level, reached from one
//! side, form a cell. The scatter within cells is the only measure of uncertainty, so that it includes all
//! differences between visits.

use super::visits::Visit;
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
        let cell_of = |visit: &Visit| {
            let from = match visit.is_from_below() {
                true => Side::Below,
                false => Side::Above,
            };
            (visit.command, from, visit.rest)
        };
        let visits: Vec<(f64, Side, f64)> = visits.iter().map(cell_of).collect();
        let mut table = Self {
            cells: Vec::new(),
            levels: Vec::new(),
            variance: 0.0,
            degrees: 0,
            level,
            rounding: 0.5 * step,
            needed_s,
        };
        table.fill(&visits, zeros);
        table
    }

    fn fill(&mut self, visits: &[(f64, Side, f64)], zeros: usize) {
        let mut commands: Vec<f64> = visits.iter().map(|visit| visit.0).collect();
        commands.sort_by(f64::total_cmp);
        commands.dedup();
        let mut square = 0.0;
        let mut cells = Vec::new();
        for &command in &commands {
            let mut all = Vec::new();
            for from in [Side::Below, Side::Above] {
                let values: Vec<f64> = visits
                    .iter()
                    .filter(|visit| visit.0 == command && visit.1 == from)
                    .map(|visit| visit.2)
                    .collect();
                if values.is_empty() {
                    continue;
                }
                let mean = values.iter().sum::<f64>() / values.len() as f64;
                square += values.iter().map(|y| (y - mean).powi(2)).sum::<f64>();
                self.degrees += values.len() - 1;
                cells.push((command, from, mean, values.len()));
                all.extend(values);
            }
            self.levels.push(LevelMean {
                command,
                mean: all.iter().sum::<f64>() / all.len() as f64,
                visits: all.len(),
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
            .map(|(command, from, mean, visits)| Cell {
                command,
                from,
                reached: self.around(mean, 1.0 / visits as f64),
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
