//! Brackets of the crossings of a rise that is known so badly that the estimate is itself as rough as any draw.
//!
//! Draws from a rough estimate are rougher still: they pass a level earlier, and later, than the truth, and
//! their quantiles miss it. A bracket asks of each sample by itself whether it may be beyond a level, or surely is.

use super::crossings_and_peak::LEVELS;
use super::interval::Interval;
use super::rise::RiseIntervals;
use super::sample_uncertainty::SampleSpread;
use crate::thresholds::ROUGH_SAMPLE;

/// A curve whose gain is positive, and how well its samples are known.
pub(super) struct Brackets<'a> {
    pub(super) curve: &'a [f64],
    pub(super) spread: &'a SampleSpread<'a>,
    /// Critical values of one sample and of all.
    pub(super) one: f64,
    pub(super) all: f64,
}

impl Brackets<'_> {
    fn last(&self) -> usize {
        self.curve.len() - 1
    }

    /// Whether one of the samples `points` is known to no better than [`ROUGH_SAMPLE`].
    pub(super) fn are_needed(&self, points: &[usize]) -> bool {
        let sd = points.iter().map(|&m| self.spread.sd_over(m, LEVELS.half));
        self.one * sd.fold(0.0, f64::max) > ROUGH_SAMPLE * self.curve[self.last()]
    }

    /// Sample `m` over a level, less `deviations` standard deviations.
    fn over(&self, m: usize, share: f64, deviations: f64) -> f64 {
        let level = share * self.curve[self.last()];
        self.curve[m] - level - deviations * self.spread.sd_over(m, share)
    }

    /// The earliest time from `from` on at which a level may be passed. Only the sample after the crossing can
    /// make it wrong.
    fn earliest(&self, from: usize, share: f64) -> f64 {
        (from..self.last())
            .find(|&m| self.over(m, share, -self.one) > 0.0)
            .map_or(from as f64, |m| m.saturating_sub(1).max(from) as f64)
    }

    /// The first sample from `from` on that is surely beyond a level: any sample before the crossing can make
    /// it wrong.
    fn reached(&self, from: usize, share: f64) -> Option<usize> {
        (from..self.last()).find(|&m| self.over(m, share, self.all) > 0.0)
    }

    /// The times by which the response has passed 5, 10, 50 and 90 % as [`Shape`](super::crossings_and_peak::Shape) reads them:
    /// half and 90 % for the first time, the others for the last time before half. `value` holds the estimates.
    pub(super) fn intervals(&self, value: &RiseIntervals) -> RiseIntervals {
        let half_first = self.earliest(0, LEVELS.half);
        let half_last = self.reached(0, LEVELS.half);
        let early = |share: f64| {
            let all_above = half_last.map(|half| {
                (0..half)
                    .rfind(|&m| self.over(m, share, self.one) <= 0.0)
                    .map_or(0, |m| m + 1)
            });
            (self.earliest(0, share), end(all_above))
        };
        let (delay, tenth) = (early(LEVELS.delay), early(LEVELS.tenth));
        let late_first = self.earliest(half_first as usize, LEVELS.ninety);
        let late_last = end(half_last.and_then(|half| self.reached(half, LEVELS.ninety)));
        let interval = |value: Interval, (lower, upper): (f64, f64)| {
            Interval::new(value.value.unwrap_or(f64::INFINITY), lower, upper)
        };
        RiseIntervals {
            delay: either(value.delay, interval(value.delay, delay)),
            half: either(
                value.half,
                interval(value.half, (half_first, end(half_last))),
            ),
            rise: either(
                value.rise,
                interval(
                    value.rise,
                    ((late_first - tenth.1).max(0.0), late_last - tenth.0),
                ),
            ),
        }
    }
}

fn end(sample: Option<usize>) -> f64 {
    sample.map_or(f64::INFINITY, |m| m as f64)
}

/// The smallest interval that contains both.
fn either(a: Interval, b: Interval) -> Interval {
    Interval {
        value: a.value,
        lower: a.lower.zip(b.lower).map(|(a, b)| a.min(b)),
        upper: a.upper.zip(b.upper).map(|(a, b)| a.max(b)),
    }
}
