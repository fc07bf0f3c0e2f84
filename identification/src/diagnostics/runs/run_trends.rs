//! A trend of each run.
//!
//! Where the output drifts as the input does not explain, each run has a straight line of its own in the regression, about
//! the middle of the run. Estimates of the slopes are taken out of the output, fit and slopes in turns, and the covariance of the
//! response is that of the regression with a column for each run, as for [offsets](crate::diagnostics::runs::run_offsets).

use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use crate::data::{Moments, Record, References, Run};
use crate::diagnostics::residuals::part_means::part_means;
use crate::diagnostics::residuals::run_columns::RunColumns;
use crate::diagnostics::residuals::simulation_error::Simulated;
use crate::estimation::GlsFit;
use crate::thresholds::{DRIFT_SIGNIFICANCE, SHORTEST_SETTLING};

/// The slope of each run \[output per sample\]; empty where there is none.
pub(crate) type RunTrends = Vec<f64>;

/// Parts of the longest run whose means are compared. Noise that lasts longer than one of them is drift to any test.
const PARTS: usize = 16;

/// Whether `runs` drift beyond chance.
///
/// A servo that is not linear leaves the same errors in each run of a reference, and among them a slope. So the slope that the runs of a reference share is held against what they
/// share beside it, those by which they differ against what they differ by beside them.
pub(crate) fn drift(runs: &[Simulated<'_>]) -> bool {
    let longest = runs.iter().map(|run| run.errors.len()).max().unwrap_or(0);
    let length = (longest / PARTS).max(2 * SHORTEST_SETTLING);
    let references = References::of(runs.iter().map(|run| &run.run));
    let parts: Vec<Parts> = (runs.iter())
        .map(|run| about_mean(part_means(run.own_errors(), length)))
        .collect();
    let shared = |reference: usize| {
        let of_it = parts.iter().zip(&references.of_runs);
        let of_it = of_it.filter(|(_, of)| **of == reference);
        mean_of(of_it.map(|(parts, _)| parts))
    };
    let shared: Vec<Parts> = (0..references.count()).map(shared).collect();
    let own = parts.iter().zip(&references.of_runs);
    let own: Vec<Parts> = own
        .map(|(parts, of)| without(parts, &shared[*of]))
        .collect();
    let of_shared: Slopes = shared.iter().map(|parts| Slopes::of(parts)).sum();
    // What several runs share took a mean and a slope of them at each place already.
    let among = own.iter().map(|parts| Slopes::of(parts)).sum::<Slopes>();
    let among = Slopes {
        runs: among.runs - of_shared.runs,
        parts: among.parts - of_shared.parts,
        ..among
    };
    let tests = if among.runs > 0.0 { 2.0 } else { 1.0 };
    [of_shared, among]
        .iter()
        .filter_map(Slopes::probability)
        .any(|p| p * tests < DRIFT_SIGNIFICANCE)
}

/// Middles and means of the parts of a run.
type Parts = Vec<(f64, f64)>;

fn about_mean(mut parts: Parts) -> Parts {
    let mean = parts.iter().map(|part| part.1).sum::<f64>() / parts.len().max(1) as f64;
    for part in &mut parts {
        part.1 -= mean;
    }
    parts
}

/// The mean at each place of the parts of several runs.
fn mean_of<'a>(runs: impl Iterator<Item = &'a Parts>) -> Parts {
    let mut all: Parts = runs.flatten().copied().collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let same = all.chunk_by(|a, b| a.0 == b.0);
    let mean = |same: &[(f64, f64)]| {
        let sum: f64 = same.iter().map(|part| part.1).sum();
        (same[0].0, sum / same.len() as f64)
    };
    same.map(mean).collect()
}

/// `parts` less those of `shared`, which has all places.
fn without(parts: &Parts, shared: &Parts) -> Parts {
    let at = |place: f64| shared.iter().find(|part| part.0 == place);
    let left = |(place, value): &(f64, f64)| {
        let shared = at(*place).map_or(0.0, |part| part.1);
        (*place, value - shared)
    };
    parts.iter().map(left).collect()
}

/// Squares of the slopes of runs, and of what is left beside them.
struct Slopes {
    explained: f64,
    left: f64,
    parts: f64,
    runs: f64,
}

impl Slopes {
    fn of(parts: &[(f64, f64)]) -> Self {
        let mean = |of: fn(&(f64, f64)) -> f64| {
            parts.iter().map(of).sum::<f64>() / parts.len().max(1) as f64
        };
        let (at, level) = (mean(|p| p.0), mean(|p| p.1));
        let spread: f64 = parts.iter().map(|p| (p.0 - at).powi(2)).sum();
        let product: f64 = parts.iter().map(|p| (p.0 - at) * (p.1 - level)).sum();
        let slope = if spread > 0.0 { product / spread } else { 0.0 };
        let off = |p: &(f64, f64)| (p.1 - level - slope * (p.0 - at)).powi(2);
        Self {
            explained: slope * product,
            left: parts.iter().map(off).sum(),
            parts: parts.len() as f64,
            runs: 1.0,
        }
    }

    /// That of slopes as large without any drift. `None` where nothing is known of chance: without errors there is no ratio of their sums.
    fn probability(&self) -> Option<f64> {
        let degrees = (self.runs, self.parts - 2.0 * self.runs);
        let is_known = self.left > 0.0 && degrees.0 > 0.0 && degrees.1 >= 3.0;
        let f = is_known.then(|| FisherSnedecor::new(degrees.0, degrees.1).ok());
        f.flatten()
            .map(|f| f.sf(self.explained / degrees.0 / (self.left / degrees.1)))
    }
}

impl std::iter::Sum for Slopes {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        let none = Self {
            explained: 0.0,
            left: 0.0,
            parts: 0.0,
            runs: 0.0,
        };
        all.fold(none, |a, b| Self {
            explained: a.explained + b.explained,
            left: a.left + b.left,
            parts: a.parts + b.parts,
            runs: a.runs + b.runs,
        })
    }
}

/// The trend of slope 1 of a run at sample `k`.
pub(crate) fn trend_at(run: &Run, k: usize) -> f64 {
    k as f64 - (run.len() as f64 - 1.0) / 2.0
}

/// `record` without `offsets` and trends of these `slopes` of its runs, as far as there are any.
pub(crate) fn without_offsets_and_trends<'a>(
    record: &Record<'a>,
    offsets: &[f64],
    slopes: &[f64],
) -> Record<'a> {
    if offsets.is_empty() && slopes.is_empty() {
        return record.clone();
    }
    let of = |all: &[f64], run: usize| all.get(run).copied().unwrap_or(0.0);
    let runs = record.runs().iter().enumerate().map(|(number, run)| {
        let (offset, slope) = (of(offsets, number), of(slopes, number));
        let output = (0..).zip(run.output());
        let output = output.map(|(k, y)| y - offset - slope * trend_at(run, k));
        run.with_output(output.collect())
    });
    record.with_runs(runs.collect())
}

/// The columns of the trends of `runs` beside the regression of `fit`.
fn columns<'a>(
    runs: impl Iterator<Item = &'a Run<'a>>,
    moments: &Moments,
    fit: &GlsFit,
) -> Option<RunColumns> {
    let trend = |run: &'a Run<'a>| (run, (0..run.len()).map(|k| trend_at(run, k)).collect());
    RunColumns::new(runs.map(trend), moments, fit)
}

/// The slopes that the errors of `fit` leave for a regression with a trend of each of `runs`.
pub(crate) fn slopes_left(runs: &[Simulated<'_>], moments: &Moments, fit: &GlsFit) -> RunTrends {
    let columns = columns(runs.iter().map(|run| &run.run), moments, fit);
    match columns {
        Some(columns) => columns.coefficients(&columns.scores(runs.iter(), fit)),
        None => vec![0.0; runs.len()],
    }
}

/// The covariance of `fit` becomes that with a trend of each of `runs`.
pub(crate) fn allow_for_run_trends(runs: &[Run], moments: &Moments, fit: &mut GlsFit) {
    if let Some(columns) = columns(runs.iter(), moments, fit) {
        fit.spread_further(1.0, Some(columns.covariance()));
    }
}
