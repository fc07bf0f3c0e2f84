//! Servos that the record does not distinguish.
//!
//! The terms are chosen by prediction, and often a record predicts as well with others. What is said of the servo then has
//! to hold for all of them: intervals and bands are those of every servo together. Without those whose further terms are not
//! shown by the record, intervals of 99 % held 92 to 98 % of the truths instead of 97 to 100 %.

use crate::servo_model::descent::coordinates::Point;
use faer::Mat;

/// A servo that the record may come from.
#[derive(Clone, Debug)]
pub(crate) struct PossibleServo {
    pub(crate) point: Point,
    /// Covariance of its coordinates.
    pub(crate) covariance: Mat<f64>,
    /// Changes of all coordinates that change no output of the record.
    pub(crate) unseen: Vec<Vec<f64>>,
}
