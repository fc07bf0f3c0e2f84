//! Candidate: all frequencies, up to where the input repeats itself.
//!
//! A square wave of equal holds is the negative of itself a hold ago: its lag k + hold adds nothing to
//! lag k, and no amount of data separates the two. It does determine, and well, a response that is over
//! within a hold. A smooth input is another case: it hardly resolves neighbouring lags from the first one on.
//!
//! The share of a lag's variance that the offset and the lags before it leave unexplained is the
//! squared pivot of a Cholesky factorisation. For a reference with edges it falls slowly with the lag; where it
//! repeats itself, it falls to nothing at once.

use super::complete_bank;
use super::settling_candidates::Choice;
use super::settling_range::odd_at_most;
use super::settling_search::Search;
use crate::data::Moments;
use crate::estimation::{Coordinates, Excitation, FsfBasis, NormalEquations};
use crate::numerics::{dot, median};
use crate::thresholds::NOTHING_NEW;

/// A choice among the lags that the input resolves; `None` where it does not repeat itself.
pub(crate) fn choose(search: &Search<'_>) -> Option<Choice> {
    let repeats = repeats_after(search.moments, search.longest)?;
    let choice = complete_bank::choose(&Search {
        longest: odd_at_most(repeats),
        ..*search
    })?;
    Some(Choice {
        repeats_after: Some(repeats),
        ..choice
    })
}

/// The number of lags from 0 on that the input resolves, where it is below `longest` because the input repeats
/// itself from there on.
///
/// Where that is before [`SHORTEST_SETTLING`](crate::thresholds::SHORTEST_SETTLING) there is no more to resolve. An input that is
/// poor from the start does not repeat itself, it is smooth.
fn repeats_after(moments: &Moments, longest: usize) -> Option<usize> {
    if Excitation::of(moments).is_smooth() {
        return None;
    }
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
        if share <= NOTHING_NEW * median(shares.clone()).unwrap_or(0.0) {
            let lags = i.saturating_sub(1);
            return (lags > 1).then_some(lags);
        }
        shares.push(share);
        row.push(share.sqrt());
        rows.push(row);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Record;

    /// Lags resolved by an input of these holds, repeated, of at most 149.
    fn resolved(holds: &[usize], samples: usize) -> Option<usize> {
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
        let record = Record::of_run(0.002, &input, &input).unwrap();
        repeats_after(&Moments::of_record(&record, 157, 9), 149)
    }

    #[test]
    fn equal_holds_resolve_one_hold_and_unequal_ones_all() {
        assert_eq!(resolved(&[100], 1500), Some(100));
        assert_eq!(resolved(&[16], 1500), Some(16));
        // No negative of itself: all frequencies of a period of 139, but that of the offset.
        assert_eq!(resolved(&[59, 80], 3000), Some(138));
        assert_eq!(resolved(&[100, 70, 40, 120], 3000), None);
        // A single edge out of place, in a long record.
        let mut holds = vec![100; 200];
        holds[50] = 101;
        assert_eq!(resolved(&holds, 20_000), None);
    }

    #[test]
    fn a_smooth_input_does_not_repeat_itself() {
        let wave: Vec<f64> = (0..3000).map(|k| (f64::from(k) * 0.05).sin()).collect();
        let record = Record::of_run(0.002, &wave, &wave).unwrap();
        assert_eq!(
            repeats_after(&Moments::of_record(&record, 157, 9), 149),
            None
        );
    }
}
