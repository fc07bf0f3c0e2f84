//! Whether the servo has followed its pulses from each position to the next.

use super::mover::Rest;
use super::travel::STANDS_STILL;

/// Two positions between which the servo stood still, as it does beyond the end of its travel.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "between {from_us} and {to_us} µs the sensor's reading changes by {counts:.0} counts, where {expected:.0} would be as many as elsewhere: the servo does not follow its pulses there; {}",
    remedy(*followed_us)
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
    /// The pulses from which to which it follows in full (µs); `None` where it follows between no two positions.
    pub followed_us: Option<[u16; 2]>,
}

/// Positions that are given in the place of those where the servo stood still.
const POSITIONS: u16 = 5;

/// A change of the reading that is smaller by more than this part is not the full one: a stop lies between the two positions.
const IN_FULL: f64 = 0.1;

/// What to add to the command so that it works.
fn remedy(followed_us: Option<[u16; 2]>) -> String {
    let Some([shortest, longest]) = followed_us else {
        return "give positions at which it does with --pulses, or narrower limits in the rig file ('servoid calibrate --travel-only' shows \
                where the travel ends)"
            .to_owned();
    };
    let apart = (longest - shortest) / (POSITIONS - 1);
    let pulses: Vec<String> = (0..POSITIONS)
        .map(|k| (shortest + k * apart).to_string())
        .collect();
    format!(
        "take --pulses {}, between which it does, with the angles there where they are read ('servoid calibrate --travel-only' shows where the travel ends)",
        pulses.join(",")
    )
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
            followed_us: longest_part(pairs().map(|(a, b)| {
                let in_full = slope(a, b) > (1.0 - IN_FULL) * steepest;
                ([a.pulse_us, b.pulse_us], in_full)
            })),
        }),
        _ => Ok(()),
    }
}

/// The longest stretch of neighbouring pairs of pulses between which the servo follows in full.
fn longest_part(pairs: impl Iterator<Item = ([u16; 2], bool)>) -> Option<[u16; 2]> {
    let mut parts: Vec<[u16; 2]> = Vec::new();
    for ([from, to], _) in pairs.filter(|(_, in_full)| *in_full) {
        match parts.last_mut() {
            Some([_, end]) if *end == from => *end = to,
            _ => parts.push([from, to]),
        }
    }
    parts.into_iter().max_by_key(|[from, to]| to - from)
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
        // From 1500 to 1700 it moves by less than from 1300 to 1500: the stop lies between.
        assert_eq!(error.followed_us, Some([1300, 1500]));
        let said = error.to_string();
        assert!(
            said.contains("take --pulses 1300,1350,1400,1450,1500, between which it does"),
            "{said}"
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
