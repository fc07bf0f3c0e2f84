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

use serde::{Deserialize, Serialize};

use crate::data::moments::Moments;
use crate::data::record::Record;
use crate::error::Error;
use crate::estimation::excitation::Excitation;
use crate::estimation::gls::MAX_AUTO_ORDER;
use crate::estimation::least_squares::RowInformation;
use crate::estimation::nested_banks::NestedBanks;
use crate::estimation::noise_model::{NoiseFit, best_order};
use crate::estimation::truncation::FIRST_ORDER;
use crate::options::NoiseOrder;
use crate::selection::repetition::repeats_after;

use super::long_fit::LongFit;

/// Longest settling time considered unless the options say otherwise \[samples\].
pub const LONGEST_SETTLING: usize = 599;

/// N must be this many times the detected settling time.
pub const MARGIN: f64 = 1.75;

/// Standard deviations at which a response counts as still moving.
pub const DETECTION: f64 = 4.0;

/// Standard deviations at which the long fit contradicts a shorter one.
pub const CONTRADICTION: f64 = 4.75;

/// Smallest N of the grid, and the ratio of its steps. On fast servos a shorter one would do, and narrow the bounds by
/// next to nothing; but the factor [`MARGIN`] covers the rest of a tail whose time constant is that of what was
/// seen, and on so few samples a slow end of a fast response is missed altogether: where 3 % of it took
/// ten times as long, the whole curve was inside its band in 13-78 % of runs with N from 9 on.
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
pub(crate) fn grid(longest: usize) -> Vec<usize> {
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
    match choose_complete_bank(moments, longest, order) {
        Some(choice) => Ok(choice),
        None => crate::selection::smooth_input::choose(moments, longest, order),
    }
}

/// A choice with n = N, up to where the input repeats itself; `None` where it does not support one.
pub(crate) fn choose_complete_bank(
    moments: &Moments,
    longest: usize,
    order: NoiseOrder,
) -> Option<Choice> {
    choose_with_all_frequencies(moments, longest, order).or_else(|| {
        let repeats = repeats_after(moments, longest, SHORTEST)?;
        let told = repeats - usize::from(repeats.is_multiple_of(2));
        let mut choice = choose_with_all_frequencies(moments, told, order)?;
        choice.repeats_after = Some(repeats);
        Some(choice)
    })
}

/// Longest settling times below `longest` down to the smallest that leaves a choice: each a quarter shorter.
///
/// A step that comes after a rest is only in rows whose history begins in that rest. Where the longest N is
/// longer than the rests, no row has a step in its recent past, and the response seems to be excited by nothing.
pub(crate) fn shorter(longest: usize) -> impl Iterator<Item = usize> {
    std::iter::successors(Some(longest), |longest| {
        let shorter = longest * 3 / 4;
        Some(shorter - usize::from(shorter.is_multiple_of(2)))
    })
    .skip(1)
    .take_while(|longest| *longest >= SHORTEST_LONGEST)
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
    for mut candidate in long.candidates(&grid(long.settling)) {
        let n = candidate.settling;
        let agrees = n == long.settling || candidate.contradiction <= CONTRADICTION;
        candidate.accepted = agrees && n as f64 >= MARGIN * candidate.detected as f64;
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

/// The noise filter for the residuals of an impulse response: the highest order at the first
/// pass, then by the criterion or as fixed.
pub(crate) fn next_noise(
    moments: &Moments,
    impulse: &[f64],
    offset: f64,
    order: NoiseOrder,
    first: bool,
) -> Vec<f64> {
    let information = RowInformation::from_moments(moments.clone());
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grid_is_odd_ascends_and_ends_with_the_longest() {
        for longest in [31, 33, 101, 599] {
            let grid = grid(longest);
            assert_eq!((grid[0], grid[grid.len() - 1]), (31, longest));
            assert!(grid.iter().all(|n| n % 2 == 1));
            assert!(grid.windows(2).all(|pair| pair[0] < pair[1]), "{grid:?}");
        }
    }
}
