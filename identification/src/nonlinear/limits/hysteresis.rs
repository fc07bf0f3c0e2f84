//! Hysteresis: the mean over levels of (rest from above) - (rest from below).
//!
//! It does not distinguish
//! backlash, dead band and friction. In a servo that overshoots by more than its play the sign is
//! inverted, because the level is then reached from the other side: only the size is reported.

use super::level_table::Table;
use super::open_question::OpenQuestion;
use crate::results::Interval;
use crate::thresholds::HYSTERESIS_FALSE_ALARM;
use serde::{Deserialize, Serialize};

/// Dependence of the rest position on the direction of approach.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Hysteresis {
    /// Whether there is hysteresis; `None` when the recording does not show it.
    pub found: Option<bool>,
    /// Size of the dependence on the direction of approach \[output\].
    pub size: Interval,
    /// The finding as a sentence.
    pub statement: String,
    /// What to record where this recording does not show it, as a sentence; `None` where it does.
    #[serde(default)]
    pub remedy: Option<String>,
}

impl Table {
    pub(super) fn hysteresis(&self) -> Hysteresis {
        // Weights of the mean with the smallest variance.
        let (mut sum, mut weights, mut pairs) = (0.0, 0.0, 0);
        for pair in self
            .cells
            .windows(2)
            .filter(|pair| pair[0].command == pair[1].command)
        {
            let (below, above) = (&pair[0], &pair[1]);
            let (Some(low), Some(high)) = (below.reached.value, above.reached.value) else {
                continue;
            };
            let weight = 1.0 / (1.0 / below.visits as f64 + 1.0 / above.visits as f64);
            sum += weight * (high - low);
            weights += weight;
            pairs += 1;
        }
        if pairs == 0 || self.degrees < 2 {
            return self.open("", Interval::default());
        }
        let difference = sum / weights;
        let sd = (self.variance / weights).sqrt();
        // Both rests of a pair are rounded.
        let rounding = 2.0 * self.rounding;
        let interval = self.within(difference, sd).reaching(rounding, rounding);
        let by_chance = self.critical(HYSTERESIS_FALSE_ALARM / 2.0) * sd + rounding;
        let found = difference.abs() > by_chance;
        let size = absolute(interval);
        if !found && let Some((apart, [lower, upper])) = beyond_zero(size) {
            let seen = format!(
                ": the two directions differ by {apart:.3} ({lower:.3} .. {upper:.3}), which is less than what is surely no chance"
            );
            return self.open(&seen, size);
        }
        Hysteresis {
            found: Some(found),
            size,
            statement: match (found, size.upper) {
                (true, _) if difference < 0.0 => format!(
                    "Hysteresis of {:.3}: rests that are reached from below are higher than those from above, as where the servo overshoots and play, \
                     a dead band or friction leaves it there.",
                    difference.abs()
                ),
                (true, _) => format!(
                    "Hysteresis of {difference:.3}: the mean rest positions of the two directions of approach are so far apart, by backlash, dead band or friction."
                ),
                (false, Some(bound)) => format!(
                    "No hysteresis is found: the mean rest position does not depend on the direction of approach by more than {bound:.3}."
                ),
                (false, None) => "No hysteresis is found: the mean rest position does not depend on the direction of approach by more than it scatters."
                    .to_owned(),
            },
            remedy: None,
        }
    }

    /// That it is open, with what is `seen` of it all the same.
    fn open(&self, seen: &str, size: Interval) -> Hysteresis {
        let open = OpenQuestion {
            finding: format!(
                "This recording does not determine whether the rest position depends on the direction of approach{seen}"
            ),
            remedy: format!(
                "Record stairs that reach each level from both sides, at least twice, each held for at least {:.2} s; where these are such stairs, more of them.",
                self.needed_s
            ),
        };
        Hysteresis {
            found: None,
            size,
            statement: open.statement(),
            remedy: Some(open.remedy),
        }
    }
}

/// A size and its ends, where it is not 0.
fn beyond_zero(size: Interval) -> Option<(f64, [f64; 2])> {
    let (lower, upper) = (size.lower?, size.upper?);
    (lower > 0.0).then_some((size.value?, [lower, upper]))
}

/// The interval of |x| from that of x.
fn absolute(interval: Interval) -> Interval {
    let (Some(value), Some(lower), Some(upper)) = (interval.value, interval.lower, interval.upper)
    else {
        return Interval {
            value: interval.value.map(f64::abs),
            ..Interval::default()
        };
    };
    let nearest = if lower <= 0.0 && upper >= 0.0 {
        0.0
    } else {
        lower.abs().min(upper.abs())
    };
    Interval::new(value.abs(), nearest, lower.abs().max(upper.abs()))
}
