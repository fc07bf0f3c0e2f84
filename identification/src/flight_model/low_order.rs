//! Low-order transfer functions, K e^{-Ls} with one to three poles, and their exact step responses.

use faer::c64;
use serde::{Deserialize, Serialize};

/// Smallest relative distance of two poles; coinciding poles are separated by it. The response is an even
/// function of the distance and changes by its square. The residues lose as many digits as the distance
/// has.
const APART: f64 = 1e-5;

/// A transfer function of low order, orders 1 to 3:
///
/// ```text
/// K e^{-Ls} / (1 + Ts)
/// K e^{-Ls} / (1 + 2ζs/ω + s²/ω²)
/// K e^{-Ls} / ((1 + 2ζs/ω + s²/ω²) (1 + Ts))
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LowOrder {
    /// K \[output per input\].
    pub gain: f64,
    /// L \[s\].
    pub delay_s: f64,
    /// ω \[rad/s\] and ζ, orders 2 and 3.
    pub oscillator: Option<Oscillator>,
    /// T \[s\], orders 1 and 3.
    pub lag_s: Option<f64>,
}

/// A pair of poles.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Oscillator {
    /// ω \[rad/s\].
    pub omega_rad_s: f64,
    /// ζ.
    pub damping: f64,
}

impl LowOrder {
    /// Parameters of the search: \[K, L, ln ω, ln ζ, ln T\], those that the order has.
    pub(super) fn parameters(&self) -> Vec<f64> {
        let mut x = vec![self.gain, self.delay_s];
        if let Some(oscillator) = self.oscillator {
            x.extend([oscillator.omega_rad_s.ln(), oscillator.damping.ln()]);
        }
        x.extend(self.lag_s.map(f64::ln));
        x
    }

    /// Inverse of [`LowOrder::parameters`].
    pub(super) fn from_parameters(order: usize, x: &[f64]) -> Self {
        Self {
            gain: x[0],
            delay_s: x[1],
            oscillator: (order >= 2).then(|| Oscillator {
                omega_rad_s: x[2].exp(),
                damping: x[3].exp(),
            }),
            lag_s: (order != 2).then(|| x[x.len() - 1].exp()),
        }
    }

    /// Poles \[1/s\], all distinct.
    fn poles(&self) -> Vec<c64> {
        let mut poles = Vec::with_capacity(3);
        if let Some(Oscillator {
            omega_rad_s,
            damping,
        }) = self.oscillator
        {
            let root = c64::new(damping * damping - 1.0, 0.0).sqrt();
            let root = if root.norm() < APART {
                c64::new(APART, 0.0)
            } else {
                root
            };
            poles.extend([
                (root - damping) * omega_rad_s,
                (-root - damping) * omega_rad_s,
            ]);
        }
        if let Some(lag) = self.lag_s {
            let mut pole = c64::new(-1.0 / lag, 0.0);
            while poles
                .iter()
                .any(|p: &c64| (p - pole).norm() < APART * pole.norm())
            {
                pole *= 1.0 + 3.0 * APART;
            }
            poles.push(pole);
        }
        poles
    }

    /// The size of the fastest pole \[1/s\].
    pub(super) fn fastest_pole(&self) -> f64 {
        self.poles()
            .iter()
            .map(|pole| pole.norm())
            .fold(0.0, f64::max)
    }

    /// The distance of the slowest pole from the imaginary axis \[1/s\].
    pub(super) fn slowest_pole(&self) -> f64 {
        let rates = self.poles().into_iter().map(|pole| -pole.re);
        rates.fold(f64::INFINITY, f64::min)
    }

    /// The response to a unit step, `t_s` seconds after it, by residues.
    ///
    /// ```
    /// use servoid_identification::flight_model::LowOrder;
    /// let servo = LowOrder { gain: 2.0, delay_s: 0.02, oscillator: None, lag_s: Some(0.01) };
    /// assert!((servo.step(0.03) - 2.0 * (1.0 - (-1.0f64).exp())).abs() < 1e-12);
    /// ```
    pub fn step(&self, t_s: f64) -> f64 {
        self.steps(std::iter::once(t_s))[0]
    }

    /// [`LowOrder::step`] at many times.
    pub(crate) fn steps(&self, times: impl Iterator<Item = f64>) -> Vec<f64> {
        let modes = self.modes();
        let at = |t_s: f64| {
            let late = t_s - self.delay_s;
            let parts = modes.iter();
            let parts = parts.map(|(pole, weight)| (weight * (pole * late).exp()).re);
            match late > 0.0 {
                true => self.gain * (1.0 + parts.sum::<f64>()),
                false => 0.0,
            }
        };
        times.map(at).collect()
    }

    /// The same from `first_s` on at `count` times that are `period_s` apart: each mode loses the same factor from one to the next.
    pub(crate) fn steps_every(&self, first_s: f64, period_s: f64, count: usize) -> Vec<f64> {
        let late = |i: usize| first_s + period_s * i as f64 - self.delay_s;
        let before = (0..count).find(|&i| late(i) > 0.0).unwrap_or(count);
        let mut modes: Vec<(c64, c64)> = (self.modes().into_iter())
            .map(|(pole, weight)| {
                (
                    weight * (pole * late(before)).exp(),
                    (pole * period_s).exp(),
                )
            })
            .collect();
        let next = |_| {
            let sum: f64 = modes.iter().map(|(part, _)| part.re).sum();
            modes.iter_mut().for_each(|(part, kept)| *part *= *kept);
            self.gain * (1.0 + sum)
        };
        let after = (before..count).map(next);
        std::iter::repeat_n(0.0, before).chain(after).collect()
    }

    /// Poles with their residues of the step response.
    fn modes(&self) -> Vec<(c64, c64)> {
        let poles = self.poles();
        let all: c64 = poles.iter().map(|p| -p).product();
        (0..poles.len())
            .map(|i| {
                let others: c64 = (0..poles.len())
                    .filter(|&j| j != i)
                    .map(|j| poles[i] - poles[j])
                    .product();
                (poles[i], all / (poles[i] * others))
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn even_times_are_like_others() {
        let servo = LowOrder {
            gain: 2.0,
            delay_s: 0.013,
            oscillator: Some(Oscillator {
                omega_rad_s: 40.0,
                damping: 0.3,
            }),
            lag_s: Some(0.02),
        };
        let apart = servo.steps((0..300).map(|i| 0.0005 + 0.004 * f64::from(i)));
        let even = servo.steps_every(0.0005, 0.004, 300);
        for (apart, even) in apart.iter().zip(even) {
            assert_abs_diff_eq!(*apart, even, epsilon = 1e-12);
        }
    }

    #[test]
    fn poles_that_coincide_give_the_limit() {
        let critical = |t: f64| 1.0 - (-50.0 * t).exp() * (1.0 + 50.0 * t);
        let servo = LowOrder {
            gain: 1.0,
            delay_s: 0.0,
            oscillator: Some(Oscillator {
                omega_rad_s: 50.0,
                damping: 1.0,
            }),
            lag_s: None,
        };
        let triple = LowOrder {
            lag_s: Some(0.02),
            ..servo
        };
        let exact = |t: f64| 1.0 - (-50.0 * t).exp() * (1.0 + 50.0 * t + 1250.0 * t * t);
        for t in [0.001, 0.02, 0.1] {
            assert_abs_diff_eq!(servo.step(t), critical(t), epsilon = 1e-9);
            // Two distances of 1e-5: ten digits are lost.
            assert_abs_diff_eq!(triple.step(t), exact(t), epsilon = 1e-4);
        }
    }
}
