//! The metrics of a step response with their intervals.

use super::brackets::Brackets;
use super::crossings_and_peak::{AtLevels, Crossings, LEVELS, SETTLED, Shape, Windows};
use super::draws;
use super::interpolation::{coarseness, interpolation_errors};
use super::interval::Interval;
use super::inversion::{Known, Level, SureCrossing};
use super::measured::Measured;
use super::peak::rise_above_sample;
use super::rise::RiseIntervals;
use super::sample_uncertainty::{Joint, SampleSpread};
use crate::numerics::{normal_upper_quantile, pointwise_critical};

/// A step response, turned so that its gain is positive, and its metrics. Times in samples.
pub(crate) struct StepMetrics<'a> {
    curve: Vec<f64>,
    spread: &'a SampleSpread<'a>,
    windows: Windows,
    nominal: Shape,
    level: f64,
    /// Of every sample but the last.
    bias: f64,
    /// Of the final value.
    gain_bias: f64,
}

impl<'a> StepMetrics<'a> {
    pub(crate) fn new(measured: &Measured<'_>, spread: &'a SampleSpread<'a>) -> Self {
        let step = measured.step;
        let sign = step[step.len() - 1].signum();
        let curve: Vec<f64> = step.iter().map(|value| sign * value).collect();
        let windows = Windows::new(&curve, &spread.sd);
        Self {
            nominal: windows.read(&curve),
            windows,
            curve,
            spread,
            level: measured.level(),
            bias: measured.step_bounds.bias(),
            gain_bias: measured.bias_at(0.0),
        }
    }

    /// The crossings, widened by what left-out frequencies and rounding may move them by and by what interpolation
    /// between samples may be wrong by.
    pub(crate) fn rise(&self) -> RiseIntervals {
        let noise = self.rise_from_noise();
        let (nominal, moved) = (self.nominal.crossings, self.moved_by_bias());
        // Most negative and most positive change of a crossing. One that is not there has no interval to widen.
        let bias = |crossing: fn(&Crossings) -> f64| {
            let at = crossing(&nominal);
            let [up, down] = moved.map(|moved| crossing(&moved) - at);
            match at.is_finite() {
                true => (up.min(down).min(0.0), up.max(down).max(0.0)),
                false => (0.0, 0.0),
            }
        };
        let between = interpolation_errors(&self.curve, &self.nominal);
        let moved = |interval: Interval, (first, last): (f64, f64)| interval.reaching(-first, last);
        let also = |interval: Interval, error: f64| interval.reaching(error, error);
        let (early, late) = (bias(|c| c.tenth), bias(|c| c.ninety));
        let rise = moved(noise.rise, (late.0 - early.1, late.1 - early.0));
        RiseIntervals {
            delay: also(moved(noise.delay, bias(|c| c.delay)), between.delay),
            half: also(moved(noise.half, bias(|c| c.half)), between.half),
            rise: also(rise, between.tenth + between.ninety),
        }
    }

    /// The crossings as the noise alone leaves them open: by inversion where the curve surely rises
    /// through its levels, by draws elsewhere.
    fn rise_from_noise(&self) -> RiseIntervals {
        let joint = Joint::new(self.spread, self.windows.of_rise.clone());
        let value = self.nominal.crossings;
        let sure = sure_rise(&self.known(&joint), &value, pointwise_critical(self.level));
        let inverted = |crossing: &Option<SureCrossing>| {
            crossing.map(|x| Interval::new(x.value, x.lower, x.upper))
        };
        let rise = match (&sure.tenth, &sure.ninety) {
            (Some(tenth), Some(ninety)) => self
                .known(&joint)
                .between(tenth, ninety)
                .map(|(lower, upper)| Interval::new(value.rise(), lower, upper)),
            _ => None,
        };
        if let (Some(delay), Some(half), Some(rise)) =
            (inverted(&sure.delay), inverted(&sure.half), rise)
        {
            return RiseIntervals { delay, half, rise };
        }
        let read = |curve: &[f64]| {
            let drawn = self.windows.crossings(curve);
            [drawn.delay, drawn.half, drawn.rise()]
        };
        let [delays, halves, rises] = draws::of_curve(&self.curve, &joint, self.level, read);
        let drawn = |value: f64, draws: Vec<f64>| draws::interval_of(value, draws, self.level);
        let found = RiseIntervals {
            delay: inverted(&sure.delay).unwrap_or_else(|| drawn(value.delay, delays)),
            half: inverted(&sure.half).unwrap_or_else(|| drawn(value.half, halves)),
            rise: rise.unwrap_or_else(|| drawn(value.rise(), rises)),
        };
        let Critical { one, all } = Critical::new(self.level, self.curve.len());
        let brackets = Brackets {
            curve: &self.curve,
            spread: self.spread,
            one,
            all,
        };
        if brackets.are_needed(&self.windows.of_rise) {
            brackets.intervals(&found)
        } else {
            found
        }
    }

    fn known<'b>(&'b self, joint: &'b Joint) -> Known<'b> {
        Known {
            curve: &self.curve,
            spread: self.spread,
            joint,
        }
    }

    /// The crossings when the whole response is off by its bound to either side, and its final value the other way
    /// by its own.
    fn moved_by_bias(&self) -> [Crossings; 2] {
        if self.bias <= 0.0 {
            return [self.nominal.crossings; 2];
        }
        let last = self.curve.len() - 1;
        [1.0, -1.0].map(|side| {
            let shifted: Vec<f64> = self.curve[..last]
                .iter()
                .map(|value| value + side * self.bias)
                .chain([self.curve[last] - side * self.gain_bias])
                .collect();
            Windows::new(&shifted, &self.spread.sd).crossings(&shifted)
        })
    }

    /// Highest point above the final value, relative to it.
    pub(crate) fn overshoot(&self) -> Interval {
        let last = self.curve.len() - 1;
        let gain = self.curve[last];
        let value = self.nominal.overshoot;
        let peak = (0..last)
            .max_by(|&a, &b| self.curve[a].total_cmp(&self.curve[b]))
            .unwrap_or(0);
        let bias = (self.bias + (1.0 + value) * self.gain_bias) / gain;
        let critical = Critical::new(self.level, self.windows.tops());
        let edge = |factor: f64, side: f64| {
            (0..last)
                .map(|m| self.curve[m] - gain + side * factor * self.spread.sd_over(m, 1.0))
                .fold(f64::NEG_INFINITY, f64::max)
                / gain
        };
        let rise = self.nominal.crossings.rise();
        let between = rise_above_sample(&self.curve, peak, rise) / gain;
        Interval::new(
            value,
            (edge(critical.all, -1.0) - bias).max(0.0),
            (edge(critical.one, 1.0) + between + bias).max(0.0),
        )
    }

    /// When the response last leaves its band.
    pub(crate) fn settling(&self) -> Interval {
        // Between samples the response may leave the band once more, or not come back where a line between them does.
        let between = coarseness(&self.nominal);
        self.settling_at_samples().reaching(between, between)
    }

    fn settling_at_samples(&self) -> Interval {
        let value = self.nominal.settling;
        let bracket = self.settling_bracket();
        if self.bias > 0.0 || !self.closes_in(&bracket) {
            return bracket;
        }
        let last = self.curve.len() - 1;
        let joint = Joint::new(self.spread, self.windows.of_settling(last));
        let critical = pointwise_critical(self.level);
        let known = self.known(&joint);
        let from = self.curve[value as usize] - self.curve[last];
        let edge = Level {
            share: 1.0 + from.signum() * SETTLED,
            side: -from.signum(),
        };
        let only = known
            .crossing(value, edge, critical)
            .filter(|crossing| self.windows.settled_from <= crossing.stretch.1);
        if let Some(only) = only {
            return Interval::new(value, only.lower, only.upper);
        }
        let read = |curve: &[f64]| [self.windows.settling(curve)];
        let [drawn] = draws::of_curve(&self.curve, &joint, self.level, read);
        draws::interval_of(value, drawn, self.level)
    }

    /// The bracket of samples of the settling (see [`crate::results::metrics`]).
    fn settling_bracket(&self) -> Interval {
        let last = self.curve.len() - 1;
        let gain = self.curve[last];
        let critical = Critical::new(self.level, self.windows.doubtful());
        let last_with = |factor: f64| {
            (0..last).rfind(|&m| {
                [1.0, -1.0].iter().any(|side| {
                    let edge = 1.0 + side * SETTLED;
                    let over = side * (self.curve[m] - edge * gain);
                    let bias = factor.signum() * (self.bias + edge * self.gain_bias);
                    over + factor * self.spread.sd_over(m, edge) + bias > 0.0
                })
            })
        };
        let lower = last_with(-critical.all).map_or(0.0, |m| m as f64);
        let upper = match last_with(critical.one) {
            None => 0.0,
            Some(m) if m + 2 >= last => f64::INFINITY,
            Some(m) => (m + 1) as f64,
        };
        Interval::new(self.nominal.settling, lower, upper)
    }

    /// Whether a single crossing can be the last one: the response closes in on its final value
    /// over the whole bracket.
    fn closes_in(&self, bracket: &Interval) -> bool {
        let (Some(value), Some(lower), Some(upper)) = (bracket.value, bracket.lower, bracket.upper)
        else {
            return false;
        };
        let last = self.curve.len() - 1;
        let away = |m: usize| (self.curve[m] - self.curve[last]).abs();
        value > 0.0 && (lower as usize..upper as usize).all(|m| away(m + 1) < away(m))
    }
}

/// The crossings of the rise at `value`, where each is the only one there can be.
fn sure_rise(
    known: &Known<'_>,
    value: &Crossings,
    critical: f64,
) -> AtLevels<Option<SureCrossing>> {
    let crossing = |value: f64, share: f64| known.crossing(value, Level::rising(share), critical);
    let all = |mut range: std::ops::Range<usize>, share: f64, side: f64| {
        range.all(|m| known.surely(m, Level::rising(share), side))
    };
    // Half is reached for the first time: nothing before may reach it.
    let half = crossing(value.half, LEVELS.half).filter(|x| all(0..x.stretch.0, LEVELS.half, -1.0));
    // The early levels are passed for the last time before it: nothing between may be below.
    let early = |value: f64, share: f64| {
        let half = half?;
        crossing(value, share).filter(|x| all(x.stretch.1..half.stretch.1, share, 1.0))
    };
    AtLevels {
        delay: early(value.delay, LEVELS.delay),
        tenth: early(value.tenth, LEVELS.tenth),
        half,
        // The late level is reached for the first time after it.
        ninety: half.and_then(|half| {
            crossing(value.ninety, LEVELS.ninety)
                .filter(|x| all(half.stretch.0..x.stretch.0, LEVELS.ninety, -1.0))
        }),
    }
}

/// Critical values of one sample, and of as many as there are.
struct Critical {
    one: f64,
    all: f64,
}

impl Critical {
    /// Each end of the interval may be wrong with half of 1 - `level`.
    fn new(level: f64, samples: usize) -> Self {
        let tail = (1.0 - level) / 2.0;
        Self {
            one: normal_upper_quantile(tail),
            all: normal_upper_quantile(tail / samples as f64),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::Model;
    use crate::{Options, Record, Settling, identify};
    use approx::assert_abs_diff_eq;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// A servo of second order (60 rad/s, damping 0.5, six samples of dead time) under noise.
    fn model() -> Model {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let (mut position, mut speed) = (0.0, 0.0);
        let input: Vec<f64> = (0..3000)
            .map(|k| f64::from(k * k / 5000 % 2) * 10.0)
            .collect();
        let output: Vec<f64> = (0..3000usize)
            .map(|k| {
                let before = position;
                for _ in 0..20 {
                    speed +=
                        1e-4 * (3600.0 * (input[k.saturating_sub(6)] - position) - 60.0 * speed);
                    position += 1e-4 * speed;
                }
                before + 0.2 * (random.random::<f64>() - 0.5)
            })
            .collect();
        let options = Options {
            settling: Settling::Samples(151),
            ..Options::default()
        };
        identify(&Record::of_run(0.002, &input, &output).unwrap(), &options).unwrap()
    }

    #[test]
    fn sure_crossings_have_the_intervals_that_draws_have() {
        let model = model();
        let measured = model.measured().unwrap().into_valid().unwrap();
        let spread = SampleSpread::new(&measured);
        let metrics = StepMetrics::new(&measured, &spread);
        let joint = Joint::new(&spread, metrics.windows.of_rise.clone());
        let value = metrics.nominal.crossings;
        let sure = sure_rise(&metrics.known(&joint), &value, pointwise_critical(0.99));
        assert!(sure.delay.is_some() && sure.half.is_some());
        assert!(sure.tenth.is_some() && sure.ninety.is_some());
        let read = |curve: &[f64]| {
            let drawn = metrics.windows.crossings(curve);
            [drawn.delay, drawn.half, drawn.rise()]
        };
        let drawn = draws::of_curve(&metrics.curve, &joint, 0.99, read);
        let exact = metrics.rise_from_noise();
        for ((exact, draws), value) in [exact.delay, exact.half, exact.rise]
            .into_iter()
            .zip(drawn)
            .zip([value.delay, value.half, value.rise()])
        {
            let drawn = draws::interval_of(value, draws, 0.99);
            // A quantile with 25 draws beyond it is known to about 8 % of its distance from the
            // middle; three of them.
            let slack = 0.12 * (exact.upper.unwrap() - exact.lower.unwrap());
            assert_abs_diff_eq!(exact.lower.unwrap(), drawn.lower.unwrap(), epsilon = slack);
            assert_abs_diff_eq!(exact.upper.unwrap(), drawn.upper.unwrap(), epsilon = slack);
        }
    }
}
