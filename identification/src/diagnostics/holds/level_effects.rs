//! Levels that the servo takes a little too high or too low, alike at each visit, beside the response.
//!
//! Where few levels follow each other in one order, what level l is off by, δ_l, looks like a late answer to the levels before it. So δ is
//! estimated together with the response, as effects of a mixed model (C. R. Henderson, Biometrics 31, 1975):
//!
//! ```text
//! y = G u + Σ_l δ_l x_l + c + noise,     x_l = G(z) (1 while the command is at level l, 0 elsewhere),     δ_l of variance s².
//! ```
//!
//! With X the D(z) x_l, C their cross moments with the rows of the regression, A the normal matrix of these, and σ² the variance of ε, one step from the present δ is
//!
//! ```text
//! Δδ = (S + λ I)^-1 (X'ε - λ δ),     S = X'X - C'A^-1 C,     λ = σ²/s²,
//! ```
//!
//! and σ² A^-1 C (S + λ I)^-1 C'A^-1 is what not knowing δ adds to the covariance. Two combinations of δ, which are an offset and a gain, are known by s² alone. They are
//! the response's: δ is what a line through the levels leaves. Else fit and δ may take a gain from each other in turns, and more at each turn.

use std::cmp::Ordering;
use std::ops::Range;

use faer::Mat;

use super::clustered_errors::{Cluster, EffectScatter, larger_of_cause};
use super::held_run::HeldRun;
use super::level_answers::{CrossMoments, Visit, cluster_of, level_by_level, visits};
use super::level_scatter::{FITTED, variance_of_rounding};
use crate::data::{Moments, Record, Run};
use crate::diagnostics::residuals::filtered_rows::present;
use crate::diagnostics::residuals::simulation_error::Simulated;
use crate::estimation::{EstimatedPart, GlsFit};
use crate::numerics::{SymmetricEigen, dot, symmetric_eigen, times};

/// How far levels are off.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct LevelEffects {
    /// Each level and its δ \[input\], in ascending order of the levels.
    effects: Vec<(f64, f64)>,
    /// s² \[input²\].
    variance: f64,
}

impl LevelEffects {
    /// Whether there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.effects.is_empty()
    }

    /// Number of levels.
    pub(crate) fn len(&self) -> usize {
        self.effects.len()
    }

    /// s \[input\].
    pub(crate) fn sd(&self) -> f64 {
        self.variance.sqrt()
    }

    /// `record` with the commands that the servo seems to have had.
    pub(crate) fn put_right<'a>(&self, record: &Record<'a>) -> Record<'a> {
        if self.is_empty() {
            return record.clone();
        }
        let runs = record.runs().iter();
        let put_right = |run: &Run<'a>| run.with_each_input(|u| u + self.at(u));
        record.with_runs(runs.map(put_right).collect())
    }

    /// δ of a level; 0 of any other input.
    fn at(&self, level: f64) -> f64 {
        // A missing input is at none of them.
        let place = (self.effects)
            .binary_search_by(|(known, _)| known.partial_cmp(&level).unwrap_or(Ordering::Less));
        place.map_or(0.0, |place| self.effects[place].1)
    }

    /// The place of the effect that a level has been put right by.
    fn of(&self, put_right: f64) -> Option<usize> {
        let mut levels = self.effects.iter().map(|(level, delta)| level + delta);
        levels.position(|level| level == put_right)
    }

    /// Those that `runs` show, which are of a record as it is; `None` where no level is off beyond chance.
    pub(crate) fn begun(runs: &[Simulated<'_>], moments: &Moments, fit: &GlsFit) -> Option<Self> {
        let held = HeldRun::all(runs, fit);
        let visits = visits(&held, fit);
        let levels: Vec<&[Visit]> = by_level(&visits).collect();
        let of_levels: Vec<Cluster> = levels.iter().map(|visits| cluster_of(visits)).collect();
        let begun = Self {
            variance: EffectScatter::of(&of_levels, FITTED)?.variance,
            effects: levels
                .iter()
                .map(|visits| (visits[0].hold.level, 0.0))
                .collect(),
        };
        // Effects of levels that are visited once are the visits'.
        let repeat = visits.len() >= 2 * begun.len();
        match repeat && begun.len() as f64 > FITTED {
            true => begun.after_a_step(&held, moments, fit),
            false => None,
        }
    }

    /// After a step, and with s² from what it gives (the EM algorithm); `runs` and `fit` are of the record with the present ones put right.
    pub(crate) fn improved(
        &self,
        runs: &[Simulated<'_>],
        moments: &Moments,
        fit: &GlsFit,
    ) -> Option<Self> {
        self.after_a_step(&HeldRun::all(runs, fit), moments, fit)
    }

    /// [`Self::improved`], of runs whose holds are known.
    fn after_a_step(&self, runs: &[HeldRun<'_>], moments: &Moments, fit: &GlsFit) -> Option<Self> {
        let known = Regression::new(self, runs, moments, fit)?;
        let lambda = fit.variance / self.variance;
        let covariance = known.covariance(lambda);
        let deltas = self.effects.iter().map(|(_, delta)| delta);
        let score = known.score.iter().zip(deltas);
        let score: Vec<f64> = score.map(|(score, delta)| score - lambda * delta).collect();
        let step = times(&covariance, &score);
        let moved = self.effects.iter().zip(step);
        let moved = moved.map(|((level, delta), by)| (*level, delta + by));
        let effects = without_line(&moved.collect::<Vec<_>>());
        let squares: f64 = effects.iter().map(|(_, delta)| delta * delta).sum();
        let spread: f64 = (0..self.len()).map(|l| covariance[(l, l)]).sum();
        Some(Self {
            variance: (squares + fit.variance * spread) / self.len() as f64,
            effects,
        })
    }

    /// Adds to the covariance of `fit`, which is of the record with these put right, that they are not known.
    pub(crate) fn allow_for(&self, runs: &[Simulated<'_>], moments: &Moments, fit: &mut GlsFit) {
        let runs = HeldRun::all(runs, fit);
        let Some(known) = Regression::new(self, &runs, moments, fit) else {
            return;
        };
        let levels: Vec<f64> = self.effects.iter().map(|(level, _)| *level).collect();
        let left = self.len() as f64 - FITTED;
        let variance = larger_of_cause(self.variance, left, variance_of_rounding(&runs, &levels));
        let moved = &fit.solution.inverse * &known.cross;
        let covariance = known.covariance(fit.variance / variance);
        fit.spread_by(EstimatedPart {
            covariance: &moved * covariance * moved.transpose(),
            relative_variance: 2.0 / left,
        });
    }
}

/// What a line through `points` leaves of each of them.
fn without_line(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mean =
        |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(|point| point.0), mean(|point| point.1));
    let product: f64 = points
        .iter()
        .map(|point| (point.0 - x) * (point.1 - y))
        .sum();
    let square: f64 = points.iter().map(|point| (point.0 - x).powi(2)).sum();
    let left = |point: &(f64, f64)| (point.0, point.1 - y - product / square * (point.0 - x));
    points.iter().map(left).collect()
}

/// The visits to each level.
fn by_level(visits: &[Visit]) -> impl Iterator<Item = &[Visit]> {
    visits.chunk_by(|a, b| a.hold.level == b.hold.level)
}

/// The answers to levels beside the rows of the regression.
struct Regression {
    /// C.
    cross: Mat<f64>,
    /// Of S.
    left: SymmetricEigen,
    /// X'ε.
    score: Vec<f64>,
}

impl Regression {
    /// Of the levels of `effects`, put right or not.
    fn new(
        effects: &LevelEffects,
        runs: &[HeldRun<'_>],
        moments: &Moments,
        fit: &GlsFit,
    ) -> Option<Self> {
        let mut visits = visits(runs, fit);
        // What was put right need not be in the order of the levels.
        visits.sort_by_key(|visit| effects.of(visit.hold.level));
        let levels: Vec<&[Visit]> = by_level(&visits).collect();
        debug_assert_eq!(levels.len(), effects.len());
        let cross_moments = CrossMoments::new(runs, moments, fit);
        let cross = level_by_level(&cross_moments.of(&visits), &levels);
        let mut own = Mat::<f64>::zeros(levels.len(), levels.len());
        let mut score = vec![0.0; levels.len()];
        for (index, held) in runs.iter().enumerate() {
            let run = held.run;
            let rows = run
                .run
                .complete_rows(moments.input_lags(), moments.output_lags());
            let columns: Vec<Vec<f64>> = (levels.iter())
                .map(|visits| answer_of_level(&cross_moments, visits, &rows, (index, run)))
                .collect();
            let errors: Vec<f64> = held.errors.iter().copied().map(present).collect();
            for (i, column) in columns.iter().enumerate() {
                score[i] += dot(column, &errors);
                for (j, other) in columns.iter().enumerate() {
                    own[(i, j)] += dot(column, other);
                }
            }
        }
        let samples = runs.iter().map(|run| run.errors.len() as f64).sum::<f64>();
        let seen = samples / fit.rows as f64;
        let whole = seen.min(1.0).recip();
        let cross = faer::Scale(whole) * cross;
        let explained = cross.transpose() * &fit.solution.inverse * &cross;
        Some(Self {
            left: symmetric_eigen(&(faer::Scale(whole) * own - explained))?,
            score: score.iter().map(|score| whole * score).collect(),
            cross,
        })
    }

    /// (S + λ I)^-1.
    fn covariance(&self, lambda: f64) -> Mat<f64> {
        let SymmetricEigen { values, vectors } = &self.left;
        // S has no negative value but by rounding.
        let known = |l: usize| (values[l].max(0.0) + lambda).recip();
        let scaled = Mat::from_fn(vectors.nrows(), vectors.ncols(), |i, l| {
            vectors[(i, l)] * known(l)
        });
        scaled * vectors.transpose()
    }
}

/// D(z) x of all visits of a run to a level, in the `rows` of the regression.
fn answer_of_level(
    cross_moments: &CrossMoments<'_>,
    visits: &[Visit],
    rows: &[Range<usize>],
    (index, run): (usize, &Simulated<'_>),
) -> Vec<f64> {
    let samples = run.errors.len();
    let mut column = vec![0.0; samples];
    for visit in visits.iter().filter(|visit| visit.run == index) {
        let answer = cross_moments.answer(visit, rows, samples);
        for (sum, value) in column[visit.hold.samples.start..].iter_mut().zip(answer) {
            *sum += value;
        }
    }
    column
}
