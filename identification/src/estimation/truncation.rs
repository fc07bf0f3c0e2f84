//! Truncation bias: a bound of the error from omitted high frequencies.
//!
//! With n < N the frequencies above q = (n-1)/2 are omitted. Omitted frequencies bias the retained
//! coefficients, which absorb their contribution to the output. With Z₁ the rows of the bank and Z₂ those of
//! the omitted frequencies, filtered by D and the offset projected out,
//!
//! ```text
//! E θ̂ = θ + A θ₂,   A = (Z₁'Z₁)⁻¹ Z₁'Z₂
//! ```
//!
//! so a function c'h of the impulse response has the error c'(T₁A - T₂)θ₂ at any noise. If |G| rolls off
//! above q at least like a first-order lag (sampled: like 1/sin(lπ/N)) or a second-order one (like 1/l²),
//! the error is at most a sum over the omitted frequencies (`Truncation`). The true error is often several
//! times smaller, because the terms cancel, but the data do not show it.
//!
//! `unit_biases` is the part of the bound that does not depend on the input. Banks are chosen by it.

use faer::Mat;

use crate::data::Moments;
use crate::estimation::fsf_basis::{Circle, FsfBasis};
use crate::estimation::least_squares::filtered_input_moments;
use crate::estimation::noise_model::noise_filter;
use crate::numerics::{cholesky, inverse_of_lower};
use crate::thresholds::LEAKED_SHARE;

/// Number of highest frequencies from which the magnitude above them is extrapolated.
const EDGE_FREQUENCIES: usize = 3;

/// Roll-off assumed above the highest frequency kept: 20 dB/decade, as of a first-order lag.
pub const FIRST_ORDER: i32 = 1;
/// Roll-off of 40 dB/decade, as of a second-order servo.
pub const SECOND_ORDER: i32 = 2;

/// Bounds of the errors that omitted frequencies cause.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Truncation {
    /// Of the step response, all samples.
    pub(crate) step: f64,
    /// Of G at each requested frequency, as a distance in the complex plane.
    pub(crate) frequency: Vec<f64>,
}

impl Truncation {
    /// For a bank with parameters `theta` of standard deviations `sd` and the noise filter `ar`, at
    /// the frequencies `omegas` \[rad/sample\]. `None` when the input hardly separates the retained from
    /// the omitted frequencies, so that there is no bound.
    pub(crate) fn new(
        moments: &Moments,
        basis: &FsfBasis,
        ar: &[f64],
        (theta, sd): (&[f64], &[f64]),
        roll_off: i32,
        omegas: &[f64],
    ) -> Option<Self> {
        let errors = UnitErrors::new(moments, basis, ar, roll_off)?;
        let q = basis.highest();
        let edge = q.saturating_sub(EDGE_FREQUENCIES - 1)..=q;
        let edge_omegas: Vec<f64> = edge
            .clone()
            .map(|l| l as f64 * basis.fundamental())
            .collect();
        let shares = errors.of_frequencies(&edge_omegas);
        let mut largest = 0.0f64;
        for (l, share) in edge.zip(shares) {
            if share > LEAKED_SHARE {
                return None;
            }
            largest = largest.max(magnitude(theta, sd, l) / (1.0 - share));
        }
        let step = errors.of_step();
        Some(Self {
            step: largest * step.iter().copied().fold(0.0, f64::max),
            frequency: errors
                .of_frequencies(omegas)
                .iter()
                .map(|error| largest * error)
                .collect(),
        })
    }
}

/// |G_l| + 2 sd.
fn magnitude(theta: &[f64], sd: &[f64], l: usize) -> f64 {
    match l {
        0 => theta[0].abs() + 2.0 * sd[0],
        l => theta[2 * l - 1].hypot(theta[2 * l]) + 2.0 * sd[2 * l - 1].hypot(sd[2 * l]),
    }
}

/// The errors of an impulse response for a magnitude of 1 at the edge of the bank.
struct UnitErrors {
    /// T₁A - T₂, its columns scaled by the assumed roll-off. Each omitted frequency has a pair of columns
    /// for Re and Im; the second column of N/2 of an even N is zero.
    impulse: Mat<f64>,
}

impl UnitErrors {
    /// `None` when the bank is not determined.
    fn new(moments: &Moments, basis: &FsfBasis, ar: &[f64], roll_off: i32) -> Option<Self> {
        let settling = basis.settling();
        let d = noise_filter(ar);
        let mut products = filtered_input_moments(&moments.uu, settling, &d);
        let sums: Vec<f64> = (0..settling)
            .map(|a| d.iter().zip(&moments.u[a..]).map(|(d, u)| d * u).sum())
            .collect();
        for (b, sum) in sums.iter().enumerate() {
            let share = sum / moments.rows as f64;
            for (product, sum) in products.col_as_slice_mut(b).iter_mut().zip(&sums) {
                *product -= share * sum;
            }
        }
        let (kept, omitted) = (basis.impulse_map(), omitted(basis, roll_off));
        let weighted = kept.transpose() * &products;
        let mut square = &weighted * &kept;
        let n = basis.frequencies();
        let scale: Vec<f64> = (0..n).map(|k| square[(k, k)].sqrt().recip()).collect();
        for j in 0..n {
            for i in 0..n {
                square[(i, j)] *= scale[i] * scale[j];
            }
        }
        let inverse = inverse_of_lower(&cholesky(&square)?);
        let mut across = weighted * &omitted;
        let scaled = |matrix: &mut Mat<f64>| {
            for j in 0..matrix.ncols() {
                for (entry, scale) in matrix.col_as_slice_mut(j).iter_mut().zip(&scale) {
                    *entry *= scale;
                }
            }
        };
        scaled(&mut across);
        let mut leaked = inverse.transpose() * (&inverse * across);
        scaled(&mut leaked);
        let impulse = kept * leaked - omitted;
        let sound =
            (0..impulse.ncols()).all(|j| impulse.col_as_slice(j).iter().all(|x| x.is_finite()));
        sound.then_some(Self { impulse })
    }

    fn pairs(&self) -> usize {
        self.impulse.ncols() / 2
    }

    /// Of the step response at each sample.
    fn of_step(&self) -> Vec<f64> {
        let settling = self.impulse.nrows();
        let mut bound = vec![0.0; settling];
        for l in 0..self.pairs() {
            let (re, im) = (
                self.impulse.col_as_slice(2 * l),
                self.impulse.col_as_slice(2 * l + 1),
            );
            let mut sum = (0.0, 0.0);
            for ((bound, re), im) in bound.iter_mut().zip(re).zip(im) {
                sum = (sum.0 + re, sum.1 + im);
                *bound += length(sum.0, sum.1);
            }
        }
        bound
    }

    /// Of G at each of `omegas` \[rad/sample\].
    fn of_frequencies(&self, omegas: &[f64]) -> Vec<f64> {
        let count = omegas.len();
        // e^{-jωi}: the real parts of all frequencies, then the imaginary parts.
        let mut turning = Mat::zeros(self.impulse.nrows(), 2 * count);
        for (k, omega) in omegas.iter().enumerate() {
            // Recursive rotation: its rounding after N steps is negligible in a bound.
            let (turn_sin, turn_cos) = omega.sin_cos();
            let (mut re, mut im) = (1.0, 0.0);
            for i in 0..turning.nrows() {
                (turning[(i, k)], turning[(i, count + k)]) = (re, im);
                (re, im) = (re * turn_cos + im * turn_sin, im * turn_cos - re * turn_sin);
            }
        }
        let errors = turning.transpose() * &self.impulse;
        let mut bounds = vec![0.0; count];
        for l in 0..self.pairs() {
            let column = |c: usize| errors.col_as_slice(2 * l + c).split_at(count);
            let ((a_re, a_im), (b_re, b_im)) = (column(0), column(1));
            for (k, bound) in bounds.iter_mut().enumerate() {
                *bound += largest_stretch((a_re[k], a_im[k]), (b_re[k], b_im[k]));
            }
        }
        bounds
    }
}

/// Length of a vector of ordinary magnitude. [`f64::hypot`] also covers the extremes, at ten times the
/// cost.
fn length(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

/// The largest length of x a + y b over x² + y² = 1: the larger singular value of \[a b\].
fn largest_stretch(a: (f64, f64), b: (f64, f64)) -> f64 {
    (length(a.0 + b.1, a.1 - b.0) + length(a.0 - b.1, a.1 + b.0)) / 2.0
}

/// T₂: the impulse responses of the omitted frequencies, in pairs of columns, each scaled by its largest
/// magnitude for a magnitude of 1 at the highest retained frequency.
fn omitted(basis: &FsfBasis, roll_off: i32) -> Mat<f64> {
    let (n, q) = (basis.settling(), basis.highest());
    let turn = basis.fundamental();
    let sine = |l: usize| (turn * l as f64 / 2.0).sin();
    let size = |l: usize| match roll_off {
        FIRST_ORDER => sine(q.max(1)) / sine(l),
        _ => (q.max(1) as f64 / l as f64).powi(roll_off),
    };
    let circle = Circle::new(n);
    let mut map = Mat::zeros(n, 2 * (n / 2 - q));
    for l in q + 1..=n / 2 {
        let pair = 2 * (l - q - 1);
        // The frequency N/2 of an even N stands alone, and is real.
        let alone = 2 * l == n;
        let scale = if alone { 1.0 } else { 2.0 } * size(l) / n as f64;
        for (i, (sin, cos)) in circle.multiples(l).enumerate() {
            map[(i, pair)] = scale * cos;
            if !alone {
                map[(i, pair + 1)] = -scale * sin;
            }
        }
    }
    map
}

/// max_m sum_{l>q} 2 |S(l,m)| (q/l)^r for every q from 0 to the highest frequency of a full bank: the
/// omitted part of the step response, without the bias of the retained coefficients.
pub(crate) fn unit_biases(settling: usize, roll_off: i32) -> Vec<f64> {
    let Ok(full) = FsfBasis::full(settling) else {
        return vec![0.0];
    };
    let top = settling / 2;
    let mut sum = vec![0.0; settling];
    let mut biases = vec![0.0; top + 1];
    for (index, kernel) in full.step_kernel_magnitudes().iter().enumerate().rev() {
        let l = index + 1;
        // The frequency N/2 of an even N stands alone; all others come in pairs.
        let terms = if 2 * l == settling { 1.0 } else { 2.0 };
        let factor = terms / (l as f64).powi(roll_off);
        for (sum, kernel) in sum.iter_mut().zip(kernel) {
            *sum += factor * kernel;
        }
        let largest = sum.iter().copied().fold(0.0, f64::max);
        biases[index] = largest * (index.max(1) as f64).powi(roll_off);
    }
    biases
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Record;
    use crate::estimation::least_squares::{Coordinates, RowInformation};
    use crate::numerics::causal_filter;

    /// A noise-free record of a first-order lag whose impulse response has 101 samples, under edges that
    /// a filter has rounded.
    fn record(impulse: &[f64]) -> Record<'static> {
        let edges: Vec<f64> = (0..2500).map(|k| f64::from(k * k / 9000 % 2)).collect();
        let mut state = 0.0;
        let input: Vec<f64> = edges
            .iter()
            .map(|u| {
                state += 0.2 * (u - state);
                state
            })
            .collect();
        let output = causal_filter(impulse, &input, Some(0.0));
        Record::of_run(0.01, input, output).unwrap()
    }

    #[test]
    fn the_bounds_hold_for_a_first_order_lag_without_noise() {
        let n = 101;
        let impulse: Vec<f64> = (0..n).map(|i| 0.1 * 0.9f64.powi(i)).collect();
        let full = FsfBasis::full(n as usize).unwrap();
        let analysis = full.analysis_map();
        let truth: Vec<f64> = (0..n as usize)
            .map(|j| (0..n as usize).map(|i| analysis[(j, i)] * impulse[i]).sum())
            .collect();
        let moments = Moments::of_record(&record(&impulse), n as usize, 1);
        let information = RowInformation::from_moments(moments.clone());
        for frequencies in [11, 21, 51] {
            let basis = FsfBasis::new(n as usize, frequencies).unwrap();
            let solution = information.solve(&Coordinates::new(basis), &[]).unwrap();
            let theta = solution.response();
            let exact = vec![0.0; frequencies];
            // The gain is the first of them.
            let omegas: Vec<f64> = (0..40).map(|k| 0.07 * f64::from(k)).collect();
            let bounds =
                Truncation::new(&moments, &basis, &[], (theta, &exact), FIRST_ORDER, &omegas)
                    .unwrap();
            let step = basis.step_response(theta);
            let error = step
                .iter()
                .zip(full.step_response(&truth))
                .map(|(a, b)| (a - b).abs());
            let error = error.fold(0.0, f64::max);
            assert!(
                error <= bounds.step && bounds.step < 20.0 * error,
                "{frequencies}: {error} {bounds:?}"
            );
            for (omega, bound) in omegas.iter().zip(&bounds.frequency) {
                let (found, exact) = (
                    basis.frequency_response(theta, *omega),
                    full.frequency_response(&truth, *omega),
                );
                let error = (found.0 - exact.0).hypot(found.1 - exact.1);
                assert!(error <= *bound, "{frequencies}, {omega}: {error} {bound}");
            }
        }
    }

    #[test]
    fn a_sine_between_the_frequencies_of_a_bank_leaves_no_bound() {
        let input: Vec<f64> = (0..2000).map(|k| (0.37 * f64::from(k)).sin()).collect();
        let record = Record::of_run(0.01, &input, &input).unwrap();
        let moments = Moments::of_record(&record, 101, 1);
        let basis = FsfBasis::new(101, 3).unwrap();
        let (theta, sd) = ([1.0; 3], [0.0; 3]);
        let found = Truncation::new(&moments, &basis, &[], (&theta, &sd), FIRST_ORDER, &[0.1]);
        assert_eq!(found, None);
    }

    #[test]
    fn stretches_are_singular_values() {
        assert!((largest_stretch((3.0, 0.0), (0.0, 2.0)) - 3.0).abs() < 1e-12);
        let (a, b) = ((1.0, -0.4), (0.3, 0.8));
        let seen = (0..10_000)
            .map(|k| {
                let (y, x) = (f64::from(k) * 1e-3).sin_cos();
                (x * a.0 + y * b.0).hypot(x * a.1 + y * b.1)
            })
            .fold(0.0, f64::max);
        // A grid of a thousandth of a radian.
        assert!((largest_stretch(a, b) - seen).abs() < 1e-6);
    }
}
