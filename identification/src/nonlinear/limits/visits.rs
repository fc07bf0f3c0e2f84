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

/// Those of each run whose last quarter begins at least `settling` samples after the edge.
pub(super) fn visits(runs: &[Run], settling: usize) -> Vec<Vec<Visit>> {
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
    runs.iter().map(of_run).collect()
}

/// Takes the mean rest of each run to that of all, where there are several and all make the same strokes: then no distance between the mean rests of two strokes
/// changes. So many zeros are estimated then, beside the mean.
pub(super) fn with_one_zero(runs: &mut [Vec<Visit>]) -> Option<usize> {
    let strokes = |run: &Vec<Visit>| {
        let mut all: Vec<[f64; 2]> = run.iter().map(|of| [of.before, of.command]).collect();
        all.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        all
    };
    let (first, others) = runs.split_first()?;
    let of_first = strokes(first);
    let are_alike = others.iter().all(|run| strokes(run) == of_first);
    if others.is_empty() || first.is_empty() || !are_alike {
        return None;
    }
    let mean = |run: &Vec<Visit>| run.iter().map(|of| of.rest).sum::<f64>() / run.len() as f64;
    let of_all = runs.iter().map(mean).sum::<f64>() / runs.len() as f64;
    for run in runs.iter_mut() {
        let zero = mean(run) - of_all;
        run.iter_mut().for_each(|visit| visit.rest -= zero);
    }
    Some(runs.len() - 1)
}
