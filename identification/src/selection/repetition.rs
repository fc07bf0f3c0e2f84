//! A reference that repeats itself, and how many lags it tells apart.
//!
//! A square wave of equal holds is the negative of itself a hold ago: its lag k + hold says nothing
//! that lag k has not said, and no amount of data separates the two. What it does say, and says
//! well, is a response that is over within a hold. This is another lack than that of a smooth input,
//! whose lags are hard to tell apart from the first one on.
//!
//! The share of a lag's variance that the offset and the lags before it leave unexplained is the
//! squared pivot of a Cholesky factorisation. For a reference with edges it falls slowly with the lag; where it
//! repeats itself, it falls to nothing at once.

use crate::data::moments::Moments;
use crate::estimation::fsf_basis::FsfBasis;
use crate::estimation::least_squares::{Coordinates, NormalEquations};
use crate::numerics::vectors::dot;

/// A lag counts as told already when it brings this share of what the lags before it brought (median).
/// Exact repetition leaves rounding, 1e-12 or so; one edge in a record of 10^6 samples that is not where
/// it would repeat leaves more than 1e-6 of the variance.
const NOTHING_NEW: f64 = 1e-8;

/// How many lags from 0 on the input tells apart, where that is fewer than `longest` and because it
/// repeats itself from there on.
///
/// `shortest` lags at least have to be told apart before: an input that is poor from the start does
/// not repeat itself, it is smooth.
pub(crate) fn repeats_after(moments: &Moments, longest: usize, shortest: usize) -> Option<usize> {
    let coordinates = Coordinates::new(FsfBasis::full(longest).ok()?);
    let (matrix, _) = NormalEquations::new(moments, &coordinates, &[]).equilibrated();
    // The offset comes last in the equations, and first here.
    let place = |k: usize| if k == 0 { longest } else { k - 1 };
    let mut rows: Vec<Vec<f64>> = Vec::with_capacity(longest + 1);
    let mut shares: Vec<f64> = Vec::with_capacity(longest + 1);
    for i in 0..=longest {
        let mut row: Vec<f64> = Vec::with_capacity(i + 1);
        for (j, earlier) in rows.iter().enumerate() {
            let rest = matrix[(place(i), place(j))] - dot(&row, &earlier[..j]);
            row.push(rest / earlier[j]);
        }
        let share = matrix[(place(i), place(i))] - dot(&row, &row);
        if share <= NOTHING_NEW * median(&shares) {
            let lags = i.saturating_sub(1);
            return (lags >= shortest).then_some(lags);
        }
        shares.push(share);
        row.push(share.sqrt());
        rows.push(row);
    }
    None
}

/// The middle value; 0 of nothing.
fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::record::Record;

    /// Lags told apart by an input of these holds, repeated, of at most 149.
    fn told(holds: &[usize], samples: usize) -> Option<usize> {
        let mut input = Vec::new();
        let mut level = 5.0;
        for hold in holds.iter().cycle() {
            if input.len() >= samples {
                break;
            }
            input.extend(vec![level; *hold]);
            level = -level;
        }
        input.truncate(samples);
        let record = Record::from_slices(0.002, &input, &input).unwrap();
        repeats_after(&Moments::of_record(&record, 157, 9), 149, 31)
    }

    #[test]
    fn equal_holds_tell_one_hold_and_unequal_ones_all() {
        assert_eq!(told(&[100], 1500), Some(100));
        // No negative of itself: all frequencies of a period of 139, but that of the offset.
        assert_eq!(told(&[59, 80], 3000), Some(138));
        assert_eq!(told(&[100, 70, 40, 120], 3000), None);
        // A single edge out of place, in a long record.
        let mut holds = vec![100; 200];
        holds[50] = 101;
        assert_eq!(told(&holds, 20_000), None);
    }

    #[test]
    fn a_smooth_input_does_not_repeat_itself() {
        let wave: Vec<f64> = (0..3000).map(|k| (f64::from(k) * 0.05).sin()).collect();
        let record = Record::from_slices(0.002, &wave, &wave).unwrap();
        assert_eq!(
            repeats_after(&Moments::of_record(&record, 157, 9), 149, 31),
            None
        );
    }
}
