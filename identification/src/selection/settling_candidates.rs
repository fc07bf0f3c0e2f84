//! A choice of the settling time, and the candidates that led to it.

use serde::{Deserialize, Serialize};

use crate::thresholds::{CONTRADICTION, DETECTION, MARGIN};

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

impl SettlingCandidate {
    /// Acceptable is an N that the long fit does not contradict, with the margin over its own N0.
    pub(super) fn new(
        settling: usize,
        detected: usize,
        contradiction: f64,
        longest: usize,
    ) -> Self {
        Self {
            settling,
            detected,
            contradiction,
            accepted: (settling == longest || contradiction <= CONTRADICTION)
                && settling as f64 >= MARGIN * detected as f64,
        }
    }
}

/// A choice of the settling time and the candidates that led to it.
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
    #[serde(alias = "low_passed")]
    pub smooth_input: bool,
    /// n, when the input lacks high frequencies.
    pub frequencies: Option<usize>,
    /// The lags that the input resolves, where it repeats itself after them \[samples\].
    #[serde(default)]
    pub repeats_after: Option<usize>,
    /// Whether N is limited to the usual hold of the input, or to the rest of the output within it, because the servo is not linear and
    /// seemed to respond for longer.
    #[serde(default)]
    pub within_holds: bool,
    /// Until when a response of more lags moves, where the output is seen at rest before \[samples\]: it answers the steps before.
    #[serde(default)]
    pub moved_until: Option<usize>,
    /// Whether N is the longest because of a slow end that no single lag shows.
    #[serde(default)]
    pub for_slow_end: bool,
    /// D of the long fit, to start from.
    pub ar: Vec<f64>,
    /// The settling times considered.
    pub candidates: Vec<SettlingCandidate>,
}

impl Choice {
    /// Takes settling times in ascending order up to the first that is accepted, or the longest.
    pub(super) fn first_accepted(
        all: impl Iterator<Item = SettlingCandidate>,
        longest: usize,
        ar: Vec<f64>,
    ) -> Option<Self> {
        let mut candidates = Vec::new();
        for candidate in all {
            candidates.push(candidate);
            if candidate.accepted {
                break;
            }
        }
        let last = *candidates.last()?;
        Some(Self {
            settling: last.settling,
            detected: last.detected,
            settled: last.accepted,
            longest,
            smooth_input: false,
            frequencies: None,
            repeats_after: None,
            within_holds: false,
            moved_until: None,
            for_slow_end: false,
            ar,
            candidates,
        })
    }
}

/// Standard deviations that are left of an exponential end after `times` the time up to which it is seen, of a response
/// whose standard deviation is `noise` of its size. It is seen down to c of them, so the share (c s)^κ is left after κ
/// times as long: c (c s)^(κ-1) standard deviations.
pub(crate) fn hidden_end(noise: f64, times: f64) -> f64 {
    DETECTION * (DETECTION * noise).powf(times - 1.0)
}
