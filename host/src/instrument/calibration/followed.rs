//! Whether the servo has followed its pulses from each position to the next.

use super::mover::Rest;
use super::travel::STANDS_STILL;

/// Two positions between which the servo stood still, as it does beyond the end of its travel.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "between {from_us} and {to_us} µs the sensor's reading changes by {counts:.0} counts, where {expected:.0} would be as many as elsewhere: the servo does not follow its pulses there; give positions at which it does with --pulses, or narrower limits in the rig file ('servoid calibrate --travel-only' shows where the travel ends)"
)]
pub struct NotFollowed {
    /// The shorter pulse (µs).
    pub from_us: u16,
    /// The longer pulse (µs).
    pub to_us: u16,
    /// How far apart the readings there are (counts).
    pub counts: f64,
    /// How far apart they would be where the servo follows as well as anywhere (counts).
    pub expected: f64,
}

/// Looks for neighbouring positions between which the reading changes by less than a quarter of what it
/// does where it changes most, for the same change of the pulse.
///
/// # Errors
/// [`NotFollowed`] for the pair that changes least.
pub fn require_followed(rests: &[Rest]) -> Result<(), NotFollowed> {
    let mut rests = rests.to_vec();
    rests.sort_by_key(|rest| rest.pulse_us);
    rests.dedup_by_key(|rest| rest.pulse_us);
    let slope = |a: &Rest, b: &Rest| {
        (b.counts - a.counts).abs() / (f64::from(b.pulse_us) - f64::from(a.pulse_us))
    };
    let pairs = || rests.iter().zip(rests.iter().skip(1));
    let steepest = pairs().map(|(a, b)| slope(a, b)).fold(0.0, f64::max);
    let flattest = pairs().min_by(|x, y| slope(x.0, x.1).total_cmp(&slope(y.0, y.1)));
    match flattest {
        Some((a, b)) if slope(a, b) < STANDS_STILL * steepest => Err(NotFollowed {
            from_us: a.pulse_us,
            to_us: b.pulse_us,
            counts: (b.counts - a.counts).abs(),
            expected: steepest * (f64::from(b.pulse_us) - f64::from(a.pulse_us)),
        }),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rests(counts: &[(u16, f64)]) -> Vec<Rest> {
        let rest = |&(pulse_us, counts): &(u16, f64)| Rest {
            pulse_us,
            counts,
            sd_counts: 5.0,
            samples: 250,
        };
        counts.iter().map(rest).collect()
    }

    #[test]
    fn a_stop_is_found_and_a_soft_end_or_a_repeated_position_is_none() {
        let stop = rests(&[
            (1500, 8000.0),
            (1300, 6000.0),
            (1700, 8600.0),
            (1900, 8601.0),
        ]);
        let error = require_followed(&stop).unwrap_err();
        assert_eq!((error.from_us, error.to_us), (1700, 1900));
        assert!(
            error
                .to_string()
                .contains("changes by 1 counts, where 2000")
        );
        let soft = rests(&[
            (1300, 6000.0),
            (1500, 8000.0),
            (1500, 8001.0),
            (1700, 9000.0),
        ]);
        assert_eq!(require_followed(&soft), Ok(()));
        // Nothing moves at all: that is for the fit to find.
        assert_eq!(
            require_followed(&rests(&[(1300, 8000.0), (1500, 8000.0)])),
            Ok(())
        );
    }
}
