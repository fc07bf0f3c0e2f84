//! Offsets of the runs in a step of the descent: at the minimum over them for whatever the coordinates are.

use super::coordinates::{Coordinate, Point};

/// Sums over the samples of one run.
#[derive(Clone)]
pub(super) struct OfRun {
    /// Of the weighted squares of the derivative by its offset.
    pub(super) square: f64,
    /// Of its products with the errors.
    pub(super) gradient: f64,
    /// Of its products with the derivatives by the coordinates.
    pub(super) cross: Vec<f64>,
}

impl OfRun {
    /// None, for `count` coordinates.
    pub(super) fn zero(count: usize) -> Self {
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

/// Moves the offsets of `point`, whose coordinates have changed by `changes`. What they have in common goes to the common offset.
pub(super) fn move_offsets(point: &mut Point, runs: &[OfRun], changes: &[f64]) {
    let moves: Vec<Option<f64>> = runs.iter().map(|run| run.change(changes)).collect();
    for (offset, change) in point.run_offsets.iter_mut().zip(&moves) {
        *offset += change.unwrap_or(0.0);
    }
    let moved = || point.run_offsets.iter().zip(&moves);
    let counting = || moved().filter(|(_, change)| change.is_some());
    let mean = counting().map(|(offset, _)| offset).sum::<f64>() / counting().count() as f64;
    if mean.is_nan() {
        return;
    }
    let common = point.get(Coordinate::Offset).unwrap_or(0.0);
    point.set(Coordinate::Offset, common + mean);
    for offset in &mut point.run_offsets {
        *offset -= mean;
    }
}
