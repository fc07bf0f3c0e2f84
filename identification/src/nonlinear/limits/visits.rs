//! Visits of levels: holds that are long enough for the servo to come to rest, and where it does.

use crate::data::{EXACTLY, Hold, Run, holds, last_quarter, mean_output};

/// One of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Visit {
    /// The level.
    pub(super) command: f64,
    /// The level before.
    pub(super) before: f64,
    /// Mean output of the last quarter.
    pub(super) rest: f64,
    /// Mean output of the second half of that less that of the first: what is left of the motion, and noise.
    pub(super) moved: f64,
}

impl Visit {
    /// Whether a stroke upwards led there.
    pub(super) fn is_from_below(&self) -> bool {
        self.command > self.before
    }
}

/// Those whose last quarter begins at least `settling` samples after the edge.
pub(super) fn visits(runs: &[Run], settling: usize) -> Vec<Visit> {
    let of_run = |run: &Run| {
        let visit = |hold: &Hold| {
            let last = last_quarter(&hold.samples);
            let before = hold.before?;
            let settled = last.start >= hold.samples.start + settling;
            let middle = last.start + last.len() / 2;
            let [first, second] =
                [last.start..middle, middle..last.end].map(|half| mean_output(run, half));
            Some(Visit {
                command: hold.level,
                before,
                rest: mean_output(run, last).filter(|_| settled)?,
                moved: second? - first?,
            })
        };
        holds(run, EXACTLY)
            .iter()
            .filter_map(visit)
            .collect::<Vec<_>>()
    };
    runs.iter().flat_map(of_run).collect()
}
