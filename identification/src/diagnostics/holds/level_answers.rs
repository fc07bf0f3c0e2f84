//! The servo's answers to levels that are held, and their cross moments with the rows of the regression.
//!
//! The answer to a visit c of a level is x_c = G(z) (1 from the beginning of the hold to its end, 0 elsewhere).

use std::ops::Range;

use faer::Mat;

use super::clustered_errors::Cluster;
use super::held_run::HeldRun;
use crate::data::{HELD, Hold, Moments};
use crate::diagnostics::residuals::filtered_rows::{filtered, only, with_history};
use crate::diagnostics::residuals::further_columns::FurtherColumns;
use crate::estimation::{GlsFit, noise_filter};

/// A level that is held.
pub(super) struct Visit {
    pub(super) run: usize,
    pub(super) hold: Hold,
    /// The errors along its answer, from the beginning of the hold to its end.
    pub(super) errors: Cluster,
}

/// All visits of all levels, level by level.
pub(super) fn visits(runs: &[HeldRun<'_>], fit: &GlsFit) -> Vec<Visit> {
    let d = noise_filter(&fit.ar);
    let step = step_response(fit);
    let mut visits: Vec<Visit> = Vec::new();
    for (index, run) in runs.iter().enumerate() {
        let held = run.holds.iter();
        for hold in held.filter(|hold| hold.samples.len() >= HELD) {
            let length = hold.samples.len();
            let answer: Vec<f64> = (0..length).map(|k| at(&step, k)).collect();
            let errors = &run.errors[hold.samples.clone()];
            visits.push(Visit {
                run: index,
                hold: hold.clone(),
                errors: Cluster::of_rows(&filtered(&answer, &d), errors),
            });
        }
    }
    visits.sort_by(|a, b| a.hold.level.total_cmp(&b.hold.level));
    visits
}

/// The step response of the fit.
fn step_response(fit: &GlsFit) -> Vec<f64> {
    fit.coordinates.basis.step_response(&fit.theta())
}

/// It stays where it is after N samples.
fn at(step: &[f64], k: usize) -> f64 {
    step[k.min(step.len() - 1)]
}

/// Cross moments of the rows of the regression with the answers to levels.
pub(super) struct CrossMoments<'a> {
    runs: &'a [HeldRun<'a>],
    moments: &'a Moments,
    fit: &'a GlsFit,
    d: Vec<f64>,
    step: Vec<f64>,
}

impl<'a> CrossMoments<'a> {
    pub(super) fn new(runs: &'a [HeldRun<'a>], moments: &'a Moments, fit: &'a GlsFit) -> Self {
        Self {
            runs,
            moments,
            fit,
            d: noise_filter(&fit.ar),
            step: step_response(fit),
        }
    }

    /// One column for each visit; the offset last.
    pub(super) fn of(&self, visits: &[Visit]) -> Mat<f64> {
        let mut columns = FurtherColumns::new(self.fit, visits.len());
        let history = self.fit.coordinates.basis.settling() - 1 + self.fit.ar.len();
        for (index, HeldRun { run, .. }) in self.runs.iter().enumerate() {
            let input = with_history(&run.run, history, self.moments.centre.0);
            let input = filtered(&input, &self.d);
            let rows =
                (run.run).complete_rows(self.moments.input_lags(), self.moments.output_lags());
            let of_run = visits.iter().enumerate();
            for (place, visit) in of_run.filter(|(_, visit)| visit.run == index) {
                let answer = self.answer(visit, &rows, run.errors.len());
                let end = history + visit.hold.samples.start + answer.len();
                columns.add(&input[..end], &[place], &[&answer]);
            }
        }
        columns.cross_moments()
    }

    /// D(z) x from the beginning of the hold until the servo has left it, in the `rows` of the regression, of a run of so many `samples`.
    pub(super) fn answer(&self, visit: &Visit, rows: &[Range<usize>], samples: usize) -> Vec<f64> {
        let (start, held) = (visit.hold.samples.start, visit.hold.samples.len());
        let length = (held + self.step.len() + self.d.len()).min(samples - start);
        let left = |k: usize| {
            k.checked_sub(held)
                .map_or(0.0, |since| at(&self.step, since))
        };
        let answer: Vec<f64> = (0..length).map(|k| at(&self.step, k) - left(k)).collect();
        let within = |k: usize| k.clamp(start, start + length) - start;
        let rows = rows.iter().map(|rows| within(rows.start)..within(rows.end));
        let rows: Vec<_> = rows.filter(|rows| !rows.is_empty()).collect();
        only(&rows, filtered(&answer, &self.d))
    }
}

/// Columns of visits, added up for each level.
pub(super) fn level_by_level(of_visits: &Mat<f64>, levels: &[&[Visit]]) -> Mat<f64> {
    let mut sums = Mat::zeros(of_visits.nrows(), levels.len());
    let mut columns = of_visits.col_iter();
    for (mut sum, visits) in sums.col_iter_mut().zip(levels) {
        for visit in columns.by_ref().take(visits.len()) {
            sum += visit;
        }
    }
    sums
}

/// The visits as members of the cluster of their level.
pub(super) fn cluster_of(visits: &[Visit]) -> Cluster {
    let mut cluster = Cluster::default();
    for visit in visits {
        cluster.add(visit.errors.product, visit.errors.weight);
    }
    cluster
}
