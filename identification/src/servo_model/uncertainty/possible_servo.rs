//! Servos that the record does not distinguish.
//!
//! The terms are chosen by prediction, and often a record predicts as well with others. What is said of the servo then has
//! to hold for all of them: intervals and bands are those of every servo together. Without those whose further terms are not
//! shown by the record, intervals of 99 % held 92 to 98 % of the truths instead of 97 to 100 %.

use crate::servo_model::descent::coordinates::{Coordinate, Point};
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

/// The standard deviation of a spring's share in the stiffness from which on nothing is known of it: a share is less than one.
const UNKNOWN_SHARE: f64 = 1.0;

impl PossibleServo {
    /// Whether the record knows the spring and the stiffening of a load of the air, where there is one. Behind a drive that is never full a spring is no other servo: stiffness and gain are those of
    /// small motion with it and without. A load of the air that stiffens where no output shows it is a constant one.
    pub(crate) fn shows_its_load(&self) -> bool {
        let place = |wanted| self.point.coordinates.iter().position(|at| *at == wanted);
        let is_seen = |at: usize| {
            let moves = |change: &Vec<f64>| change[at].abs() > f64::EPSILON.sqrt();
            !self.unseen.iter().any(moves)
        };
        let is_known =
            |share: usize| self.covariance[(share, share)] < UNKNOWN_SHARE * UNKNOWN_SHARE;
        place(Coordinate::Spring).is_none_or(|share| is_known(share) && is_seen(share))
            && place(Coordinate::AirStiffening).is_none_or(is_seen)
    }
}
