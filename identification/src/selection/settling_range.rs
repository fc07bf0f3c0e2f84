//! The settling times that a record allows.

use crate::data::{Record, Run};
use crate::error::Error;
use crate::options::MAX_AUTO_ORDER;
use crate::thresholds::{
    LONGEST_SETTLING, ROWS_FOR_PREDICTION, ROWS_KEPT, ROWS_PER_SAMPLE, SHORTEST_CHOICE,
    SHORTEST_SETTLING,
};

/// Ratio of neighbouring settling times of the grid.
const GRID_RATIO: f64 = 1.12;

/// The longest settling time that `record` can support \[samples, odd\].
///
/// # Errors
/// The record is too short for any choice.
pub(crate) fn longest_settling(record: &Record, cap: Option<usize>) -> Result<usize, Error> {
    let cap = cap.unwrap_or(LONGEST_SETTLING);
    let with_rows = |rows: usize| longest_where(record, cap, |settling| rows * settling);
    let plenty = with_rows(ROWS_PER_SAMPLE);
    // A short record leaves no choice with so many rows to spare: half as many have to do, and the
    // advice says that parameters are many.
    let longest = if plenty >= SHORTEST_CHOICE {
        plenty
    } else {
        with_rows(ROWS_PER_SAMPLE / 2).min(SHORTEST_CHOICE)
    };
    if longest < SHORTEST_SETTLING {
        let needed = (ROWS_PER_SAMPLE / 2 + 1) * SHORTEST_SETTLING + MAX_AUTO_ORDER;
        let outputs = record.outputs().filter(|output| !output.is_nan()).count();
        // To the nearest: the ends of a record need not have an output.
        let every = (record.samples() + outputs / 2) / outputs.max(1);
        return Err(match record.samples() >= needed && every > 1 {
            true => Error::OutputsFarApart { every },
            false => Error::TooShortForAuto {
                samples: record.samples(),
                needed,
                at_rest: rest_that_helps(record),
            },
        });
    }
    Ok(longest)
}

/// The first input of all runs, where the record is long enough once it is known to be the one at rest.
fn rest_that_helps(record: &Record) -> Option<f64> {
    let first = |run: &Run| run.input().first().copied();
    let input = record.runs().iter().find_map(first)?;
    let common = record.runs().iter().all(|run| first(run) == Some(input));
    let runs = record.runs().iter().cloned();
    let runs = runs.map(|run| run.with_input_at_rest(input)).collect();
    let stated = Record::new(record.sample_period_s(), runs).ok()?;
    let longest = longest_where(&stated, SHORTEST_SETTLING, |settling| {
        ROWS_PER_SAMPLE / 2 * settling
    });
    (common && longest >= SHORTEST_SETTLING).then_some(input)
}

/// The longest settling time that can be tried when only prediction counts \[samples, odd\]: three quarters
/// of the record determine it, and histories do not use up the record.
pub(crate) fn longest_for_prediction(record: &Record, cap: Option<usize>) -> usize {
    let rows = ((record.samples() - record.missing()) as f64 * ROWS_KEPT) as usize;
    longest_where(record, cap.unwrap_or(LONGEST_SETTLING), |settling| {
        rows.max(ROWS_FOR_PREDICTION * settling)
    })
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
    odd_at_most(low)
}

/// The largest odd number up to `samples`; 0 of 0.
pub(crate) fn odd_at_most(samples: usize) -> usize {
    samples.saturating_sub(usize::from(samples.is_multiple_of(2)))
}

/// Odd settling times from [`SHORTEST_SETTLING`] to `longest`, each about 1.12 times the one before.
pub(crate) fn grid(longest: usize) -> Vec<usize> {
    let mut grid: Vec<usize> = std::iter::successors(Some(SHORTEST_SETTLING as f64), |settling| {
        Some(settling * GRID_RATIO)
    })
    .map(|settling| settling as usize | 1)
    .take_while(|settling| *settling < longest)
    .collect();
    grid.push(longest);
    grid.dedup();
    grid
}

/// Longest settling times below `longest` down to the smallest that leaves a choice: each a quarter shorter.
pub(crate) fn shorter(longest: usize) -> impl Iterator<Item = usize> {
    std::iter::successors(Some(longest), |longest| Some(odd_at_most(longest * 3 / 4)))
        .skip(1)
        .take_while(|longest| *longest >= SHORTEST_CHOICE)
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
