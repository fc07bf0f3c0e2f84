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
    /// Samples of that quarter.
    pub(super) samples: usize,
    /// What was taken out of the rest, as motion that a model says to be left \[output\]. Each visit after one stroke has the same of it, so that no scatter shows by how much
    /// that is off.
    pub(super) taken_out: f64,
}

impl Visit {
    /// Whether a stroke upwards led there.
    pub(super) fn is_from_below(&self) -> bool {
        self.command > self.before
    }
}

/// Those of each run whose last quarter begins at least `settling` samples after the edge.
pub(super) fn visits(runs: &[Run], settling: usize) -> Vec<Vec<Visit>> {
    visits_at_rest(runs, runs, settling)
}

/// The same of `runs` without what motion is left in each quarter, which are `at_rest`.
pub(super) fn visits_at_rest(runs: &[Run], at_rest: &[Run], settling: usize) -> Vec<Vec<Visit>> {
    let of_run = |(run, at_rest): (&Run, &Run)| {
        let visit = |hold: &Hold| {
            let last = last_quarter(&hold.samples);
            let before = hold.before?;
            let settled = last.start >= hold.samples.start + settling;
            let middle = last.start + last.len() / 2;
            let [first, second] =
                [last.start..middle, middle..last.end].map(|half| mean_output(at_rest, half));
            let rest = mean_output(at_rest, last.clone()).filter(|_| settled)?;
            Some(Visit {
                command: hold.level,
                before,
                rest,
                moved: second? - first?,
                samples: last.len(),
                taken_out: mean_output(run, last)? - rest,
            })
        };
        holds(run, EXACTLY)
            .iter()
            .filter_map(visit)
            .collect::<Vec<_>>()
    };
    runs.iter().zip(at_rest).map(of_run).collect()
}

/// The variance of the mean rest of these visits, as a share of the mean variance of one among `all`.
///
/// What differs from visit to visit is noise, which is larger in the mean of few samples, or the servo, which is not: each counts where it makes the share larger.
pub(super) fn share_of_variance<'v>(
    visits: impl Iterator<Item = &'v Visit> + Clone,
    all: &[Visit],
) -> f64 {
    let mean_of_reciprocals = |of: &mut dyn Iterator<Item = &Visit>| {
        let (sum, count) = of.fold((0.0, 0.0), |(sum, count), visit| {
            (sum + (visit.samples as f64).recip(), count + 1.0)
        });
        (sum / count, count)
    };
    let (own, count) = mean_of_reciprocals(&mut visits.clone());
    let (usual, _) = mean_of_reciprocals(&mut all.iter());
    (own / usual).max(1.0) / count
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

#[cfg(test)]
mod tests {
    use super::*;

    fn visit(samples: usize) -> Visit {
        Visit {
            command: 1.0,
            before: 0.0,
            rest: 1.0,
            moved: 0.0,
            samples,
            taken_out: 0.0,
        }
    }

    #[test]
    fn short_visits_have_more_of_the_noise_and_long_ones_no_less_of_what_the_servo_does() {
        let all = [visit(10), visit(10), visit(40), visit(40)];
        // 1/10 and 1/40 are 1.6 and 0.4 times their mean.
        let short = share_of_variance(all[..2].iter(), &all);
        assert!((short - 0.8).abs() < 1e-12, "{short}");
        let long = share_of_variance(all[2..].iter(), &all);
        assert!((long - 0.5).abs() < 1e-12, "{long}");
    }
}
