//! Exact discretisation of a low-order transfer function with a held input.

use faer::Mat;

use super::low_order::{LowOrder, Oscillator};
use crate::data::Timing;

/// A state-space form with exactly the output of the continuous transfer function at the samples, for an
/// input that is held between samples:
///
/// ```text
/// x(k+1) = A x(k) + B u(k-m)
/// y(k)   = C x(k) + D u(k-m)
/// ```
///
/// u(k) is held from kTs to (k+1)Ts, and y(k) is the output at kTs + φ, as in the model's step response. m is
/// the delay in samples, rounded up. C and D look ahead by the difference.
///
/// The states are \[p, p'/ω\] of the oscillator, then the output of the lag before it, in units of the
/// input.
#[derive(Debug, Clone, PartialEq)]
pub struct Discrete {
    /// Ts and φ.
    pub timing: Timing,
    /// m \[samples\].
    pub delay_samples: usize,
    /// A, r x r.
    pub a: Vec<Vec<f64>>,
    /// B, r.
    pub b: Vec<f64>,
    /// C, r.
    pub c: Vec<f64>,
    /// D.
    pub d: f64,
    /// x at rest at an input of 1.
    pub rest: Vec<f64>,
}

impl LowOrder {
    /// Coefficients of the denominator in falling powers of s; the last one is 1. The numerator is
    /// the gain.
    ///
    /// ```
    /// use servoid_identification::flight_model::{LowOrder, Oscillator};
    /// let oscillator = Some(Oscillator { omega_rad_s: 50.0, damping: 0.5 });
    /// let servo = LowOrder { gain: 0.9, delay_s: 0.02, oscillator, lag_s: None };
    /// assert_eq!(servo.denominator(), [0.0004, 0.02, 1.0]);
    /// ```
    pub fn denominator(&self) -> Vec<f64> {
        let second = self.oscillator.map_or_else(
            || vec![1.0],
            |o| {
                vec![
                    (o.omega_rad_s * o.omega_rad_s).recip(),
                    2.0 * o.damping / o.omega_rad_s,
                    1.0,
                ]
            },
        );
        let Some(lag) = self.lag_s else { return second };
        let shifted = std::iter::once(0.0).chain(second.iter().copied());
        let scaled = second.iter().map(|a| lag * a).chain([0.0]);
        shifted.zip(scaled).map(|(a, b)| a + b).collect()
    }

    /// The exact discretisation. A negative delay counts as zero.
    ///
    /// ```
    /// use servoid_identification::flight_model::LowOrder;
    /// use servoid_identification::Timing;
    /// let servo = LowOrder { gain: 2.0, delay_s: 0.005, oscillator: None, lag_s: Some(0.01) };
    /// let timing = Timing { sample_period_s: 0.002, sample_phase_s: 0.0 };
    /// let discrete = servo.discrete(timing);
    /// assert_eq!(discrete.delay_samples, 3);
    /// let response = discrete.simulate(&[1.0; 20], 0.0);
    /// assert!((response[10] - servo.step(0.02)).abs() < 1e-12);
    /// ```
    pub fn discrete(&self, timing: Timing) -> Discrete {
        let (a, b) = self.rates();
        let period = timing.sample_period_s;
        let late = self.delay_s.max(0.0) - timing.sample_phase_s;
        let delay_samples = (late / period).ceil().max(0.0) as usize;
        let ahead = (delay_samples as f64 * period - late).min(period);
        let (whole, part) = (transition(&a, &b, period), transition(&a, &b, ahead));
        let order = b.len();
        let mut rest = vec![1.0; order];
        if self.oscillator.is_some() {
            rest[1] = 0.0;
        }
        Discrete {
            timing,
            delay_samples,
            a: (0..order)
                .map(|i| (0..order).map(|j| whole[(i, j)]).collect())
                .collect(),
            b: (0..order).map(|i| whole[(i, order)]).collect(),
            c: (0..order).map(|j| self.gain * part[(0, j)]).collect(),
            d: self.gain * part[(0, order)],
            rest,
        }
    }

    /// Continuous A, row by row, and B.
    fn rates(&self) -> (Vec<Vec<f64>>, Vec<f64>) {
        match (self.oscillator, self.lag_s) {
            (
                Some(Oscillator {
                    omega_rad_s: w,
                    damping,
                }),
                None,
            ) => (
                vec![vec![0.0, w], vec![-w, -2.0 * damping * w]],
                vec![0.0, w],
            ),
            (
                Some(Oscillator {
                    omega_rad_s: w,
                    damping,
                }),
                Some(lag),
            ) => (
                vec![
                    vec![0.0, w, 0.0],
                    vec![-w, -2.0 * damping * w, w],
                    vec![0.0, 0.0, -1.0 / lag],
                ],
                vec![0.0, 0.0, 1.0 / lag],
            ),
            (None, Some(lag)) => (vec![vec![-1.0 / lag]], vec![1.0 / lag]),
            // A pure gain has no state.
            (None, None) => (Vec::new(), Vec::new()),
        }
    }
}

/// exp(\[A B; 0 0\] t): the state after t from the state and the held input. By scaling and squaring with
/// Taylor's series.
fn transition(a: &[Vec<f64>], b: &[f64], t: f64) -> Mat<f64> {
    let order = b.len();
    let matrix = Mat::from_fn(order + 1, order + 1, |i, j| match (i < order, j < order) {
        (true, true) => a[i][j] * t,
        (true, false) => b[i] * t,
        (false, _) => 0.0,
    });
    let norm = (0..=order)
        .map(|j| matrix.col_as_slice(j).iter().map(|x| x.abs()).sum::<f64>())
        .fold(0.0, f64::max);
    let halvings = (2.0 * norm).log2().ceil().max(0.0) as i32;
    let small = faer::Scale(0.5f64.powi(halvings)) * &matrix;
    let mut sum = Mat::<f64>::identity(order + 1, order + 1);
    let mut term = sum.clone();
    // The terms fall at least as 2^-k / k!: the 16th is below 1e-18.
    for k in 1..=16 {
        term = faer::Scale(1.0 / f64::from(k)) * (&term * &small);
        sum += &term;
    }
    for _ in 0..halvings {
        sum = &sum * &sum;
    }
    sum
}

impl Discrete {
    /// The response to an input, from rest at the input `before`.
    pub fn simulate(&self, input: &[f64], before: f64) -> Vec<f64> {
        let mut x: Vec<f64> = self.rest.iter().map(|r| r * before).collect();
        let product =
            |row: &[f64], x: &[f64]| -> f64 { row.iter().zip(x).map(|(a, b)| a * b).sum() };
        (0..input.len())
            .map(|k| {
                let u = k
                    .checked_sub(self.delay_samples)
                    .map_or(before, |k| input[k]);
                let y = product(&self.c, &x) + self.d * u;
                x = (0..x.len())
                    .map(|i| product(&self.a[i], &x) + self.b[i] * u)
                    .collect();
                y
            })
            .collect()
    }

    /// Numerator and denominator in falling powers of z, of the same length, without the m samples
    /// of delay; the denominator begins with 1 (after D. K. Faddeev and U. Le Verrier).
    pub fn transfer_function(&self) -> (Vec<f64>, Vec<f64>) {
        let order = self.b.len();
        let a = Mat::from_fn(order, order, |i, j| self.a[i][j]);
        let (mut numerator, mut denominator) = (vec![0.0], vec![1.0]);
        let mut adjoint = Mat::<f64>::zeros(order, order);
        for k in 1..=order {
            adjoint = &a * &adjoint;
            for i in 0..order {
                adjoint[(i, i)] += denominator[k - 1];
            }
            let output = (0..order)
                .map(|i| self.c[i] * (0..order).map(|j| adjoint[(i, j)] * self.b[j]).sum::<f64>());
            numerator.push(output.sum());
            let product = &a * &adjoint;
            let trace: f64 = (0..order).map(|i| product[(i, i)]).sum();
            denominator.push(-trace / k as f64);
        }
        for (n, d) in numerator.iter_mut().zip(&denominator) {
            *n += self.d * d;
        }
        (numerator, denominator)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    fn servos() -> [LowOrder; 6] {
        let oscillator = |damping| {
            Some(Oscillator {
                omega_rad_s: 60.0,
                damping,
            })
        };
        let servo = |delay_s, oscillator, lag_s| LowOrder {
            gain: 0.97,
            delay_s,
            oscillator,
            lag_s,
        };
        [
            servo(0.0071, None, None),
            servo(0.0, None, Some(0.015)),
            servo(0.0255, oscillator(0.5), None),
            servo(0.004, oscillator(1.5), Some(0.008)),
            servo(0.0003, oscillator(0.2), None),
            servo(0.0219, oscillator(0.4), Some(0.0337)),
        ]
    }

    /// Slow and obvious: the sum of the continuous responses to each change of the input.
    fn superposed(servo: &LowOrder, timing: Timing, input: &[f64], before: f64) -> Vec<f64> {
        let change = |k: usize| input[k] - k.checked_sub(1).map_or(before, |k| input[k]);
        let at = |k: usize, i: usize| timing.seconds((k - i) as f64);
        (0..input.len())
            .map(|k| {
                servo.gain * before
                    + (0..=k)
                        .map(|i| change(i) * servo.step(at(k, i)))
                        .sum::<f64>()
            })
            .collect()
    }

    #[test]
    fn samples_are_those_of_the_continuous_servo() {
        let input: Vec<f64> = (0..120).map(|k| f64::from(k * k / 60 % 5) - 2.0).collect();
        for servo in servos() {
            for sample_phase_s in [0.0, 0.0005, 0.0019] {
                let timing = Timing {
                    sample_period_s: 0.002,
                    sample_phase_s,
                };
                let discrete = servo.discrete(timing).simulate(&input, 1.5);
                let exact = superposed(&servo, timing, &input, 1.5);
                for (a, b) in discrete.iter().zip(&exact) {
                    // Rounding of 120 terms of size 1.
                    assert_abs_diff_eq!(a, b, epsilon = 1e-11);
                }
            }
        }
    }

    #[test]
    fn the_rational_form_is_the_state_space() {
        let timing = Timing {
            sample_period_s: 0.002,
            sample_phase_s: 0.0005,
        };
        let input: Vec<f64> = (0..120).map(|k| f64::from(k * k / 60 % 5) - 2.0).collect();
        for servo in servos() {
            let discrete = servo.discrete(timing);
            let (numerator, denominator) = discrete.transfer_function();
            let expected = discrete.simulate(&input, 0.0);
            let mut y: Vec<f64> = Vec::new();
            for k in 0..input.len() {
                let past =
                    |values: &[f64], late: usize| k.checked_sub(late).map_or(0.0, |k| values[k]);
                let forward: f64 = (0..numerator.len())
                    .map(|i| numerator[i] * past(&input, i + discrete.delay_samples))
                    .sum();
                let back: f64 = (1..denominator.len())
                    .map(|i| denominator[i] * past(&y, i))
                    .sum();
                y.push(forward - back);
                // Direct forms lose digits to their close poles: 120 steps at a condition of 1e4.
                assert_abs_diff_eq!(y[k], expected[k], epsilon = 1e-9);
            }
        }
    }
}
