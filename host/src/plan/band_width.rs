//! Widths of a step response's bands.

use super::runs_needed::NarrowingBand;
use serde::Serialize;
use servoid_identification::results::StepBounds;

/// Half widths of a step response's bands (percent of the step).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BandWidths {
    /// Confidence level.
    pub level: f64,
    /// The whole curve's band, where it is widest.
    pub widest_percent: f64,
    /// The whole curve's band, on average.
    pub mean_percent: f64,
    /// The bounds of single points, on average.
    pub mean_pointwise_percent: f64,
    /// The part of each that more runs do not narrow: the bias by frequencies without power.
    pub bias_percent: f64,
    /// The part of the widest that noise does not explain, the bias included. Runs of a simulated servo repeat
    /// it, so more of them do not narrow it.
    pub beyond_noise_percent: f64,
}

impl BandWidths {
    /// The widths of a step response's bands.
    #[must_use]
    pub fn of(bounds: &StepBounds) -> Self {
        let (pointwise, whole) = bounds.mean_half_widths();
        Self {
            level: bounds.level,
            widest_percent: 100.0 * bounds.widest_half_width(),
            mean_percent: 100.0 * whole,
            mean_pointwise_percent: 100.0 * pointwise,
            bias_percent: 100.0 * bounds.bias(),
            beyond_noise_percent: 0.0,
        }
    }

    /// The mean of several of one level; NaN of none.
    pub(crate) fn mean(all: &[Self]) -> Self {
        let mean = |of: fn(&Self) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
        Self {
            level: all.first().map_or(f64::NAN, |w| w.level),
            widest_percent: mean(|w| w.widest_percent),
            mean_percent: mean(|w| w.mean_percent),
            mean_pointwise_percent: mean(|w| w.mean_pointwise_percent),
            bias_percent: mean(|w| w.bias_percent),
            beyond_noise_percent: mean(|w| w.beyond_noise_percent),
        }
    }

    /// The widest, and the part of it that more runs do not narrow.
    #[must_use]
    pub fn narrowing(&self) -> NarrowingBand {
        NarrowingBand {
            widest_percent: self.widest_percent,
            floor_percent: self.bias_percent.max(self.beyond_noise_percent),
        }
    }
}
