//! Servos that the record does not distinguish.
//!
//! The terms are chosen by prediction, and often a record predicts as well with others. What is said of the servo then has
//! to hold for all of them: intervals and bands are those of every servo together. One with all terms of the chosen servo, and
//! more that the record does not show, says nothing that this one does not say, but for what nobody knows.

use super::coordinates::{Coordinate, Point};
use super::quantities::UNDETERMINED_RATIO;
use faer::Mat;

/// A servo that the record may come from.
#[derive(Clone, Debug)]
pub(super) struct PossibleServo {
    pub(super) point: Point,
    /// Covariance of its coordinates.
    pub(super) covariance: Mat<f64>,
    /// Whether the record shows each coordinate.
    pub(super) seen: Vec<bool>,
}

impl PossibleServo {
    /// Whether it counts beside `chosen`: it lacks a coordinate of that, or all that it has more are different from their
    /// absence by more than `critical` standard deviations.
    pub(super) fn counts_beside(&self, chosen: &Self, critical: f64) -> bool {
        let has = |point: &Point, coordinate: &Coordinate| point.coordinates.contains(coordinate);
        let mut theirs = chosen.point.coordinates.iter();
        if theirs.any(|coordinate| !has(&self.point, coordinate)) {
            return true;
        }
        let more = self.point.coordinates.iter().enumerate();
        more.filter(|(_, coordinate)| !has(&chosen.point, coordinate))
            .all(|(index, coordinate)| self.shows(index, *coordinate, critical))
    }

    /// Whether a coordinate differs from its value in a servo without the term.
    fn shows(&self, index: usize, coordinate: Coordinate, critical: f64) -> bool {
        let half = critical * self.covariance[(index, index)].max(0.0).sqrt();
        let value = self.point.values[index];
        match coordinate {
            Coordinate::DeadBand
            | Coordinate::Friction
            | Coordinate::FrictionOfGears
            | Coordinate::LnDownToUp
            | Coordinate::ConstantLoad
            | Coordinate::Gravity
            | Coordinate::AirStiffening => self.seen[index] && value.abs() > half,
            Coordinate::LnTopSpeed => self.seen[index] && 2.0 * half < UNDETERMINED_RATIO.ln(),
            _ => true,
        }
    }
}
