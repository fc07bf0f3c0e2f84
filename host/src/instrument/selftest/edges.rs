//! The instant at which a reading changes, by halving.

use std::ops::RangeInclusive;

/// The instant (µs) between which and the one before it the readings change from `before` to not `before`, less half a step: so
/// it is known to half a microsecond. `None` where the readings at the ends are not different, or one of them is not to be had.
pub(super) fn change<E>(
    range: RangeInclusive<u16>,
    before: bool,
    mut reads_high: impl FnMut(u16) -> Result<Option<bool>, E>,
) -> Result<Option<f64>, E> {
    let (mut low, mut high) = range.into_inner();
    if reads_high(low)? != Some(before) || reads_high(high)? != Some(!before) {
        return Ok(None);
    }
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        match reads_high(middle)? {
            Some(level) if level == before => low = middle,
            Some(_) => high = middle,
            None => return Ok(None),
        }
    }
    Ok(Some(f64::from(high) - 0.5))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    #[test]
    fn a_change_is_found_where_it_is() {
        let fall = |at: u16| Ok::<_, Infallible>(Some(at < 1_480));
        assert_eq!(change(1_400..=1_600, true, fall), Ok(Some(1_479.5)));
        assert_eq!(change(1_479..=1_480, true, fall), Ok(Some(1_479.5)));
        assert_eq!(change(1_480..=1_600, true, fall), Ok(None));
        assert_eq!(change(1_400..=1_600, false, fall), Ok(None));
        let nothing = |_| Ok::<_, Infallible>(None);
        assert_eq!(change(1_400..=1_600, true, nothing), Ok(None));
    }
}
