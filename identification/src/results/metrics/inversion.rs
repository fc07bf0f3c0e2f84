//! Intervals by inverting a test: of all places, those at which the curve may be passing its level.
//!
//! Where a curve surely rises, it passes a level v = 0 before the place τ exactly when v(τ) > 0, and
//! v(τ) is normal. So the distribution of the crossing is known without drawing from it,
//!
//! ```text
//! P(crossing <= τ) = Φ(v(τ) / sd v(τ))
//! ```
//!
//! and its quantiles, the places where v(τ) = ± z sd v(τ), are at once the bounds of Fieller (1954):
//! the places at which v = 0 is not rejected.

use super::interpolation::weights_at;
use super::sample_uncertainty::{Joint, SampleSpread, Weights};
use crate::numerics::{halved, not_negative};
use crate::thresholds::{RISING, SURE};

/// A level that a curve passes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Level {
    /// Of the final value.
    pub(crate) share: f64,
    /// 1 when the curve comes from below, -1 from above.
    pub(crate) side: f64,
}

impl Level {
    /// A level reached from below.
    pub(crate) fn rising(share: f64) -> Self {
        Self { share, side: 1.0 }
    }
}

/// A curve and what is known of it.
#[derive(Clone, Copy)]
pub(crate) struct Known<'a> {
    pub(crate) curve: &'a [f64],
    pub(crate) spread: &'a SampleSpread<'a>,
    pub(crate) joint: &'a Joint,
}

/// The only crossing of a level within a stretch in which the curve surely rises.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SureCrossing {
    pub(crate) value: f64,
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    /// The last sample surely before the crossing, the first surely behind it.
    pub(crate) stretch: (usize, usize),
    /// What is zero at the crossing.
    passing: Weights,
}

impl Known<'_> {
    fn last(&self) -> usize {
        self.curve.len() - 1
    }

    /// Whether sample `m` is surely on the near side (-1) or the far side (1) of a level.
    pub(crate) fn surely(&self, m: usize, level: Level, side: f64) -> bool {
        let v = level.side * (self.curve[m] - level.share * self.curve[self.last()]);
        side * v >= SURE * self.spread.sd_over(m, level.share)
    }

    /// The crossing at `value` \[samples\] and its bounds, `critical` standard deviations wide;
    /// `None` when other samples nearby may pass the level too.
    pub(crate) fn crossing(&self, value: f64, level: Level, critical: f64) -> Option<SureCrossing> {
        if !value.is_finite() || value as usize + 1 >= self.last() {
            return None;
        }
        let next = value as usize + 1;
        let before = (0..next).rfind(|&m| self.surely(m, level, -1.0))?;
        let after = (next..self.last()).find(|&m| self.surely(m, level, 1.0))?;
        for m in before..after {
            let step = [
                (m + 1, level.side),
                (m, -level.side),
                (0, 0.0),
                (0, 0.0),
                (0, 0.0),
            ];
            let rise = level.side * (self.curve[m + 1] - self.curve[m]);
            if rise < RISING * self.joint.sd_of(&step)? {
                return None;
            }
        }
        // Both ends of the stretch are in the joint covariance, and so all between them.
        self.edge(before as f64, level, 0.0)?;
        self.edge(after as f64, level, 0.0)?;
        let bound = |end: usize, side: f64| {
            let edge = |place: f64| self.edge(place, level, side * critical).unwrap_or(side);
            halved(value, end as f64, |place| side * edge(place) > 0.0)
        };
        Some(SureCrossing {
            value,
            lower: bound(before, 1.0),
            upper: bound(after, -1.0),
            stretch: (before, after),
            passing: weights_at(value, self.last(), level.share),
        })
    }

    /// The curve over the level at a place between samples, plus `deviations` standard deviations.
    fn edge(&self, place: f64, level: Level, deviations: f64) -> Option<f64> {
        let weights = weights_at(place, self.last(), level.share);
        let sd = self.joint.sd_of(&weights)?;
        Some(level.side * self.value_of(&weights) + deviations * sd)
    }

    fn value_of(&self, weights: &Weights) -> f64 {
        weights.iter().map(|&(m, w)| w * self.curve[m]).sum()
    }

    /// The time from one crossing to a later one, by the bounds of both and their correlation (Zou &
    /// Donner 2008): with l, u the bounds of x and ρ the correlation,
    ///
    /// ```text
    /// lower = x2 - x1 - sqrt((x2-l2)² + (u1-x1)² - 2ρ (x2-l2)(u1-x1)),  upper likewise
    /// ```
    pub(crate) fn between(
        &self,
        first: &SureCrossing,
        second: &SureCrossing,
    ) -> Option<(f64, f64)> {
        let sd = |crossing: &SureCrossing| self.joint.sd_of(&crossing.passing);
        let scale = sd(first)? * sd(second)?;
        let covariance = self.joint.covariance_of(&first.passing, &second.passing)?;
        let correlation = if scale > 0.0 { covariance / scale } else { 0.0 };
        let reach = |a: f64, b: f64| not_negative(a * a + b * b - 2.0 * correlation * a * b).sqrt();
        let time = second.value - first.value;
        let below = reach(second.value - second.lower, first.upper - first.value);
        let above = reach(second.upper - second.value, first.value - first.lower);
        Some((time - below, time + above))
    }
}
