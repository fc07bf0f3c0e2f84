//! Reading a step response: crossings, peak, settling, in samples.
//!
//! The same reading may be done thousands of times over curves that differ little, so it is limited
//! in advance: [`Windows`] holds, for each metric, the samples that can matter within [`SURE`]
//! standard deviations. All other samples are surely on their side of every level.

use std::ops::Range;

use super::crossing::crossing_before;
use crate::thresholds::SURE;

/// Half width of the band that the response must not leave any more, relative to the final value.
pub(crate) const SETTLED: f64 = 0.02;

/// Levels of delay, early end, middle and late end of the rise, relative to the final value.
pub(crate) const LEVELS: AtLevels<f64> = AtLevels {
    delay: 0.05,
    tenth: 0.1,
    half: 0.5,
    ninety: 0.9,
};

/// Metrics of one curve; infinite where the curve does not have them. Times in samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Shape {
    pub(crate) gain: f64,
    pub(crate) crossings: Crossings,
    /// Relative to the gain, zero or more.
    pub(crate) overshoot: f64,
    pub(crate) settling: f64,
}

/// One item for each of [`LEVELS`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct AtLevels<T> {
    pub(crate) delay: T,
    pub(crate) tenth: T,
    pub(crate) half: T,
    pub(crate) ninety: T,
}

/// When a curve passes the levels of its rise, in samples; infinite where it does not.
pub(crate) type Crossings = AtLevels<f64>;

impl Crossings {
    const NONE: Self = Self {
        delay: f64::INFINITY,
        tenth: f64::INFINITY,
        half: f64::INFINITY,
        ninety: f64::INFINITY,
    };

    /// From 10 to 90 %.
    pub(crate) fn rise(&self) -> f64 {
        match self.ninety.is_finite() {
            true => self.ninety - self.tenth,
            false => f64::INFINITY,
        }
    }
}

/// Where to look.
#[derive(Debug, Clone)]
pub(crate) struct Windows {
    half_from: usize,
    peak: Range<usize>,
    /// The last sample that may be outside the band of the settled response.
    pub(crate) settled_from: usize,
    surely_outside: usize,
    /// Samples whose uncertainty matters to the crossings of the rise, ascending, and the last.
    pub(crate) of_rise: Vec<usize>,
}

impl Windows {
    /// The windows of a curve of positive gain and its standard deviations.
    pub(crate) fn new(curve: &[f64], sd: &[f64]) -> Self {
        let last = curve.len() - 1;
        let gain = curve[last];
        // Each level is a share of the gain, which is itself uncertain.
        let margin = |m: usize| SURE * (sd[m] + sd[last]);
        let first = |from: usize, test: &dyn Fn(usize) -> bool| {
            (from..last).find(|&m| test(m)).unwrap_or(last)
        };
        let half_from = first(0, &|m| curve[m] + margin(m) >= LEVELS.half * gain);
        let half_to = first(half_from, &|m| curve[m] - margin(m) >= LEVELS.half * gain);
        let early_from = (0..half_from)
            .rfind(|&m| curve[m] + margin(m) < LEVELS.delay * gain)
            .unwrap_or(0);
        let late_to = first(half_to, &|m| curve[m] - margin(m) >= LEVELS.ninety * gain);
        let top = (0..last)
            .map(|m| curve[m] - margin(m))
            .fold(f64::NEG_INFINITY, f64::max);
        let could_be_top = |m: &usize| curve[*m] + margin(*m) >= top;
        let peak = (0..last).find(could_be_top).unwrap_or(0)
            ..(0..last).rfind(could_be_top).map_or(0, |m| m + 1);
        let outside = |m: usize| (curve[m] - gain).abs() - SETTLED * gain;
        let settled_from = (0..last)
            .rfind(|&m| outside(m) + margin(m) > 0.0)
            .unwrap_or(0);
        let surely_outside = (0..last)
            .rfind(|&m| outside(m) - margin(m) > 0.0)
            .unwrap_or(0);
        let near = |m: usize, level: f64| (curve[m] - level * gain).abs() <= margin(m);
        let matters = |&m: &usize| {
            let crossed_next =
                |level: f64| m < last && (curve[m] < level * gain) != (curve[m + 1] < level * gain);
            [LEVELS.delay, LEVELS.tenth, LEVELS.half, LEVELS.ninety]
                .iter()
                .any(|&level| near(m, level) || crossed_next(level))
        };
        Self {
            half_from,
            peak,
            settled_from,
            surely_outside,
            of_rise: with_neighbours((early_from..=late_to).filter(matters), last),
        }
    }

    /// Samples whose uncertainty matters to the settling, ascending, and the last.
    pub(crate) fn of_settling(&self, last: usize) -> Vec<usize> {
        with_neighbours(self.surely_outside..=self.settled_from, last)
    }

    /// Samples that can be the highest.
    pub(crate) fn tops(&self) -> usize {
        self.peak.len().max(1)
    }

    /// Samples that can be the last outside the band of the settled response.
    pub(crate) fn doubtful(&self) -> usize {
        self.settled_from - self.surely_outside + 1
    }

    /// Reads a curve whose surely known samples are those of the curve that the windows are for.
    pub(crate) fn read(&self, curve: &[f64]) -> Shape {
        let gain = curve[curve.len() - 1];
        if gain <= 0.0 {
            return Shape {
                gain,
                crossings: Crossings::NONE,
                overshoot: f64::INFINITY,
                settling: f64::INFINITY,
            };
        }
        Shape {
            gain,
            crossings: self.crossings(curve),
            overshoot: (self.top(curve) / gain - 1.0).max(0.0),
            settling: self.settling(curve),
        }
    }

    /// Reads the crossings of the rise alone.
    pub(crate) fn crossings(&self, curve: &[f64]) -> Crossings {
        let last = curve.len() - 1;
        let gain = curve[last];
        let reached = |from: usize, level: f64| (from..last).find(|&m| curve[m] >= level * gain);
        let Some(half) = reached(self.half_from, LEVELS.half).filter(|_| gain > 0.0) else {
            return Crossings::NONE;
        };
        let early = |level: f64| {
            let below = (0..half).rfind(|&m| curve[m] < level * gain);
            crossing_before(curve, below.map_or(0, |m| m + 1), level * gain)
        };
        let late = reached(half, LEVELS.ninety);
        Crossings {
            delay: early(LEVELS.delay),
            tenth: early(LEVELS.tenth),
            half: crossing_before(curve, half, LEVELS.half * gain),
            ninety: late.map_or(f64::INFINITY, |late| {
                crossing_before(curve, late, LEVELS.ninety * gain)
            }),
        }
    }

    /// The highest value before the last, between samples by a parabola.
    fn top(&self, curve: &[f64]) -> f64 {
        let last = curve.len() - 1;
        let Some(m) = self
            .peak
            .clone()
            .max_by(|&a, &b| curve[a].total_cmp(&curve[b]))
        else {
            return f64::NEG_INFINITY;
        };
        curve[m] + bump(curve, m, last)
    }

    /// Reads the settling alone.
    pub(crate) fn settling(&self, curve: &[f64]) -> f64 {
        let last = curve.len() - 1;
        let gain = curve[last];
        if gain <= 0.0 {
            return f64::INFINITY;
        }
        let outside = |m: &usize| (curve[*m] - gain).abs() > SETTLED * gain;
        match (0..=self.settled_from).rfind(outside) {
            None => 0.0,
            Some(m) if m + 2 >= last => f64::INFINITY,
            Some(m) => {
                let side = (curve[m] - gain).signum();
                crossing_before(curve, m + 1, gain * (1.0 + side * SETTLED))
            }
        }
    }
}

/// The samples `wanted` and, because a cubic between two samples uses one more on each side, those
/// next to them; and the last.
fn with_neighbours(wanted: impl Iterator<Item = usize>, last: usize) -> Vec<usize> {
    let mut marked = vec![false; last + 1];
    for m in wanted {
        marked[m.saturating_sub(2)..=(m + 2).min(last)].fill(true);
    }
    marked[last] = true;
    (0..=last).filter(|&m| marked[m]).collect()
}

/// How much a parabola through sample `m` and its neighbours rises above it.
pub(crate) fn bump(curve: &[f64], m: usize, last: usize) -> f64 {
    if m == 0 || m + 1 >= last {
        return 0.0;
    }
    let (before, after) = (curve[m] - curve[m - 1], curve[m] - curve[m + 1]);
    let bend = before + after;
    if before < 0.0 || after < 0.0 || bend <= 0.0 {
        return 0.0;
    }
    (before - after).powi(2) / (8.0 * bend)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    /// A second-order response that starts between samples, and its last value.
    pub(crate) fn response(zeta: f64) -> Vec<f64> {
        let (omega, delay, period) = (60.0, 0.0255, 0.002);
        let damped = omega * (1.0f64 - zeta * zeta).sqrt();
        let mut curve: Vec<f64> = (0..150)
            .map(|m| {
                let t = (f64::from(m) * period - delay).max(0.0);
                let (sin, cos) = (damped * t).sin_cos();
                1.0 - (-zeta * omega * t).exp() * (cos + zeta * omega / damped * sin)
            })
            .collect();
        curve.push(1.0);
        curve
    }

    #[test]
    fn the_figures_of_a_known_response_are_found_between_samples() {
        let curve = response(0.5);
        let shape = Windows::new(&curve, &vec![1e-9; curve.len()]).read(&curve);
        // Peak exp(-πζ/sqrt(1-ζ²)); a parabola through three samples 2 ms apart leaves 1e-5.
        assert_abs_diff_eq!(shape.overshoot, 0.163_034, epsilon = 3e-5);
        // Crossings of the formula, found by bisection to nine digits [ms]: 5 % is near the kink at the start of the
        // motion, where a cubic is least at home.
        let exact = |level: f64| {
            let (mut low, mut high) = (0.0, 0.05);
            for _ in 0..60 {
                let t = f64::midpoint(low, high);
                let damped = 60.0 * 0.75f64.sqrt();
                let (sin, cos) = (damped * t).sin_cos();
                let g = 1.0 - (-30.0 * t).exp() * (cos + 30.0 / damped * sin);
                if g < level { low = t } else { high = t }
            }
            (low + 0.0255) / 0.002
        };
        assert_abs_diff_eq!(shape.crossings.delay, exact(0.05), epsilon = 5e-3);
        assert_abs_diff_eq!(shape.crossings.tenth, exact(0.1), epsilon = 5e-4);
        assert_abs_diff_eq!(shape.crossings.half, exact(0.5), epsilon = 5e-4);
        assert_abs_diff_eq!(shape.crossings.ninety, exact(0.9), epsilon = 5e-4);
    }

    #[test]
    fn windows_hold_every_sample_that_can_matter() {
        let curve = response(0.5);
        let sd = vec![0.001; curve.len()];
        let windows = Windows::new(&curve, &sd);
        let all = Windows {
            half_from: 0,
            peak: 0..curve.len() - 1,
            settled_from: curve.len() - 2,
            surely_outside: 0,
            of_rise: (0..curve.len()).collect(),
        };
        let last = curve.len() - 1;
        let matter = [windows.of_rise.clone(), windows.of_settling(last)].concat();
        // Disturb only samples that matter: reading everything must not find anything else.
        for seed in 0..200 {
            let mut disturbed = curve.clone();
            for &m in &matter {
                disturbed[m] += 0.002 * (f64::from(seed) * 1.7 + m as f64 * 2.3).sin();
            }
            assert_eq!(windows.read(&disturbed), all.read(&disturbed));
        }
        assert!(matter.len() < curve.len() / 2);
    }

    #[test]
    fn what_the_curve_does_not_have_is_infinite() {
        let never: Vec<f64> = (0..50).map(|m| f64::from(m) / 400.0).chain([1.0]).collect();
        let shape = Windows::new(&never, &[0.001; 51]).read(&never);
        assert_eq!(shape.crossings.half, f64::INFINITY);
        assert_eq!(shape.settling, f64::INFINITY);
        assert_eq!(shape.crossings.rise(), f64::INFINITY);
        assert_eq!(shape.overshoot, 0.0);
    }
}
