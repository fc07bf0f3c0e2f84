//! Whether two groups of runs differ by more than runs of one servo differ among themselves.
//!
//! With three or four runs a side: Welch's t tests on ten figures of each run (times of 10, 50 and
//! 90 % and the peak, up and down; both levels at rest), the smallest p times ten (Bonferroni). With
//! five or more: the largest difference of the mean curves, each point over its own scatter, against
//! its distribution over all ways to split the runs into two groups.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use super::motion::ends;
use super::pair::Identified;
use super::welch::Welch;
use crate::error::Error;
use crate::nonlinear::DirectionModel;

/// Runs a side needed for t tests, and for permutations: with four, the smallest possible p is
/// 2/70.
const RUNS: (usize, usize) = (3, 5);

/// Most splits that are all tried; beyond, as many are drawn at random, seed below.
const SPLITS: usize = 20_000;
const SEED: u64 = 20_250_918;

/// Probability of a difference at least as large if both sides are one servo; `None` with fewer than three runs on a side.
pub(super) fn p_value(a: &Identified<'_>, b: &Identified<'_>) -> Result<Option<f64>, Error> {
    let fewest = a.record.runs().len().min(b.record.runs().len());
    if fewest < RUNS.0 {
        return Ok(None);
    }
    let ends = ends(a.record);
    let basis = a.model.basis()?;
    let (a, b) = (a.splits_of_runs(basis)?, b.splits_of_runs(basis)?);
    if fewest >= RUNS.1 {
        return Ok(Some(permutation(&a, &b)));
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
    Ok(Some((10.0 * smallest).min(1.0)))
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
