//! The outcome of a comparison, as plain data.

use serde::{Deserialize, Serialize};

use super::motion::Motion;
use super::over_prediction::OverPrediction;
use super::rests_apart::RestsApart;
use super::sides::Sides;
use super::verdict::Verdict;
use crate::results::{Advice, Bounds, Interval, Reason};

/// Version of the JSON document.
pub const SCHEMA: u32 = 3;

/// What a verdict and its bounds are of.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Subject {
    /// These recordings: the bounds are those of the noise, and a servo differs from run to run.
    #[default]
    Runs,
    /// The servos, each the mean of its runs: the bounds contain the scatter of three or more runs a side.
    Servos,
}

/// Simultaneous bounds of the largest difference.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DifferencePercent {
    /// \[% of the step\], zero when there may be none.
    pub at_least: f64,
    /// \[% of the step\].
    pub at_most: f64,
    /// When the difference is surest, after the edge \[s\].
    pub at_s: f64,
    /// On which strokes.
    pub stroke: Direction,
}

/// Which strokes a curve belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Direction {
    /// Both: no side answers them differently.
    Both,
    /// Upwards.
    Up,
    /// Downwards.
    Down,
}

/// Second step response minus the first; its bounds hold for all points of all curves at once.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DifferenceCurve {
    /// The strokes it belongs to.
    pub stroke: Direction,
    /// Time after the edge \[s\].
    pub time_s: Vec<f64>,
    /// Difference \[% of the step\].
    pub percent: Vec<f64>,
    /// Its bounds, where they hold.
    #[serde(flatten)]
    pub bounds: Bounds<CurveBounds>,
    /// The delay shift on these strokes alone \[s\], as [`Comparison::delay_shift_s`].
    pub delay_shift_s: Interval,
    /// How far apart the estimated responses are where that shift leaves them farthest, less what the curve between samples may make \[% of their final
    /// values\], without bounds: zero when a delay is all that lies between them.
    pub shift_leaves_percent: Option<f64>,
    /// By how much more they may be, as nobody knows a response between its samples \[likewise\].
    #[serde(default)]
    pub shift_between_rows_percent: Option<f64>,
    /// What that shift leaves, and the difference of the final values, at the least, less what the bounds of the difference allow for \[likewise\]; zero where that may be all of it, `None` without
    /// bounds.
    #[serde(default)]
    pub shift_leaves_at_least_percent: Option<f64>,
    /// Whether what that shift leaves is nowhere more than the bounds of the difference allow for: noise, and scatter of the runs, may be all of it.
    #[serde(default)]
    pub shift_leaves_noise: bool,
}

/// Bounds of a difference curve \[% of the step\].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CurveBounds {
    /// Lower bounds.
    pub lower: Vec<f64>,
    /// Upper bounds.
    pub upper: Vec<f64>,
}

/// Where one side comes to rest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Levels {
    /// Largest command.
    pub command_plus: f64,
    /// Rest at the largest command.
    pub plus: Interval,
    /// Smallest command.
    pub command_minus: f64,
    /// Rest at the smallest command.
    pub minus: Interval,
}

/// Whether one side answers up and down strokes differently.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Asymmetry {
    /// Probability of the difference seen if it does not; `None` when the record has no answer.
    pub p: Option<f64>,
    /// Largest difference between up and down \[% of the stroke\].
    pub largest_percent: Option<f64>,
}

/// One metric of both sides, each identified with the structure that the comparison gives both.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MetricDifference {
    /// Name of the metric, as in the model.
    pub metric: String,
    /// Of the first side.
    pub a: Option<f64>,
    /// Its bounds.
    pub a_bounds: Option<[f64; 2]>,
    /// Of the second side.
    pub b: Option<f64>,
    /// Its bounds.
    pub b_bounds: Option<[f64; 2]>,
    /// b - a.
    pub difference: Option<f64>,
    /// Lower bound of the difference.
    pub lower: Option<f64>,
    /// Upper bound of the difference.
    pub upper: Option<f64>,
}

/// Bounds of the difference.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ComparisonBounds {
    /// Level of every bound.
    pub level: f64,
    /// Bounds of the largest difference between the responses.
    pub difference_percent: DifferencePercent,
    /// Bounds of [`Comparison::delay_shift_s`] \[s\].
    pub delay_shift_s: Option<[f64; 2]>,
}

/// Two servos, or one servo under two conditions, side by side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Version of this document.
    pub schema: u32,
    /// The answer.
    pub verdict: Verdict,
    /// What it is of, and all bounds of differences.
    #[serde(default)]
    pub of: Subject,
    /// The margin it is held against \[% of the step\].
    pub margin_percent: f64,
    /// The bounds that the verdict rests on. There are none, and no verdict, where a side has none.
    #[serde(flatten)]
    pub bounds: Bounds<ComparisonBounds>,
    /// Why a side has no bounds; left out where both have them.
    #[serde(default, skip_serializing_if = "Sides::have_none")]
    pub without_bounds: Sides<Option<Reason>>,
    /// Runs on each side.
    pub runs: [usize; 2],
    /// Delay that brings the first response closest to the second, each relative to its own final
    /// value \[s\]; `None` when there is no best one.
    pub delay_shift_s: Option<f64>,
    /// The definition of the delay shift.
    pub delay_shift_definition: String,
    /// Whether up and down strokes are compared apart.
    pub split: bool,
    /// Whether both sides have one settling time and number of frequencies. Not where a side has bounds with its own alone, nor of models.
    pub one_structure: bool,
    /// The reference of each side; `None` without records.
    #[serde(default)]
    pub motions: Option<Sides<Motion>>,
    /// Whether the references differ, and a side is not linear or the step responses surely differ: then the difference is one of
    /// descriptions of two motions, and no finding about the servos.
    #[serde(default)]
    pub descriptions_of_different_motions: bool,
    /// Whether waits of the two recordings, of the lengths that the options allow for, may be what makes the responses differ beyond the margin: then there is no verdict.
    #[serde(default)]
    pub may_be_waits: bool,
    /// Whether the second surely turns the other way under the same command: its gain has the other sign.
    #[serde(default)]
    pub turns_the_other_way: bool,
    /// Whether both sides are known to have samples in common: then the comparison says nothing about the servos. Who has the files
    /// finds that, so a new comparison has `false`.
    #[serde(default)]
    pub same_data: bool,
    /// By how much the first, driven like the second, goes farther; `None` without plateaus at two
    /// levels.
    pub over_prediction: Option<OverPrediction>,
    /// Where each side comes to rest at the ends of the command; `None` without records or bounds.
    pub levels: Option<Sides<Levels>>,
    /// How far apart the rests under one command are on each side; `None` without records, under references that differ, and where a
    /// record has no bounds for what is wrong with it.
    #[serde(default)]
    pub rests_apart: Option<RestsApart>,
    /// Up against down strokes on each side; `None` without records or bounds.
    pub asymmetry: Option<Sides<Asymmetry>>,
    /// Metrics of both sides.
    pub differences: Vec<MetricDifference>,
    /// The difference of the step responses: one curve, or up and down strokes.
    pub curves: Vec<DifferenceCurve>,
    /// The answer in two sentences.
    pub summary: String,
    /// Questions that the recordings leave open, and how to answer them.
    pub advice: Vec<Advice>,
}

impl Comparison {
    /// Whether the step responses have bounds that say something of the servos.
    #[must_use]
    pub fn has_verdict(&self) -> bool {
        self.bounds.valid().is_some() && !self.descriptions_of_different_motions
    }
}
