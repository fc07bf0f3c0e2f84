//! The settling time, the number of frequencies and the noise order, chosen from the data.
//!
//! **Settling time.** One long fit (N as long as the record allows) gives, through the nesting of
//! Cholesky factors, the step response of every shorter N. For each N of a grid the time N0 is
//! detected after which the response stays within [`DETECTION`] standard deviations of its final value.
//! The shortest N is taken that is at least [`MARGIN`] times its own N0 and that the long fit does not
//! contradict. Detection ends where a tail sinks into the noise; the margin covers the rest of the
//! tail, which a band of a fraction of that width would otherwise miss.
//!
//! **Frequencies.** All of them, n = N: only a complete bank has a band whose label is earned. Where
//! the input lacks high frequencies, that band would be useless; then n is what makes the band of noise
//! *and* truncation together narrowest. Where it repeats itself, such as a square wave of equal holds, N
//! is chosen among the lags that it tells apart.
//!
//! **Noise order.** Bayes' information criterion over 0..8, at every pass of the alternation.

use faer::Mat;
use serde::{Deserialize, Serialize};

use crate::basis::dot;
use crate::error::Error;
use crate::excitation::Excitation;
use crate::gls::MAX_AUTO_ORDER;
use crate::linear::{cholesky, forward_solve, inverse_of_lower};
use crate::moments::Moments;
use crate::nested::NestedBanks;
use crate::noise::{NoiseFit, best_order};
use crate::normal::{Coordinates, Information, NormalEquations};
use crate::options::NoiseOrder;
use crate::record::Record;
use crate::repetition::repeats_after;
use crate::truncation::FIRST_ORDER;

/// Longest settling time considered unless the options say otherwise \[samples\].
pub const LONGEST_SETTLING: usize = 599;

/// N must be this many times the detected settling time.
pub const MARGIN: f64 = 1.75;

/// Standard deviations at which a response counts as still moving.
pub const DETECTION: f64 = 4.0;

/// Standard deviations at which the long fit contradicts a shorter one.
pub const CONTRADICTION: f64 = 4.75;

/// Smallest N of the grid, and the ratio of its steps.
const SHORTEST: usize = 31;
const GRID_RATIO: f64 = 1.12;

/// Smallest longest N that leaves a choice without spending more parameters on it.
const SHORTEST_LONGEST: usize = 41;

/// Rows needed per sample of settling time.
const ROWS_PER_SAMPLE: usize = 6;

/// Rows needed per sample of settling time where bounds are not at stake.
const ROWS_FOR_PREDICTION: usize = 2;

/// Share of the samples that must then be left as rows.
const ROWS_KEPT: f64 = 0.74;

/// The input counts as low-passed when the complete bank's band is this much wider than the best.
const LOW_PASSED_RATIO: f64 = 3.0;

/// Averages are taken over this part of the settling time.
const AVERAGED: usize = 8;

/// Passes of the long fit: its noise model only has to be roughly right.
const PASSES: usize = 4;
const NOISE_TOLERANCE: f64 = 1e-2;

/// Resolution of the choice relative to the spread of the output: tails below it do not matter,
/// also when a record has no noise at all.
const RESOLUTION: f64 = 1e-5;

/// One settling time that was considered.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SettlingCandidate {
    /// N \[samples\].
    pub settling: usize,
    /// N0: samples until the response of this N stays at its final value, as far as the noise shows.
    pub detected: usize,
    /// Largest difference from the long fit, in standard deviations.
    pub contradiction: f64,
    /// Whether it was acceptable.
    pub accepted: bool,
}

/// A choice of the settling time and what led to it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Choice {
    /// N \[samples\].
    pub settling: usize,
    /// N0 of that N \[samples\].
    pub detected: usize,
    /// Whether some N was acceptable; otherwise N is the longest possible.
    pub settled: bool,
    /// The longest N possible \[samples\].
    pub longest: usize,
    /// Whether the input lacks high frequencies, so that n < N.
    pub low_passed: bool,
    /// n, when the input lacks high frequencies.
    pub frequencies: Option<usize>,
    /// The lags that the reference tells apart, where it repeats itself after them: the response is
    /// taken to be over by then \[samples\].
    #[serde(default)]
    pub repeats_after: Option<usize>,
    /// Whether the longest N is what the input stands still for, because the servo is not linear and
    /// seemed to respond for longer.
    #[serde(default)]
    pub within_holds: bool,
    /// D of the long fit, to start from.
    pub ar: Vec<f64>,
    /// The settling times considered.
    pub candidates: Vec<SettlingCandidate>,
}

/// The longest settling time that `record` can support \[samples, odd\].
///
/// # Errors
/// The record is too short for any choice.
pub fn longest_settling(record: &Record, cap: Option<usize>) -> Result<usize, Error> {
    let cap = cap.unwrap_or(LONGEST_SETTLING);
    let plenty = longest_with(record, cap, ROWS_PER_SAMPLE);
    // A short record leaves no choice with so many rows to spare: half as many have to do, and the
    // advice says that parameters are many.
    let longest = if plenty >= SHORTEST_LONGEST {
        plenty
    } else {
        longest_with(record, cap, ROWS_PER_SAMPLE / 2).min(SHORTEST_LONGEST)
    };
    if longest < SHORTEST {
        let needed = (ROWS_PER_SAMPLE / 2 + 1) * SHORTEST + MAX_AUTO_ORDER;
        return Err(Error::TooShortForAuto {
            samples: record.samples(),
            needed,
        });
    }
    Ok(longest)
}

/// The longest settling time that can be tried when only prediction counts \[samples, odd\]: there
/// are rows for estimating it from three quarters of them, and histories do not eat up the record.
pub(crate) fn longest_for_prediction(record: &Record, cap: Option<usize>) -> usize {
    let rows = ((record.samples() - record.missing()) as f64 * ROWS_KEPT) as usize;
    longest_where(record, cap.unwrap_or(LONGEST_SETTLING), |settling| {
        rows.max(ROWS_FOR_PREDICTION * settling)
    })
}

/// The longest odd settling time that leaves `rows_per_sample` rows for each of its samples.
fn longest_with(record: &Record, cap: usize, rows_per_sample: usize) -> usize {
    longest_where(record, cap, |settling| rows_per_sample * settling)
}

/// The longest odd settling time with as many rows as `needed` for it.
fn longest_where(record: &Record, cap: usize, needed: impl Fn(usize) -> usize) -> usize {
    let supported = |settling: usize| {
        record.count_rows(settling + MAX_AUTO_ORDER, MAX_AUTO_ORDER + 1) >= needed(settling)
    };
    // Rows fall as the settling time grows, so the limit can be bisected.
    let (mut low, mut high) = (0, cap + 1);
    while high - low > 1 {
        let middle = usize::midpoint(low, high);
        if supported(middle) {
            low = middle
        } else {
            high = middle
        }
    }
    low.saturating_sub(usize::from(low.is_multiple_of(2)))
}

/// Odd settling times from [`SHORTEST`] to `longest`, each about 1.12 times the one before.
fn grid(longest: usize) -> Vec<usize> {
    let mut grid = Vec::new();
    let mut settling = SHORTEST as f64;
    while (settling as usize | 1) < longest {
        let odd = settling as usize | 1;
        if grid.last() != Some(&odd) {
            grid.push(odd);
        }
        settling *= GRID_RATIO;
    }
    grid.push(longest);
    grid
}

/// Chooses N (and n, if the input lacks high frequencies) from moments with at least
/// `longest` + 8 lags.
///
/// # Errors
/// The input does not even excite a constant gain.
pub fn choose(moments: &Moments, longest: usize, order: NoiseOrder) -> Result<Choice, Error> {
    if let Some(choice) = choose_with_all_frequencies(moments, longest, order) {
        return Ok(choice);
    }
    if let Some(repeats) = repeats_after(moments, longest, SHORTEST) {
        let told = repeats - usize::from(repeats.is_multiple_of(2));
        if let Some(mut choice) = choose_with_all_frequencies(moments, told, order) {
            choice.repeats_after = Some(repeats);
            return Ok(choice);
        }
    }
    crate::low_passed::choose(moments, longest, order)
}

/// A choice with n = N, unless the input does not support it.
fn choose_with_all_frequencies(
    moments: &Moments,
    longest: usize,
    order: NoiseOrder,
) -> Option<Choice> {
    let mut long = LongFit::new(moments, longest, order)?;
    if Excitation::of(moments).is_smooth() {
        long.look_at_averages();
    }
    let choice = choose_complete(&long);
    let banks = NestedBanks::scan(moments, choice.settling, &long.ar, FIRST_ORDER)?;
    (!is_low_passed(&banks, choice.settling)).then_some(choice)
}

/// Whether the complete bank of a settling time is undetermined or useless beside the best one.
pub(crate) fn is_low_passed(banks: &NestedBanks, settling: usize) -> bool {
    let complete = settling - usize::from(settling.is_multiple_of(2));
    banks.excited() < complete
        || banks.largest().half_width() > LOW_PASSED_RATIO * banks.narrowest().half_width()
}

fn choose_complete(long: &LongFit) -> Choice {
    let mut candidates = Vec::new();
    for settling in grid(long.settling) {
        let mut candidate = long.candidate(settling);
        candidate.accepted = (settling == long.settling
            || candidate.contradiction <= CONTRADICTION)
            && settling as f64 >= MARGIN * candidate.detected as f64;
        candidates.push(candidate);
        if candidate.accepted {
            break;
        }
    }
    chosen(candidates, long.settling, long.ar.clone())
}

/// The choice that a list of candidates, the last of them the longest or accepted, amounts to.
pub(crate) fn chosen(candidates: Vec<SettlingCandidate>, longest: usize, ar: Vec<f64>) -> Choice {
    let last = candidates[candidates.len() - 1];
    Choice {
        settling: last.settling,
        detected: last.detected,
        settled: last.accepted,
        longest,
        low_passed: false,
        frequencies: None,
        repeats_after: None,
        within_holds: false,
        ar,
        candidates,
    }
}

/// The settling times to be considered up to `longest`.
pub(crate) fn settling_grid(longest: usize) -> Vec<usize> {
    grid(longest)
}

/// The noise filter for the residuals of an impulse response: the highest order at the first
/// pass, then by the criterion or as fixed.
pub(crate) fn next_noise(
    moments: &Moments,
    impulse: &[f64],
    offset: f64,
    order: NoiseOrder,
    first: bool,
) -> Vec<f64> {
    let information = Information::from_moments(moments.clone());
    let max = match order {
        NoiseOrder::Auto => MAX_AUTO_ORDER,
        NoiseOrder::Order(order) => order,
    }
    .min(moments.output_lags() - 1);
    let residuals = information.residual_moments(impulse, offset, max);
    let Some(noise) = NoiseFit::new(&residuals, moments.output_spread()) else {
        return Vec::new();
    };
    match order {
        NoiseOrder::Auto if !first => {
            noise.coefficients(best_order(&noise.candidates(moments.rows())))
        }
        _ => noise.coefficients(max),
    }
}

/// Largest change between two noise filters.
pub(crate) fn noise_change(a: &[f64], b: &[f64]) -> f64 {
    (0..a.len().max(b.len()))
        .map(|i| (a.get(i).unwrap_or(&0.0) - b.get(i).unwrap_or(&0.0)).abs())
        .fold(0.0, f64::max)
}

/// A complete bank at the longest settling time, factorised with the offset first and the lags
/// ascending, so that every shorter settling time is a prefix.
struct LongFit {
    settling: usize,
    ar: Vec<f64>,
    rows: usize,
    /// L^-1 b.
    projected: Vec<f64>,
    /// Sum of squares of the filtered output.
    total: f64,
    /// Smallest variance of ε that is taken seriously.
    floor: f64,
    /// F': column m holds the weights of `projected` in the step response at m; (N+1) x N.
    weights: Mat<f64>,
    /// Running sums of those columns, where averages are looked at.
    sums: Option<Mat<f64>>,
}

impl LongFit {
    fn new(moments: &Moments, settling: usize, order: NoiseOrder) -> Option<Self> {
        let basis = crate::basis::Basis::full(settling).ok()?;
        let coordinates = Coordinates::new(basis);
        let mut ar = Vec::new();
        for pass in 0..PASSES {
            let factor = OffsetFirst::new(&NormalEquations::new(moments, &coordinates, &ar))?;
            let solution = factor.solution();
            let next = next_noise(moments, &solution[1..], solution[0], order, pass == 0);
            let change = noise_change(&ar, &next);
            ar = next;
            if change < NOISE_TOLERANCE {
                break;
            }
        }
        let factor = OffsetFirst::new(&NormalEquations::new(moments, &coordinates, &ar))?;
        let inverse = inverse_of_lower(&factor.lower);
        // Row j of L^-1 holds the weights of z_j in each parameter; running sums over the lags
        // make them the weights in the step response.
        let mut weights = Mat::zeros(settling + 1, settling);
        for m in 0..settling {
            for j in m + 1..=settling {
                weights[(j, m)] = inverse[(j, m + 1)] * factor.scale[m + 1];
            }
        }
        for m in 1..settling {
            for j in 0..=settling {
                let before = weights[(j, m - 1)];
                weights[(j, m)] += before;
            }
        }
        let spread = moments.output_spread() / moments.rows.max(1) as f64;
        Some(Self {
            settling,
            ar,
            rows: moments.rows,
            projected: factor.projected,
            total: factor.total,
            floor: RESOLUTION * RESOLUTION * spread,
            weights,
            sums: None,
        })
    }

    /// Variance of ε for the settling time `n`.
    fn variance(&self, n: usize) -> f64 {
        let rss = self.total - self.projected[..=n].iter().map(|z| z * z).sum::<f64>();
        let dof = (self.rows as f64 - (n + 1 + self.ar.len()) as f64).max(1.0);
        (rss / dof).max(self.floor)
    }

    /// Looks for the end of the response in its averages too: under a smooth input what noise leaves open of
    /// it is a ripple, which hides a tail from every single sample and not from their mean.
    fn look_at_averages(&mut self) {
        let mut sums = self.weights.clone();
        for m in 1..self.settling {
            for j in 0..=self.settling {
                let before = sums[(j, m - 1)];
                sums[(j, m)] += before;
            }
        }
        self.sums = Some(sums);
    }

    /// The middle of the last stretch whose average is not yet the final value of settling time `n`.
    fn moving_on_average(&self, n: usize, sigma: f64) -> Option<usize> {
        let sums = self.sums.as_ref()?;
        let z = &self.projected[..=n];
        let last = &self.weights.col_as_slice(n - 1)[..=n];
        let end = dot(last, z);
        let width = n / AVERAGED;
        let share = (width as f64).recip();
        let from = (0..n - 1 - width).rev().find(|&m| {
            let (before, after) = (sums.col_as_slice(m), sums.col_as_slice(m + width));
            let (mut value, mut variance) = (-end, 0.0);
            for j in 0..=n {
                let weight = share * (after[j] - before[j]);
                value += weight * z[j];
                variance += (weight - last[j]).powi(2);
            }
            value.abs() > DETECTION * sigma * variance.sqrt()
        });
        from.map(|m| m + 1 + width / 2)
    }

    fn candidate(&self, n: usize) -> SettlingCandidate {
        let sigma = self.variance(n).sqrt();
        let weights = |m: usize| &self.weights.col_as_slice(m)[..=n];
        let z = &self.projected[..=n];
        let last = weights(n - 1);
        let end = dot(last, z);
        let moving = (0..n - 1).rev().find(|&m| {
            let column = weights(m);
            let variance: f64 = column.iter().zip(last).map(|(a, b)| (a - b).powi(2)).sum();
            (dot(column, z) - end).abs() > DETECTION * sigma * variance.sqrt()
        });
        let moving = moving.max(self.moving_on_average(n, sigma));
        let contradiction = (0..self.settling)
            .map(|m| {
                let beyond = &self.weights.col_as_slice(m)[n + 1..];
                let variance = dot(beyond, beyond);
                let difference = dot(beyond, &self.projected[n + 1..]);
                if variance > 0.0 {
                    difference.abs() / (sigma * variance.sqrt())
                } else {
                    0.0
                }
            })
            .fold(0.0, f64::max);
        SettlingCandidate {
            settling: n,
            detected: moving.map_or(1, |m| m + 2),
            contradiction,
            accepted: false,
        }
    }
}

/// Equilibrated Cholesky factor with the offset first.
struct OffsetFirst {
    lower: Mat<f64>,
    scale: Vec<f64>,
    projected: Vec<f64>,
    total: f64,
}

impl OffsetFirst {
    fn new(equations: &NormalEquations) -> Option<Self> {
        let (a, scale) = equations.equilibrated();
        let p = scale.len();
        let original = |k: usize| if k == 0 { p - 1 } else { k - 1 };
        let turned = Mat::from_fn(p, p, |i, j| a[(original(i), original(j))]);
        let lower = cholesky(&turned)?;
        let scale: Vec<f64> = (0..p).map(|k| scale[original(k)]).collect();
        let b: Vec<f64> = (0..p)
            .map(|k| equations.b[original(k)] * scale[k])
            .collect();
        let projected = forward_solve(&lower, &b);
        Some(Self {
            lower,
            scale,
            projected,
            total: equations.c,
        })
    }

    /// Offset, then the impulse response.
    fn solution(&self) -> Vec<f64> {
        let x = crate::linear::backward_solve(&self.lower, &self.projected);
        x.iter().zip(&self.scale).map(|(x, s)| x * s).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grid_is_odd_and_ends_with_the_longest() {
        let grid = grid(101);
        assert_eq!((grid[0], grid[grid.len() - 1]), (31, 101));
        assert!(grid.iter().all(|n| n % 2 == 1));
        assert!(grid.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
