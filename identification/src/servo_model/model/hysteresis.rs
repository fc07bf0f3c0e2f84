//! Positions of rest that depend on the direction of approach, in the record and by a model of the servo.

use super::ServoModel;
use crate::results::{Interval, Reason};
use crate::servo_model::quantities::quantity_kind::QuantityKind;

/// Rests that are farther apart in the record than the model shows why, or than it is sure to show why: it has friction and a dead band, but no play of
/// the gears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnexplainedHysteresis {
    /// Between rests under one command, the farthest in the record \[output\]; `None` where it shows only that they depend on the direction of approach.
    pub shown: Option<f64>,
    /// What friction and dead band of the model make of it at the most \[output\]: those of the fit, whether or not the record determines each by
    /// itself, because a file has them as well.
    pub explained: f64,
}

impl ServoModel {
    /// The hysteresis of the record, where friction and dead band of the model do not make as much, or where errors that are not noise show that
    /// they are not all.
    #[must_use]
    pub fn unexplained_hysteresis(&self) -> Option<UnexplainedHysteresis> {
        let (shown, at_least) = self.apart_at_rest()?;
        let each_side = [QuantityKind::RestingError, QuantityKind::DeadBand]
            .into_iter()
            .filter_map(|kind| self.quantity(kind))
            .map(|found| found.value)
            .sum::<f64>();
        let explained = 2.0 * each_side * self.parameters(0).gain.abs();
        let lacks_something = self.covariance.withdrawn() == Some(Reason::ErrorsNotNoise);
        (explained < at_least || lacks_something).then_some(UnexplainedHysteresis {
            shown,
            explained: shown.map_or(explained, |shown| explained.min(shown)),
        })
    }

    /// How far rests under one command are apart in the record, where strokes are made again, and at least. The mean between both directions of approach is a least
    /// distance alone: levels that are overshot count against it.
    fn apart_at_rest(&self) -> Option<(Option<f64>, f64)> {
        let sure = |apart: Interval| Some((apart.value, apart.lower.filter(|lower| *lower > 0.0)?));
        let by_direction = || self.hysteresis?.value.map(|mean| (None, mean));
        self.rests_apart.and_then(sure).or_else(by_direction)
    }
}
