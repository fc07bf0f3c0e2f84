//! Numbers that some programs write where they have no reading.

use std::ops::Range;

/// Nothing but nines, or an end of the whole numbers of 16 and 32 bits: they fit no measurement.
fn is_sentinel(value: f64) -> bool {
    [99.0, 999.0, 9999.0, 99_999.0, 999_999.0].contains(&value.abs())
        || [32_767.0, -32_768.0, 65_535.0].contains(&value)
        || [2_147_483_647.0, -2_147_483_648.0, 4_294_967_295.0].contains(&value)
}

/// How far from all other values such a number lies \[their span\]: a servo that is read as 999 among readings up
/// to 900 may be there.
const APART: f64 = 3.0;

/// A number that stands for no reading, by the look of it, and how many rows have it.
pub(super) fn find(column: &[f64]) -> Option<(f64, usize)> {
    let all = extent(column.iter().copied())?;
    let found = [all.start, all.end]
        .into_iter()
        .find(|end| is_sentinel(*end))?;
    let others = extent(column.iter().copied().filter(|value| *value != found))?;
    let distance = (found - others.end).max(others.start - found);
    let apart = distance > APART * (others.end - others.start);
    apart.then(|| {
        let rows = column.iter().filter(|value| **value == found).count();
        (found, rows)
    })
}

/// The smallest and the largest value; `None` where there is none, or one only.
fn extent(values: impl Iterator<Item = f64>) -> Option<Range<f64>> {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        // A missing value is no bound.
        (low.min(value), high.max(value))
    });
    (low < high).then_some(low..high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_fits_no_reading_is_found_and_a_large_reading_is_not() {
        let mut column: Vec<f64> = (0..100).map(|k| f64::from(k % 11) - 5.0).collect();
        assert_eq!(find(&column), None);
        column[7] = f64::NAN;
        (column[20], column[60]) = (-9999.0, -9999.0);
        assert_eq!(find(&column), Some((-9999.0, 2)));
        (column[20], column[60]) = (9998.0, 9998.0);
        assert_eq!(find(&column), None);
        // Counts of a sensor that reaches the end of its range.
        let counts: Vec<f64> = (0..100).map(|k| 655.35 * f64::from(k + 1)).collect();
        assert_eq!(find(&counts), None);
        for nothing in [&[][..], &[f64::NAN], &[999.0, 999.0], &[1.0, 999.0]] {
            assert_eq!(find(nothing), None, "{nothing:?}");
        }
    }
}
