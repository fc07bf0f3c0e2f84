//! Whether two groups of runs differ by more than runs of one servo differ among themselves.
//!
//! With three or four runs a side: Welch's t tests on ten figures of each run (times of 10, 50 and
//! 90 % and the peak, up and down; both levels at rest), the smallest p times ten (Bonferroni). With
//! five or more: the largest difference of the mean curves, each point over its own scatter, against
//! its distribution over all ways to split the runs into two groups.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::pair::{Identified, ends};
use crate::data::Record;
use crate::error::Error;
use crate::estimation::FsfBasis;
use crate::nonlinear::{DirectionModel, split_with};
use crate::options::NoiseOrder;
use crate::thresholds::RUNS_DIFFER_SIGNIFICANCE;

/// Runs a side needed for t tests, and for permutations: with four, the smallest possible p is
/// 2/70.
const RUNS: (usize, usize) = (3, 5);

/// Most splits that are all tried; beyond, as many are drawn at random, seed below.
const SPLITS: usize = 20_000;
const SEED: u64 = 20_250_918;

/// Whether runs of one servo differ as much among themselves.
pub(super) fn explained_by_chance(p_value: Option<f64>) -> bool {
    p_value.is_some_and(|p| p > RUNS_DIFFER_SIGNIFICANCE)
}

/// A difference against the scatter of runs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RunToRun {
    /// Probability of a difference at least as large if both sides are one servo.
    pub(crate) p: f64,
    /// Largest difference of the mean responses that the scatter of the runs leaves open at a moment, of the
    /// step of the first side: |difference| and Welch's half width, at the level asked for.
    pub(crate) at_most: f64,
}

/// Compares two sides run by run; `None` with fewer than three runs on a side.
pub(super) fn run_to_run(
    a: &Identified<'_>,
    b: &Identified<'_>,
    level: f64,
) -> Result<Option<RunToRun>, Error> {
    let fewest = a.record.runs().len().min(b.record.runs().len());
    if fewest < RUNS.0 {
        return Ok(None);
    }
    let ends = ends(a.record);
    let basis = a.model.basis()?;
    let (a, b) = (models(a, basis)?, models(b, basis)?);
    let at_most = largest_left_open(&a, &b, level);
    let found = |p| Ok(Some(RunToRun { p, at_most }));
    if fewest >= RUNS.1 {
        return found(permutation(&a, &b));
    }
    let figures = |models: &[DirectionModel]| -> Vec<Vec<f64>> {
        models.iter().map(|model| figures(model, ends)).collect()
    };
    let (a, b) = (figures(&a), figures(&b));
    let smallest = (0..10)
        .filter_map(|k| {
            let column = |rows: &[Vec<f64>]| rows.iter().map(|row| row[k]).collect::<Vec<f64>>();
            Some(Welch::new(&column(&a), &column(&b))?.p())
        })
        .fold(1.0, f64::min);
    found((10.0 * smallest).min(1.0))
}

/// max_m (|difference of the means| + Welch's half width) over the points of both strokes, of the mean final
/// value of the first side.
fn largest_left_open(a: &[DirectionModel], b: &[DirectionModel], level: f64) -> f64 {
    let strokes: [fn(&DirectionModel) -> &[f64]; 2] = [|m| &m.up.value, |m| &m.down.value];
    let mut largest = 0.0f64;
    for stroke in strokes {
        let points = stroke(&a[0]).len();
        let at = |side: &[DirectionModel], m: usize| -> Vec<f64> {
            side.iter().map(|model| stroke(model)[m]).collect()
        };
        let last = at(a, points - 1);
        let step = (last.iter().sum::<f64>() / last.len() as f64).abs();
        for m in 0..points {
            let Some(welch) = Welch::new(&at(a, m), &at(b, m)) else {
                continue;
            };
            largest = largest.max((welch.difference.abs() + welch.half_width(level)) / step);
        }
    }
    largest
}

/// A model of each run of a side alone, whose bounds hold if those of the side do.
fn models(side: &Identified<'_>, basis: FsfBasis) -> Result<Vec<DirectionModel>, Error> {
    let record = side.record;
    let alone = |run: &crate::data::Run| {
        let record = Record::new(record.sample_period_s(), vec![run.clone()])?
            .with_sample_phase(record.sample_phase_s());
        split_with(&record, basis, NoiseOrder::Auto, side.model.level())
    };
    record.runs().iter().map(alone).collect()
}

/// Times of 10, 50 and 90 % and the peak, up and down, and both levels at rest.
fn figures(model: &DirectionModel, (low, high): (f64, f64)) -> Vec<f64> {
    let of = |curve: &[f64]| {
        let gain = curve[curve.len() - 1];
        let at = |level: f64| {
            let reached = curve.iter().position(|g| g / gain >= level);
            let Some(m) = reached.filter(|m| *m > 0) else {
                return f64::NAN;
            };
            let (before, after) = (curve[m - 1] / gain, curve[m] / gain);
            (m - 1) as f64 + (level - before) / (after - before)
        };
        let relative = curve.iter().map(|g| g / gain);
        [
            at(0.1),
            at(0.5),
            at(0.9),
            relative.fold(f64::NEG_INFINITY, f64::max),
        ]
    };
    let levels = [high, low].map(|command| model.level_at(command).value.unwrap_or(f64::NAN));
    [&of(&model.up.value)[..], &of(&model.down.value), &levels].concat()
}

/// Welch's comparison of two means, variances unknown and unequal.
struct Welch {
    difference: f64,
    /// Standard error of the difference.
    error: f64,
    distribution: StudentsT,
}

impl Welch {
    /// `None` without scatter to compare with.
    fn new(a: &[f64], b: &[f64]) -> Option<Self> {
        let moments = |values: &[f64]| {
            let count = values.len() as f64;
            let mean = values.iter().sum::<f64>() / count;
            let square: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
            (mean, square / (count - 1.0) / count, count - 1.0)
        };
        let ((mean_a, share_a, degrees_a), (mean_b, share_b, degrees_b)) = (moments(a), moments(b));
        let variance = share_a + share_b;
        let degrees =
            variance.powi(2) / (share_a.powi(2) / degrees_a + share_b.powi(2) / degrees_b);
        let welch = Self {
            difference: mean_a - mean_b,
            error: variance.sqrt(),
            distribution: StudentsT::new(0.0, 1.0, degrees).ok()?,
        };
        (welch.difference / welch.error)
            .is_finite()
            .then_some(welch)
    }

    /// Two-sided p of equal means.
    fn p(&self) -> f64 {
        2.0 * self.distribution.sf((self.difference / self.error).abs())
    }

    /// Half the width of the interval of the difference.
    fn half_width(&self, level: f64) -> f64 {
        self.error * self.distribution.inverse_cdf((1.0 + level) / 2.0)
    }
}

/// The share of the splits of all runs into groups of these sizes whose difference is at least as large.
fn permutation(a: &[DirectionModel], b: &[DirectionModel]) -> f64 {
    let runs = a.iter().chain(b);
    let curves: Vec<Vec<f64>> = runs
        .map(|model| [model.up.value.as_slice(), &model.down.value].concat())
        .collect();
    let mut split: Vec<bool> = (0..curves.len()).map(|k| k < a.len()).collect();
    let reached = statistic(&curves, &split);
    // Statistics of the same split in another order of summation differ by rounding.
    let exceeds = |split: &[bool]| statistic(&curves, split) >= reached * (1.0 - 1e-9);
    if let Some(splits) = all_splits(curves.len(), a.len()) {
        let count = splits.iter().filter(|split| exceeds(split)).count();
        return count as f64 / splits.len() as f64;
    }
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let drawn = (0..SPLITS).filter(|_| {
        split.shuffle(&mut random);
        exceeds(&split)
    });
    (drawn.count() + 1) as f64 / (SPLITS + 1) as f64
}

/// All ways to mark `chosen` of `total`; `None` where they are too many to be tried.
fn all_splits(total: usize, chosen: usize) -> Option<Vec<Vec<bool>>> {
    let count = (0..chosen).fold(1.0, |count, k| count * (total - k) as f64 / (k + 1) as f64);
    // With five of each at least, so few splits are of fewer runs than a number has bits.
    (count <= SPLITS as f64 && total < 32).then(|| {
        let marks = |mask: u32| (0..total).map(|k| mask >> k & 1 == 1).collect();
        let masks = (0..1u32 << total).filter(|mask| mask.count_ones() as usize == chosen);
        masks.map(marks).collect()
    })
}

/// max_m |difference of means| / (s_m + median s), s the pooled scatter within groups.
fn statistic(curves: &[Vec<f64>], first: &[bool]) -> f64 {
    let points = curves[0].len();
    let group = |m: usize, side: bool| {
        let marked = curves.iter().zip(first).filter(|(_, f)| **f == side);
        let values: Vec<f64> = marked.map(|(curve, _)| curve[m]).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        (mean, values.iter().map(|x| (x - mean).powi(2)).sum::<f64>())
    };
    let degrees = (curves.len() - 2) as f64;
    let (difference, scatter): (Vec<f64>, Vec<f64>) = (0..points)
        .map(|m| {
            let ((mean_a, square_a), (mean_b, square_b)) = (group(m, true), group(m, false));
            (
                (mean_a - mean_b).abs(),
                ((square_a + square_b) / degrees).sqrt(),
            )
        })
        .unzip();
    let mut sorted = scatter.clone();
    sorted.sort_by(f64::total_cmp);
    let scales = scatter.iter().map(|s| s + sorted[points / 2]);
    let relative = difference
        .iter()
        .zip(scales)
        .filter(|(_, scale)| *scale > 0.0);
    relative.map(|(d, scale)| d / scale).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn welch_agrees_with_a_worked_example() {
        // t = 3 / sqrt(1/3 + 4/3) = 2.3238, 2.941 degrees of freedom.
        let p = Welch::new(&[1.0, 2.0, 3.0], &[3.0, 5.0, 7.0]).unwrap().p();
        let exact = 2.0
            * StudentsT::new(0.0, 1.0, 50.0 / 17.0)
                .unwrap()
                .sf(3.0 / (5.0f64 / 3.0).sqrt());
        assert_abs_diff_eq!(p, exact, epsilon = 1e-12);
        assert!(Welch::new(&[1.0, 1.0], &[1.0, 1.0]).is_none());
    }

    #[test]
    fn all_splits_are_listed_once() {
        let mut splits = all_splits(10, 5).unwrap();
        assert_eq!(splits.len(), 252);
        assert!(
            splits
                .iter()
                .all(|split| split.iter().filter(|mark| **mark).count() == 5)
        );
        splits.sort();
        splits.dedup();
        assert_eq!(splits.len(), 252);
    }
}
