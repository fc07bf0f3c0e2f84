//! A linear second-order servo with delay, computed exactly: the reference of tests.
//!
//! ```text
//!  G(s) = K ω² / (s² + 2 ζ ω s + ω²) e^(-L s)
//! ```
//!
//! Between two changes of the command the motion is known in closed form. So the only error is rounding, with any
//! delay. A missing pulse leaves the command unchanged.

use crate::delay_line::DelayLine;
use crate::servo::{SERVO_SCALE, Servo};
use servoid_protocol::PulseWidth;
use std::time::Duration;

/// Distance of ζ² from 1 below which the poles count as equal. There the two solutions differ by
/// about ζ²-1 relative, less than the cancellation error of the unequal one.
const EQUAL_POLES: f64 = 1e-9;

/// K, ζ, ω and L.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearParameters {
    /// Gain K (output degrees per commanded degree).
    pub gain: f64,
    /// Damping ratio ζ, above 0.
    pub damping: f64,
    /// Natural frequency ω (rad/s), above 0.
    pub natural_frequency: f64,
    /// Delay L.
    pub delay: Duration,
}

impl Default for LinearParameters {
    /// About as fast as the bench servo: K = 1, ζ = 0.5, ω = 60 rad/s, L = 21.5 ms.
    fn default() -> Self {
        Self {
            gain: 1.0,
            damping: 0.5,
            natural_frequency: 60.0,
            delay: Duration::from_micros(21_500),
        }
    }
}

impl LinearParameters {
    /// Output at time `t` (s) after a unit step of the command at time 0, from rest: the textbook's
    /// solution, exact.
    ///
    /// ```
    /// use servoid_simulator::linear::LinearParameters;
    /// let servo = LinearParameters::default();
    /// assert_eq!(servo.step_response(0.02), 0.0); // within the delay
    /// // The peak of an underdamped servo: 1 + e^(-πζ/√(1-ζ²)) at L + π/(ω√(1-ζ²)).
    /// let root = (1.0 - 0.5f64 * 0.5).sqrt();
    /// let peak = servo.step_response(0.0215 + std::f64::consts::PI / (60.0 * root));
    /// assert!((peak - (1.0 + (-std::f64::consts::PI * 0.5 / root).exp())).abs() < 1e-12);
    /// ```
    pub fn step_response(&self, t: f64) -> f64 {
        let t = t - self.delay.as_secs_f64();
        if t <= 0.0 {
            return 0.0;
        }
        let (w, z) = (self.natural_frequency, self.damping);
        let d = z * z - 1.0;
        let remainder = if d.abs() < EQUAL_POLES {
            (1.0 + w * t) * (-w * t).exp()
        } else if d < 0.0 {
            let root = (-d).sqrt();
            let (sin, cos) = (w * root * t).sin_cos();
            (-z * w * t).exp() * (cos + z / root * sin)
        } else {
            let root = d.sqrt();
            let (slow, fast) = (w * (z - root), w * (z + root));
            (fast * (-slow * t).exp() - slow * (-fast * t).exp()) / (fast - slow)
        };
        self.gain * (1.0 - remainder)
    }

    /// e^(A t) of y'' + 2 ζ ω y' + ω² y = 0 in (y, y'):
    ///
    /// ```text
    ///  e^(A t) = e^(-a t) (c I + s (A + a I)),   a = ζ ω
    ///  c, s    = cos βt, sin βt / β  |  1, t  |  cosh βt, sinh βt / β      β = ω √|ζ² - 1|
    /// ```
    fn transition(&self, t: f64) -> [[f64; 2]; 2] {
        let w = self.natural_frequency;
        let a = self.damping * w;
        let d = self.damping * self.damping - 1.0;
        let b = w * d.abs().sqrt();
        // c and s with the decay taken in, because cosh alone overflows.
        let (c, s) = if d.abs() < EQUAL_POLES {
            let decay = (-a * t).exp();
            (decay, decay * t)
        } else if d < 0.0 {
            let decay = (-a * t).exp();
            let (sin, cos) = (b * t).sin_cos();
            (decay * cos, decay * sin / b)
        } else {
            let (slow, fast) = (((b - a) * t).exp(), ((-b - a) * t).exp());
            ((slow + fast) / 2.0, (slow - fast) / (2.0 * b))
        };
        [[c + a * s, s], [-w * w * s, c - a * s]]
    }
}

/// A linear servo; see the module's text.
#[derive(Clone, Debug)]
pub struct LinearServo {
    parameters: LinearParameters,
    commands: DelayLine,
    /// K times the command in force (deg).
    target: f64,
    /// Output (deg) and its speed (deg/s) when that command came into force.
    state: [f64; 2],
    /// The time of that.
    since: Duration,
    /// The latest time asked for.
    latest: Duration,
}

impl LinearServo {
    /// A servo at rest at 0 degrees.
    pub fn new(parameters: LinearParameters) -> Self {
        Self {
            parameters,
            commands: DelayLine::new(parameters.delay),
            target: 0.0,
            state: [0.0; 2],
            since: Duration::ZERO,
            latest: Duration::ZERO,
        }
    }

    /// Output and speed at `at`, with the command in force.
    fn state_at(&self, at: Duration) -> [f64; 2] {
        let t = at.saturating_sub(self.since).as_secs_f64();
        let m = self.parameters.transition(t);
        let from = [self.state[0] - self.target, self.state[1]];
        [
            self.target + m[0][0] * from[0] + m[0][1] * from[1],
            m[1][0] * from[0] + m[1][1] * from[1],
        ]
    }
}

impl Servo for LinearServo {
    fn command(&mut self, at: Duration, pulse: Option<PulseWidth>) {
        self.commands.push(at, pulse);
    }

    fn angle(&mut self, at: Duration) -> f64 {
        self.latest = self.latest.max(at);
        while let Some((acts, pulse)) = self.commands.pop_due(self.latest) {
            let target = pulse.map_or(self.target, |p| {
                self.parameters.gain * SERVO_SCALE.degrees(p).0
            });
            // An equal pulse is skipped, which avoids its rounding.
            if target != self.target {
                self.state = self.state_at(acts);
                (self.target, self.since) = (target, acts.max(self.since));
            }
        }
        self.state_at(self.latest)[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cases() -> impl Iterator<Item = LinearParameters> {
        [0.05, 0.5, 0.9999, 1.0, 1.0001, 3.0]
            .into_iter()
            .flat_map(|damping| {
                // Whole samples, no multiple of anything, none.
                [20_000_000, 21_537_219, 0].map(|ns| LinearParameters {
                    gain: 0.93,
                    damping,
                    natural_frequency: 47.0,
                    delay: Duration::from_nanos(ns),
                })
            })
    }

    /// The textbook's solution obeys the differential equation: y'' by central differences.
    #[test]
    fn the_step_response_solves_the_equation() {
        for p in cases() {
            let h = 1e-4;
            let (w, z) = (p.natural_frequency, p.damping);
            for k in 1..100 {
                let t = p.delay.as_secs_f64() + 3e-3 * f64::from(k);
                let [before, y, after] = [t - h, t, t + h].map(|t| p.step_response(t));
                let speed = (after - before) / (2.0 * h);
                let acceleration = (after - 2.0 * y + before) / (h * h);
                let residual = acceleration + 2.0 * z * w * speed + w * w * (y - p.gain);
                // Differences err by h²/12 y'''' and h²/3 ζω y'''; derivatives of y are at most
                // (2ζω)^k: (282²/12·w² + 282·141/3·w²)·1e-8 < 2e-4 w². Rounding: 4e-16/h² = 4e-8.
                assert!(residual.abs() < 1e-3 * w * w, "{p:?} at {t}: {residual}");
            }
        }
    }

    /// One step: the stepper against the textbook, on samples and off them.
    #[test]
    fn one_step_is_the_step_response() {
        for p in cases() {
            let mut servo = LinearServo::new(p);
            servo.command(Duration::ZERO, Some(PulseWidth(1550)));
            for k in 0..500 {
                let at = Duration::from_nanos(1_003_001 * k);
                let error = servo.angle(at) - 5.0 * p.step_response(at.as_secs_f64());
                // Both are a few operations on numbers below 10; near ζ = 1 sine over root costs
                // up to 1/√|ζ²-1| = 70 roundings.
                assert!(error.abs() < 1e-12, "{p:?} at {at:?}: {error:e}");
            }
        }
    }

    /// Many steps: superposition of step responses, each from its own edge.
    #[test]
    fn a_staircase_is_a_sum_of_step_responses() {
        for p in cases() {
            let mut servo = LinearServo::new(p);
            let mut steps: Vec<(f64, f64)> = Vec::new(); // time (s), height (deg)
            let mut before = 0.0;
            for frame in 0..100u64 {
                let pulse = 1500 + (frame * frame * 7 % 11) as u16 * 10;
                let at = Duration::from_millis(20 * frame);
                servo.command(at, Some(PulseWidth(pulse)));
                let angle = SERVO_SCALE.degrees(PulseWidth(pulse)).0;
                steps.push((at.as_secs_f64(), angle - before));
                before = angle;
                for j in 0..10 {
                    let at = at + Duration::from_micros(500 + 2000 * j);
                    let exact: f64 = steps
                        .iter()
                        .map(|(start, height)| height * p.step_response(at.as_secs_f64() - start))
                        .sum();
                    let error = servo.angle(at) - exact;
                    // A sum of up to 100 terms below 10, and 1/√|ζ²-1| as above. Subtracting
                    // times near 2 s moves them by 4e-16 s, at speeds up to 47·10 deg/s.
                    assert!(error.abs() < 1e-11, "{p:?} at {at:?}: {error:e}");
                }
            }
        }
    }

    #[test]
    fn a_missing_pulse_leaves_the_command() {
        let mut servo = LinearServo::new(LinearParameters::default());
        servo.command(Duration::ZERO, Some(PulseWidth(1550)));
        servo.command(Duration::from_millis(20), None);
        // 60 time constants later e^-60 of the step is left: less than one rounding.
        assert!((servo.angle(Duration::from_secs(2)) - 5.0).abs() < 1e-14);
    }
}
