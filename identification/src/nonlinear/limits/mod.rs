//! What no linear model can show: limits of speed and travel, and hysteresis, from the recording
//! alone.
//!
//! Each detector says what it found, with an interval, or that the recording cannot tell and what to
//! record instead. They are built to stay silent on linear servos of any damping: a limit that is
//! not there would send someone looking for a fault that is not there.
//!
//! The record must have holds: a command that stands still, exactly, between its steps. From sweeps
//! and random references these limits cannot be told.

pub(crate) mod levels;
mod rate;

use serde::{Deserialize, Serialize};

use crate::data::holds;
use crate::data::record::{Record, Run};
use crate::results::model::Model;
use crate::selection::settling_time::MARGIN;

pub use levels::{Cell, Hysteresis, RangeEnd, Side};
pub use rate::{Rate, RateVerdict};

/// The limits of a servo as far as one record shows them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// Speed of strokes upwards.
    pub rate_up: Rate,
    /// Speed of strokes downwards.
    pub rate_down: Rate,
    /// Dependence of the rest position on the direction of approach.
    pub hysteresis: Hysteresis,
    /// The ends of the commanded range, low and high; `None` when no hold is long enough.
    pub ends: Option<[RangeEnd; 2]>,
    /// Where the servo rests, by level and side.
    pub levels: Vec<Cell>,
}

impl Limits {
    /// Looks for limits in `record`, of which `model` is a plain model: its N says how long a
    /// response lasts, its level how wide intervals are.
    ///
    /// ```
    /// use servoid_identification::limits::{Limits, RateVerdict};
    /// use servoid_identification::{identify, Options, Record, Settling};
    /// let u: Vec<f64> = (0..4000).map(|k| [0.0, 4.0, 2.0, 6.0, 4.0, 6.0, 2.0][k / 100 % 7]).collect();
    /// let y: Vec<f64> = u.iter().enumerate().scan(0.0, |y, (k, u)| {
    ///     *y += 0.2 * (u - *y); Some(*y + 0.002 * ((k * 7919 % 101) as f64 - 50.0) / 50.0)
    /// }).collect();
    /// let record = Record::from_slices(0.002, &u, &y)?;
    /// let options = Options { settling: Settling::Samples(61), ..Options::default() };
    /// let limits = Limits::of(&record, &identify(&record, &options)?);
    /// assert_eq!(limits.rate_up.verdict, RateVerdict::Proportional);
    /// assert_eq!(limits.hysteresis.found, Some(false));
    /// # Ok::<(), servoid_identification::Error>(())
    /// ```
    #[must_use]
    pub fn of(record: &Record, model: &Model) -> Self {
        let settling = settling(model);
        let level = model.level().into_valid();
        let strokes = holds::strokes(record, settling);
        let (up, down): (Vec<_>, Vec<_>) =
            strokes.into_iter().partition(|stroke| stroke.size > 0.0);
        let table = table(record, model);
        Self {
            rate_up: Rate::new("up", &up, level),
            rate_down: Rate::new("down", &down, level),
            hysteresis: table.hysteresis(),
            ends: table.ends(),
            levels: table.cells,
        }
    }

    /// The level table by itself: where the servo rests, by level and side. Empty when no hold is
    /// long enough.
    #[must_use]
    pub fn level_table(record: &Record, model: &Model) -> Vec<Cell> {
        table(record, model).cells
    }

    /// All findings as sentences.
    #[must_use]
    pub fn statements(&self) -> Vec<&str> {
        let ends = self.ends.iter().flatten().map(|end| end.statement.as_str());
        [
            self.rate_up.statement.as_str(),
            self.rate_down.statement.as_str(),
            self.hysteresis.statement.as_str(),
        ]
        .into_iter()
        .chain(ends)
        .collect()
    }
}

fn table(record: &Record, model: &Model) -> levels::Table {
    levels::Table::new(
        &at_rest(record, model),
        record.sample_period_s(),
        settling(model),
        model.level().into_valid(),
    )
}

/// Samples that the response takes to settle: N is a margin longer.
fn settling(model: &Model) -> usize {
    (model.structure.settling_samples as f64 / MARGIN).ceil() as usize
}

/// The runs without what the linear model says is still moving, so that ringing is not taken for
/// rest: y(k) - (ŷ(k) - c - G0 u(k)). Missing where the model has no full history.
fn at_rest(record: &Record, model: &Model) -> Vec<Run> {
    let still = |run: &Run| {
        let moving = model.simulate(run);
        let output: Vec<f64> = (0..run.len())
            .map(|k| run.output()[k] - (moving[k] - model.offset - model.theta[0] * run.input()[k]))
            .collect();
        let still = Run::new(run.input(), output).ok()?;
        Some(match run.input_at_rest() {
            Some(input) => still.with_input_at_rest(input),
            None => still,
        })
    };
    // Finite inputs and outputs of equal length stay so.
    record.runs().iter().filter_map(still).collect()
}
