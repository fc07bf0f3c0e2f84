//! Gain, delay, rise time and the like, read off the responses, each with its interval.
//!
//! They are those of the servo, not of its samples: times count from the edge of the command
//! (see [`crate::data::timing`]), crossings between samples are interpolated by cubics, and magnitude and
//! phase are freed of the hold of the samples.
//!
//! # Intervals
//!
//! * **Gain and phase**: the bound of the response itself (Student's, Fieller's).
//! * **Crossing times, bandwidth, -90 degrees**: the places at which the response may be passing its
//!   level, Student's t included (Fieller 1954). Where the response does not surely rise through the
//!   level, so that several samples may be the one, quantiles over seeded draws of the response from
//!   the covariance of its fit; they are the same where both can be had. What interpolation between
//!   samples may be wrong by is added to the crossing times. Where single samples are known to no better
//!   than a twentieth of the final value, draws are as rough as the estimate that they start from, and miss;
//!   a bracket joins them: from where a sample may be beyond the level to where one surely is.
//! * **Overshoot**, which cannot be negative and is a maximum over noisy samples, and **settling**,
//!   which jumps when a peak enters its band, are not smooth: draws miss the truth there. A bracket
//!   takes their place. With z_1 the critical value of one sample and z_k that of all k samples that
//!   can be the one sought (Bonferroni), v_m the response over its edge and s_m its standard
//!   deviation,
//!
//! ```text
//! overshoot  from max(0, max_m (v_m - z_k s_m))          to max(0, max_m (v_m + z_1 s_m))
//! settling   from the last m with v_m - z_k s_m > 0      to one after the last with v_m + z_1 s_m > 0
//! ```
//!
//!   The upper ends need no more than z_1, because only one sample can make them wrong: the true
//!   peak, and the last sample truly outside. Overshoot is that of the motion between the samples, too: what it may rise above the
//!   highest sample is added to the upper end. Where the response closes in on its final value over
//!   the whole bracket, only one crossing can be the last, and its interval is the sharper answer.
//!
//! The bounds of what left-out frequencies may hide, and of what the steps of a sensor add, are in all of them.

mod aliasing;
mod brackets;
mod crossing;
mod crossings_and_peak;
mod draws;
pub(crate) mod frequency_metrics;
pub(crate) mod in_band;
mod interpolation;
pub(crate) mod interval;
mod inversion;
pub(crate) mod measured;
mod peak;
mod rise;
pub(crate) mod sample_uncertainty;
mod step_metrics;

use serde::{Deserialize, Serialize};

use crate::options::LEVELS;
use crate::results::frequency_response::FrequencyResponse;
use crate::results::validity::{Bounds, Reason};

use measured::Measured;
use sample_uncertainty::SampleSpread;
use step_metrics::StepMetrics;

pub use interval::Interval;

/// Why metrics are left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Withheld {
    /// All but the gain: times are not what they are taken for.
    TimeFault,
    /// All of them: the servo is slower than the record can show.
    ResponseNotOver,
    /// All of them: they rest on frequencies that the input does not excite.
    InputUnexcited,
    /// All but the interval of the gain, if there is one: they rest on frequencies that were left out.
    FrequenciesLeftOut,
    /// All but the gain, if that: plain and generalised least squares give different ones.
    EstimatorsDisagree,
    /// All but the interval of the gain, if there is one: they are relative to it, and it may be zero.
    GainMayBeZero,
}

impl Withheld {
    /// The reason in a few words, for beside a number.
    #[must_use]
    pub fn because(self) -> &'static str {
        match self {
            Self::TimeFault => "times of this recording are not what they seem",
            Self::ResponseNotOver => "the servo is slower than this recording can show",
            Self::InputUnexcited => "the reference does not excite what they rest on",
            Self::FrequenciesLeftOut => "they rest on frequencies that were left out",
            Self::EstimatorsDisagree => "two ways to estimate them disagree",
            Self::GainMayBeZero => "the gain may be zero",
        }
    }
}

/// The level of the intervals of metrics.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MetricBounds {
    /// Confidence level.
    pub level: f64,
}

/// Metrics of the responses. Where their bounds are withdrawn, intervals have a value alone.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Metrics {
    /// Final value of the step response \[output per input\].
    pub dc_gain: Interval,
    /// From 10 to 90 % of the final value \[s\].
    pub rise_time_s: Interval,
    /// From the edge until the response stays within 2 % of the final value \[s\]. Without an upper
    /// bound the response may settle later than the model can see.
    pub settling_time_s: Interval,
    /// Highest point above the final value \[% of it\].
    pub overshoot_percent: Interval,
    /// From the edge until 5 % of the final value \[s\]: the last such crossing before half of it,
    /// so that noise on the flat part before does not count.
    pub delay_s: Interval,
    /// From the edge until half of the final value \[s\].
    #[serde(default)]
    pub t50_s: Interval,
    /// Where the magnitude of the servo has fallen by 3 dB from its value at rest \[rad/s\].
    pub bandwidth_rad_s: Interval,
    /// Where the phase of the servo reaches -90 degrees \[rad/s\].
    #[serde(default)]
    pub phase_minus_90_rad_s: Interval,
    /// Why metrics are left out, where they are.
    pub withheld: Option<Withheld>,
    /// The level of the intervals, where they hold.
    #[serde(flatten)]
    pub bounds: Bounds<MetricBounds>,
}

/// Why a gain may be zero whose interval allows `left_out` for frequencies that were left out: they alone are no doubt about the gain, but about
/// all that is read off the step response.
fn why_unknown(gain: Interval, left_out: f64) -> Withheld {
    let by_noise = Interval {
        lower: gain.lower.map(|lower| lower + left_out),
        upper: gain.upper.map(|upper| upper - left_out),
        ..gain
    };
    match by_noise.contains(0.0) {
        true => Withheld::GainMayBeZero,
        false => Withheld::FrequenciesLeftOut,
    }
}

impl Metrics {
    /// Why some are left out, in a few words; `None` where none are.
    #[must_use]
    pub fn why_withheld(&self) -> Option<&'static str> {
        Some(match (self.withheld?, self.bounds.withdrawn()) {
            // Its value may look as good as any; only how far it may be off does not.
            (Withheld::GainMayBeZero, Some(_)) => {
                "the linear model does not determine the gain, which they are shares of"
            }
            (reason, _) => reason.because(),
        })
    }

    /// Reads them off. Where `bounds` are withdrawn, intervals keep their value alone.
    pub(crate) fn new(measured: &Measured<'_>, bounds: Bounds<MetricBounds>) -> Self {
        let metrics = Self::of_response(measured, bounds);
        match bounds.withdrawn() {
            Some(reason) => metrics.withdrawn(reason),
            None => metrics,
        }
    }

    fn of_response(measured: &Measured<'_>, bounds: Bounds<MetricBounds>) -> Self {
        let step = measured.step;
        let last = step.len() - 1;
        let pointwise = &measured.step_bounds.pointwise;
        let dc_gain = Interval::new(step[last], pointwise.lower[last], pointwise.upper[last]);
        // Everything else is relative to a gain, and there is none if it may be zero.
        if dc_gain.contains(0.0) {
            let left_out = measured.step_bounds.truncation_bias;
            return Self::withheld(dc_gain, why_unknown(dc_gain, left_out), bounds);
        }
        let spread = SampleSpread::new(measured);
        let of_step = StepMetrics::new(measured, &spread);
        let rise = of_step.rise();
        let [bandwidth_rad_s, phase_minus_90_rad_s] =
            frequency_metrics::bandwidth_and_quarter_turn(measured, spread.widest());
        // No response comes before its edge, even if an interval is wide.
        let since_edge = |samples: f64| measured.timing.seconds(samples).max(0.0);
        Self {
            dc_gain,
            rise_time_s: rise
                .rise
                .map(|samples| (samples * measured.timing.sample_period_s).max(0.0)),
            settling_time_s: of_step.settling().map(since_edge),
            overshoot_percent: of_step.overshoot().map(|share| 100.0 * share),
            delay_s: rise.delay.map(since_edge),
            t50_s: rise.half.map(since_edge),
            bandwidth_rad_s,
            phase_minus_90_rad_s,
            withheld: None,
            bounds,
        }
    }

    /// Nothing but the gain, if that.
    pub(crate) fn withheld(
        dc_gain: Interval,
        reason: Withheld,
        bounds: Bounds<MetricBounds>,
    ) -> Self {
        let none = Interval::default();
        Self {
            dc_gain,
            rise_time_s: none,
            settling_time_s: none,
            overshoot_percent: none,
            delay_s: none,
            t50_s: none,
            bandwidth_rad_s: none,
            phase_minus_90_rad_s: none,
            withheld: Some(reason),
            bounds,
        }
    }

    /// All metrics by the names of their fields.
    pub(crate) fn named(&self) -> [(&'static str, Interval); 8] {
        [
            ("dc_gain", self.dc_gain),
            ("delay_s", self.delay_s),
            ("t50_s", self.t50_s),
            ("rise_time_s", self.rise_time_s),
            ("overshoot_percent", self.overshoot_percent),
            ("settling_time_s", self.settling_time_s),
            ("bandwidth_rad_s", self.bandwidth_rad_s),
            ("phase_minus_90_rad_s", self.phase_minus_90_rad_s),
        ]
    }

    /// The same with intervals of times and frequencies that allow for a clock whose frequency is off by a share
    /// between `slow` (negative) and `fast`. The time between two samples is then longer or shorter than it is taken
    /// for, and so is every time.
    #[must_use]
    pub fn with_clock_error(mut self, slow: f64, fast: f64) -> Self {
        let widened = |interval: Interval, least: f64, most: f64| Interval {
            lower: interval.lower.map(|lower| lower * least),
            upper: interval.upper.map(|upper| upper * most),
            ..interval
        };
        for time in [
            &mut self.rise_time_s,
            &mut self.settling_time_s,
            &mut self.delay_s,
            &mut self.t50_s,
        ] {
            *time = widened(*time, 1.0 / (1.0 + fast), 1.0 / (1.0 + slow));
        }
        for frequency in [&mut self.bandwidth_rad_s, &mut self.phase_minus_90_rad_s] {
            *frequency = widened(*frequency, 1.0 + slow, 1.0 + fast);
        }
        self
    }

    /// The same with intervals that allow for output that was recorded up to `seconds` earlier or later than it is taken for: of the
    /// times from the edge, and of the frequency of a phase. `response` is that of the servo.
    #[must_use]
    pub fn with_delay_error(mut self, seconds: f64, response: &FrequencyResponse) -> Self {
        for time in self.times_from_edge() {
            *time = time.widened(seconds);
        }
        let [least, most] = quarter_turn_within(response, seconds);
        let frequency = &mut self.phase_minus_90_rad_s;
        frequency.lower = frequency.lower.zip(least).map(|(lower, by)| lower * by);
        frequency.upper = frequency.upper.zip(most).map(|(upper, by)| upper * by);
        self
    }

    /// What [`Metrics::with_delay_error`] has made wider, without it. A time whose lower bound is zero keeps that.
    pub(crate) fn without_delay_error(
        mut self,
        seconds: f64,
        response: &FrequencyResponse,
    ) -> Self {
        for time in self.times_from_edge() {
            let value = time.value.unwrap_or(f64::INFINITY);
            let nearer = |lower: f64| (lower + seconds).min(value);
            time.lower = (time.lower).map(|lower| if lower > 0.0 { nearer(lower) } else { lower });
            time.upper = time.upper.map(|upper| upper - seconds);
        }
        let [least, most] = quarter_turn_within(response, seconds);
        let frequency = &mut self.phase_minus_90_rad_s;
        frequency.lower = frequency.lower.zip(least).map(|(lower, by)| lower / by);
        frequency.upper = frequency.upper.zip(most).map(|(upper, by)| upper / by);
        self
    }

    fn times_from_edge(&mut self) -> [&mut Interval; 3] {
        [
            &mut self.settling_time_s,
            &mut self.delay_s,
            &mut self.t50_s,
        ]
    }

    /// The values without their bounds. A gain that may be zero has none: only its interval says how little is known of it.
    pub(crate) fn withdrawn(mut self, reason: Reason) -> Self {
        if let Some(Withheld::GainMayBeZero | Withheld::FrequenciesLeftOut) = self.withheld {
            self.dc_gain = Interval::default();
        }
        for interval in [
            &mut self.dc_gain,
            &mut self.rise_time_s,
            &mut self.settling_time_s,
            &mut self.overshoot_percent,
            &mut self.delay_s,
            &mut self.t50_s,
            &mut self.bandwidth_rad_s,
            &mut self.phase_minus_90_rad_s,
        ] {
            (interval.lower, interval.upper) = (None, None);
        }
        self.bounds = Bounds::Withdrawn(reason);
        self
    }

    /// Whether intervals have bounds only where the document has bounds.
    pub(super) fn is_consistent(&self) -> bool {
        let has_bounds =
            |(_, interval): (&str, Interval)| interval.lower.or(interval.upper).is_some();
        match self.bounds {
            Bounds::Valid(bounds) => LEVELS.contains(&bounds.level),
            Bounds::Withdrawn(_) => !self.named().into_iter().any(has_bounds),
        }
    }
}

/// Where the phase of a response that comes `later_s` later first reaches -90 degrees \[rad/s\].
fn quarter_turn(response: &FrequencyResponse, later_s: f64) -> Option<f64> {
    let lag = |(omega, phase): (&f64, &f64)| (*omega, phase - (omega * later_s).to_degrees());
    let points = response.omega_rad_s.iter().zip(&response.phase_deg);
    let points: Vec<_> = points.map(lag).collect();
    points.windows(2).find_map(|pair| {
        let &[(omega, phase), (next_omega, next_phase)] = pair else {
            return None;
        };
        let share = (phase + 90.0) / (phase - next_phase);
        (phase > -90.0 && next_phase <= -90.0).then_some(omega + share * (next_omega - omega))
    })
}

/// The shares by which that frequency is lower for a response `seconds` later, and higher for one as much earlier. Without a crossing in the
/// response nothing says by how much it moves.
fn quarter_turn_within(response: &FrequencyResponse, seconds: f64) -> [Option<f64>; 2] {
    let moved = |later_s: f64| {
        let (to, from) = quarter_turn(response, later_s).zip(quarter_turn(response, 0.0))?;
        Some((to / from).abs())
    };
    [
        moved(seconds).map(|by| by.min(1.0)),
        moved(-seconds).map(|by| by.max(1.0)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_that_frequencies_left_out_alone_leave_open_is_not_doubted() {
        let gain = Interval::new(0.094, -0.001, 0.189);
        assert_eq!(why_unknown(gain, 0.094), Withheld::FrequenciesLeftOut);
        assert_eq!(why_unknown(gain, 0.0), Withheld::GainMayBeZero);
        let noisy = Interval::new(0.094, -0.1, 0.288);
        assert_eq!(why_unknown(noisy, 0.094), Withheld::GainMayBeZero);
    }

    #[test]
    fn without_its_interval_a_gain_that_may_be_zero_has_no_value() {
        let withdrawn = |why: Withheld| {
            let (gain, level) = (Interval::new(1.3, -0.1, 2.7), MetricBounds { level: 0.99 });
            let metrics = Metrics::withheld(gain, why, Bounds::Valid(level));
            metrics.withdrawn(Reason::ErrorsNotNoise).dc_gain.value
        };
        assert_eq!(withdrawn(Withheld::GainMayBeZero), None);
        assert_eq!(withdrawn(Withheld::FrequenciesLeftOut), None);
        assert_eq!(withdrawn(Withheld::EstimatorsDisagree), Some(1.3));
    }

    /// A delay of 10 ms and a lag of 20 ms: -90 degrees where ω 0.01 + atan(ω 0.02) is a quarter turn.
    #[test]
    fn a_delay_error_widens_times_from_the_edge_and_the_quarter_turn() {
        let omega_rad_s: Vec<f64> = (1..2_000).map(|k| 0.1 * f64::from(k)).collect();
        let phase = |omega: f64| -(omega * 0.01 + (omega * 0.02).atan()).to_degrees();
        let response = FrequencyResponse {
            re: Vec::new(),
            im: Vec::new(),
            magnitude_db: Vec::new(),
            phase_deg: omega_rad_s.iter().map(|&omega| phase(omega)).collect(),
            omega_rad_s,
            bounds: Bounds::Withdrawn(Reason::ErrorsNotNoise),
        };
        let quarter = quarter_turn(&response, 0.0).unwrap();
        assert!((phase(quarter) + 90.0).abs() < 1e-3, "{quarter}");
        let later = quarter_turn(&response, 0.001).unwrap();
        assert!((phase(later) - (later * 0.001).to_degrees() + 90.0).abs() < 1e-3);

        let mut metrics = Metrics::withheld(
            Interval::new(1.0, 0.9, 1.1),
            Withheld::GainMayBeZero,
            Bounds::Valid(MetricBounds { level: 0.99 }),
        );
        let time = Interval::new(0.03, 0.029, 0.031);
        (metrics.delay_s, metrics.rise_time_s) = (time, time);
        metrics.t50_s = Interval::new(0.001, 0.0005, 0.0015);
        metrics.phase_minus_90_rad_s = Interval::new(quarter, quarter - 1.0, quarter + 1.0);
        let widened = metrics.with_delay_error(0.001, &response);
        let close = |a: Option<f64>, b: f64| (a.unwrap() - b).abs() < 1e-12;
        assert!(close(widened.delay_s.lower, 0.028) && close(widened.delay_s.upper, 0.032));
        assert!(close(widened.t50_s.lower, 0.0) && close(widened.t50_s.upper, 0.0025));
        assert_eq!(
            (widened.rise_time_s, widened.dc_gain),
            (time, metrics.dc_gain)
        );
        let [lower, upper] = [-1.0, 1.0].map(|by| quarter + by);
        let moved = widened.phase_minus_90_rad_s;
        assert!(close(moved.lower, lower * later / quarter), "{moved:?}");
        assert!(moved.upper.unwrap() > upper);
        let back = widened.without_delay_error(0.001, &response);
        let (found, given) = (back.phase_minus_90_rad_s, metrics.phase_minus_90_rad_s);
        assert!(
            close(found.lower, given.lower.unwrap()) && close(found.upper, given.upper.unwrap())
        );
        assert!(close(back.delay_s.lower, 0.029) && close(back.delay_s.upper, 0.031));
        assert!(close(back.t50_s.lower, 0.0) && close(back.t50_s.upper, 0.0015));
    }

    /// A clock that is 2.5 % fast makes 2 ms last 1.951 ms; one that is 2 % slow, 2.041 ms.
    #[test]
    fn an_inexact_clock_widens_times_and_frequencies_and_nothing_else() {
        let one = Interval::new(1.0, 0.9, 1.1);
        let mut metrics = Metrics::withheld(
            one,
            Withheld::GainMayBeZero,
            Bounds::Valid(MetricBounds { level: 0.99 }),
        );
        (metrics.delay_s, metrics.bandwidth_rad_s) = (one, one);
        metrics.overshoot_percent = one;
        let widened = metrics.with_clock_error(-0.02, 0.025);
        let expected = Interval::new(1.0, 0.9 / 1.025, 1.1 / 0.98);
        assert_eq!(widened.delay_s, expected);
        let expected = Interval::new(1.0, 0.9 * 0.98, 1.1 * 1.025);
        assert_eq!(widened.bandwidth_rad_s, expected);
        assert_eq!((widened.dc_gain, widened.overshoot_percent), (one, one));
        assert_eq!(widened.rise_time_s, Interval::default());
    }
}
