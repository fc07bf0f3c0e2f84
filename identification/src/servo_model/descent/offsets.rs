//! Offsets of the runs in a step of the descent: at the minimum over them for whatever the coordinates are.
//!
//! They are what the zero of the sensor is above the common offset, and their mean is zero. So a step changes them by
//!
//! ```text
//! change = (gradient - cross · changes of the coordinates)/square
//! ```
//!
//! with gradients and crosses [about a mean](about_mean) that keeps the mean of the changes at zero.

use super::coordinates::{Coordinate, Point};

/// Sums over the samples of one run.
#[derive(Clone)]
pub(crate) struct OfRun {
    /// Of the weighted squares of the derivative by its offset.
    pub(crate) square: f64,
    /// Of its products with the errors.
    pub(super) gradient: f64,
    /// Of its products with the derivatives by the coordinates.
    pub(crate) cross: Vec<f64>,
}

impl OfRun {
    /// None, for `count` coordinates.
    pub(crate) fn zero(count: usize) -> Self {
        Self {
            square: 0.0,
            gradient: 0.0,
            cross: vec![0.0; count],
        }
    }

    /// What the squares of the errors lose by the best offset.
    pub(super) fn gain(&self) -> f64 {
        match self.square > 0.0 {
            true => self.gradient * self.gradient / self.square,
            false => 0.0,
        }
    }

    /// The change of the offset where the coordinates have changed by `changes`; `None` for a run that does not count.
    fn change(&self, changes: &[f64]) -> Option<f64> {
        let by_others: f64 = (self.cross.iter().zip(changes))
            .map(|(cross, change)| cross * change)
            .sum();
        (self.square > 0.0).then(|| (self.gradient - by_others) / self.square)
    }
}

/// Takes from gradients and crosses what would move the mean of the offsets of the runs that count.
pub(crate) fn about_mean(runs: &mut [OfRun]) {
    let counting = || runs.iter().filter(|run| run.square > 0.0);
    let all: f64 = counting().map(|run| run.square.recip()).sum();
    let mean = |of: &dyn Fn(&OfRun) -> f64| {
        let shares = counting().map(|run| of(run) / run.square);
        shares.sum::<f64>() / all
    };
    let count = runs.first().map_or(0, |run| run.cross.len());
    let gradient = mean(&|run| run.gradient);
    let cross: Vec<f64> = (0..count).map(|i| mean(&|run| run.cross[i])).collect();
    for run in runs.iter_mut().filter(|run| run.square > 0.0) {
        run.gradient -= gradient;
        for (own, mean) in run.cross.iter_mut().zip(&cross) {
            *own -= mean;
        }
    }
}

/// Moves the offsets of `point`, whose coordinates have changed by `changes`. The zero of a run that does not count stays where it is.
pub(super) fn move_offsets(point: &mut Point, runs: &[OfRun], changes: &[f64]) {
    let of_coordinates = point.coordinates.iter().zip(changes);
    let common: f64 = of_coordinates
        .filter(|(at, _)| **at == Coordinate::Offset)
        .map(|(_, change)| change)
        .sum();
    for (offset, run) in point.run_offsets.iter_mut().zip(runs) {
        *offset += run.change(changes).unwrap_or(-common);
    }
}
