//! Speeds that larger strokes of a record have in common, as they were measured.
//!
//! A speed that builds up over a stroke, as that of a motor, ends some percent above. Whether the speed is limited, the [strokes](super::rate) say by themselves: no model is asked, so that no other term can stand for the limit.

use serde::{Deserialize, Serialize};

use super::directed_strokes::strokes_by_direction;
use super::rate::{Rate, RateVerdict};
use super::speed_drift::speed_drift;
use super::time_to_rest::time_to_rest;
use crate::data::{Record, Stroke};

/// Confidence level of an interval that is not used: the verdict has one of its own.
const LEVEL: f64 = 0.99;

/// The speeds to which strokes of a record are limited, each where the record shows it: the mean over the part of their travel in which the larger ones are fastest, where that
/// does not grow with the stroke.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SpeedLimits {
    /// Towards larger outputs \[output/s\].
    pub upwards: Option<f64>,
    /// Towards smaller outputs, not negative \[output/s\].
    pub downwards: Option<f64>,
    /// By which part strokes are quicker at the end of the record than at its beginning, negative where they are slower; `None` where they do not change beyond
    /// chance. Where they do, no speed is that of the whole record, so that it has no limits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub change: Option<f64>,
}

impl SpeedLimits {
    /// Those of a record of a servo that takes at least `response` samples to its rest, and goes against its command where it is `reversed`. The holds of a
    /// sweep are shorter than that: they have no strokes.
    ///
    /// ```
    /// use servoid_identification::Record;
    /// use servoid_identification::nonlinear::SpeedLimits;
    /// // At 0.4 a sample of 10 ms, whatever the stroke is.
    /// let levels = [0.0, 5.0, -4.0, 9.0, 2.0, -7.0, 6.0];
    /// let u: Vec<f64> = (0..2800).map(|k| levels[k / 100 % 7]).collect();
    /// let y: Vec<f64> = u.iter().scan(0.0, |y, u| { *y += (u - *y).clamp(-0.4, 0.4); Some(*y) }).collect();
    /// let found = SpeedLimits::of(&Record::of_run(0.01, &u, &y)?, 10, false);
    /// assert!((found.upwards.unwrap() - 40.0).abs() < 1.0);
    /// # Ok::<(), servoid_identification::Error>(())
    /// ```
    #[must_use]
    pub fn of(record: &Record, response: usize, reversed: bool) -> Self {
        let Some(settling) = time_to_rest(record) else {
            return Self::default();
        };
        let [up, down] = strokes_by_direction(record, settling.max(response), reversed);
        if let Some(change) = speed_drift(&up, &down) {
            return Self {
                change: Some(change),
                ..Self::default()
            };
        }
        let limit = |name: &str, strokes: &[Stroke]| {
            let rate = Rate::new(name, strokes, LEVEL);
            let is_limited = rate.verdict == RateVerdict::Limited;
            rate.speed.value.filter(|_| is_limited)
        };
        Self {
            upwards: limit("up", &up),
            downwards: limit("down", &down),
            change: None,
        }
    }

    /// Whether the record shows any.
    #[must_use]
    pub fn are_none(&self) -> bool {
        *self == Self::default()
    }
}
