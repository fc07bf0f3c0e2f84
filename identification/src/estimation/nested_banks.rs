//! All banks n = 1, 3, 5, ... of one settling time from one factorisation.
//!
//! With the offset first and the frequencies ascending, the Cholesky factor of the largest bank contains
//! that of every smaller one. The residual sums of squares, standard deviations and uppermost frequencies
//! of all banks therefore cost no more than those of one.

use std::cell::OnceCell;

use faer::Mat;

use crate::data::Moments;
use crate::estimation::fsf_basis::FsfBasis;
use crate::estimation::least_squares::{Coordinates, NormalEquations};
use crate::estimation::truncation::unit_biases;
use crate::numerics::{dot, factorised, forward_solve, inverse_of_lower};
use crate::thresholds::NARROWEST_AT;

/// Smallest squared pivot of the equilibrated equations. Below it, a frequency is a combination of lower
/// ones and not excited by itself.
const SMALLEST_PIVOT: f64 = 1e-9;

/// The bounds that one bank would give.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct BankCandidate {
    /// n.
    pub frequencies: usize,
    /// Generalised cross-validation: rows RSS / (rows - n - 1)².
    pub gcv: f64,
    /// Mean 99 % half width of the step response from the noise alone.
    pub noise_half_width: f64,
    /// Bound of the truncation bias at the assumed roll-off.
    pub truncation_bias: f64,
}

impl BankCandidate {
    /// Half width of the bound: noise and truncation bias together.
    pub fn half_width(&self) -> f64 {
        self.noise_half_width + self.truncation_bias
    }
}

/// Every bank of one settling time that the input excites.
pub(crate) struct NestedBanks {
    settling: usize,
    roll_off: i32,
    rows: f64,
    noise_order: usize,
    factor: PivotedPrefix,
    /// Computed on demand, because the widths of the bounds are expensive.
    candidates: OnceCell<Vec<BankCandidate>>,
}

impl NestedBanks {
    /// All banks of one settling time and noise filter. `None` when not even the gain is determined.
    pub(crate) fn scan(
        moments: &Moments,
        settling: usize,
        ar: &[f64],
        roll_off: i32,
    ) -> Option<Self> {
        let basis = FsfBasis::full(settling).ok()?;
        let in_theta = Coordinates::in_theta(basis);
        let factor = PivotedPrefix::new(basis, &NormalEquations::new(moments, &in_theta, ar));
        (factor.excited() > 0).then(|| Self {
            settling,
            roll_off,
            rows: moments.rows as f64,
            noise_order: ar.len(),
            factor,
            candidates: OnceCell::new(),
        })
    }

    /// The banks, smallest first.
    pub(crate) fn candidates(&self) -> &[BankCandidate] {
        self.candidates.get_or_init(|| self.widths())
    }

    /// Residual sum of squares of each bank n = 1, 3, 5, ...
    fn residual_squares(&self) -> impl Iterator<Item = (usize, f64)> {
        let z = &self.factor.projected;
        let without_offset = self.factor.total - z[0].powi(2);
        let left = z[1..].iter().scan(without_offset, |left, z| {
            *left -= z * z;
            Some(left.max(0.0))
        });
        (1..).zip(left).step_by(2)
    }

    /// Generalised cross-validation of the bank of `n` frequencies.
    fn gcv(&self, n: usize, rss: f64) -> f64 {
        self.rows * rss / (self.rows - (n + 1) as f64).max(1.0).powi(2)
    }

    fn widths(&self) -> Vec<BankCandidate> {
        let (factor, settling) = (&self.factor, self.settling);
        let inverse = inverse_of_lower(&factor.lower);
        let step = factor.basis.step_map();
        let size = factor.excited() + 1;
        let scaled = Mat::from_fn(size, settling, |k, m| {
            if k == 0 {
                0.0
            } else {
                step[(m, k - 1)] * factor.scale[k]
            }
        });
        // F = Q L^-T for the step response, offset first: N x size.
        let spread = scaled.transpose() * inverse.transpose();
        let biases = unit_biases(settling, self.roll_off);
        let critical = crate::numerics::pointwise_critical(NARROWEST_AT);
        let mut variances = vec![0.0; settling];
        let mut added = 0;
        self.residual_squares()
            .map(|(n, rss)| {
                for k in added + 1..=n {
                    for (variance, share) in variances.iter_mut().zip(spread.col_as_slice(k)) {
                        *variance += share * share;
                    }
                }
                added = n;
                let dof = (self.rows - (n + 1 + self.noise_order) as f64).max(1.0);
                let sigma = (rss / dof).sqrt();
                let sd: f64 = variances.iter().map(|v| v.sqrt()).sum();
                BankCandidate {
                    frequencies: n,
                    gcv: self.gcv(n, rss),
                    noise_half_width: critical * sigma * sd / settling as f64,
                    truncation_bias: factor.edge_magnitude(&inverse, n, sigma) * biases[n / 2],
                }
            })
            .collect()
    }

    /// The bank with the narrowest bound.
    pub(crate) fn narrowest(&self) -> BankCandidate {
        *self
            .candidates()
            .iter()
            .min_by(|a, b| a.half_width().total_cmp(&b.half_width()))
            .expect("a scan has at least the bank of the gain")
    }

    /// Number of frequencies of the bank that predicts best.
    pub(crate) fn best_predictor(&self) -> usize {
        self.residual_squares()
            .map(|(n, rss)| (n, self.gcv(n, rss)))
            .min_by(|(_, a), (_, b)| a.total_cmp(b))
            .map_or(1, |(n, _)| n)
    }

    /// The largest bank that the input excites.
    pub(crate) fn largest(&self) -> BankCandidate {
        let candidates = self.candidates();
        candidates[candidates.len() - 1]
    }

    /// Number of frequencies of the largest bank that the input excites.
    pub(crate) fn excited(&self) -> usize {
        self.factor.excited()
    }
}

/// The Cholesky factor of the equilibrated equations, offset first, up to the last pivot above rounding.
struct PivotedPrefix {
    basis: FsfBasis,
    lower: Mat<f64>,
    scale: Vec<f64>,
    /// L^-1 b.
    projected: Vec<f64>,
    /// Sum of squares of the filtered output.
    total: f64,
}

impl PivotedPrefix {
    fn new(basis: FsfBasis, equations: &NormalEquations) -> Self {
        let equilibrated = equations.equilibrated();
        let whole = Self::of_all(basis, equations, &equilibrated);
        whole.unwrap_or_else(|| Self::row_by_row(basis, equations, &equilibrated))
    }

    /// `equilibrated` are the equations with their scale.
    fn row_by_row(
        basis: FsfBasis,
        equations: &NormalEquations,
        (a, scale): &(Mat<f64>, Vec<f64>),
    ) -> Self {
        let p = scale.len();
        // The offset is last in the equations and first here.
        let original = |k: usize| if k == 0 { p - 1 } else { k - 1 };
        let mut lower = Mat::<f64>::zeros(p, p);
        let mut projected = Vec::with_capacity(p);
        for k in 0..p {
            let mut pivot = a[(original(k), original(k))];
            for j in 0..k {
                // Row k of L: earlier rows are known.
                let known = dot(&lower.col_as_slice(k)[..j], &lower.col_as_slice(j)[..j]);
                let entry = (a[(original(k), original(j))] - known) / lower[(j, j)];
                lower[(j, k)] = entry;
                pivot -= entry * entry;
            }
            if pivot.is_nan() || pivot < SMALLEST_PIVOT {
                break;
            }
            lower[(k, k)] = pivot.sqrt();
            let known = dot(&lower.col_as_slice(k)[..k], &projected);
            let b = equations.b[original(k)] * scale[original(k)];
            projected.push((b - known) / lower[(k, k)]);
        }
        // Whole frequencies only: the offset, the gain and pairs.
        let sound = projected.len().saturating_sub(1);
        let sound = if sound == 0 {
            0
        } else {
            sound - usize::from(sound.is_multiple_of(2))
        };
        let size = sound + 1;
        projected.truncate(size);
        Self {
            basis,
            // Built as rows of L in columns, for contiguous inner products.
            lower: Mat::from_fn(size, size, |i, j| if j <= i { lower[(j, i)] } else { 0.0 }),
            scale: (0..size).map(|k| scale[original(k)]).collect(),
            projected,
            total: equations.c,
        }
    }

    /// Where all pivots are well above the smallest, in blocks, which is several times faster.
    fn of_all(
        basis: FsfBasis,
        equations: &NormalEquations,
        (a, scale): &(Mat<f64>, Vec<f64>),
    ) -> Option<Self> {
        /// Beyond all differences of rounding between this way and the other.
        const WELL_ABOVE: f64 = 100.0;
        let last = scale.len() - 1;
        if last == 0 || last.is_multiple_of(2) {
            return None;
        }
        let offset_first = |values: &[f64]| -> Vec<f64> {
            let (offset, others) = (values[last], &values[..last]);
            [offset].into_iter().chain(others.iter().copied()).collect()
        };
        let mut turned = Mat::<f64>::zeros(last + 1, last + 1);
        let column = turned.col_as_slice_mut(0);
        column.copy_from_slice(&offset_first(a.col_as_slice(last)));
        for k in 1..=last {
            turned.col_as_slice_mut(k)[1..].copy_from_slice(&a.col_as_slice(k - 1)[..last]);
        }
        let lower = factorised(turned)?;
        if (0..=last).any(|k| lower[(k, k)].powi(2) < WELL_ABOVE * SMALLEST_PIVOT) {
            return None;
        }
        let scale = offset_first(scale);
        let b = offset_first(&equations.b).into_iter().zip(&scale);
        let b: Vec<f64> = b.map(|(b, s)| b * s).collect();
        Some(Self {
            basis,
            projected: forward_solve(&lower, &b),
            lower,
            scale,
            total: equations.c,
        })
    }

    /// Number of excited frequencies, odd.
    fn excited(&self) -> usize {
        self.scale.len() - 1
    }

    /// Largest |G_l| + 2 sd over the last three frequencies of the bank with `n` frequencies.
    fn edge_magnitude(&self, inverse: &Mat<f64>, n: usize, sigma: f64) -> f64 {
        let first = n.saturating_sub(5).max(1);
        // θ_k = scale_k sum_{j>=k} (L^-1)[j,k] z_j over the columns of this bank.
        let entry = |k: usize| {
            let (value, square) = (k..=n).fold((0.0, 0.0), |(value, square), j| {
                let weight = inverse[(j, k)];
                (value + weight * self.projected[j], square + weight * weight)
            });
            (value * self.scale[k], sigma * square.sqrt() * self.scale[k])
        };
        let magnitude = |k: usize| match k {
            1 => {
                let (value, sd) = entry(1);
                value.abs() + 2.0 * sd
            }
            k => {
                let ((re, re_sd), (im, im_sd)) = (entry(k), entry(k + 1));
                re.hypot(im) + 2.0 * re_sd.hypot(im_sd)
            }
        };
        (first..=n)
            .filter(|&k| k == 1 || k % 2 == 0)
            .map(magnitude)
            .fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Record;
    use approx::assert_relative_eq;

    #[test]
    fn banks_from_blocks_are_those_from_rows() {
        let input: Vec<f64> = (0..900).map(|k| f64::from(k * k / 700 % 3)).collect();
        let course = |k: usize| 0.3 * input[k.saturating_sub(4)] + (k as f64).sin();
        let output: Vec<f64> = (0..900).map(course).collect();
        let record = Record::of_run(0.002, &input, &output).unwrap();
        let basis = FsfBasis::full(41).unwrap();
        let moments = Moments::of_record(&record, 43, 3);
        let in_theta = Coordinates::in_theta(basis);
        let equations = NormalEquations::new(&moments, &in_theta, &[-0.9]);
        let equilibrated = equations.equilibrated();
        let rows = PivotedPrefix::row_by_row(basis, &equations, &equilibrated);
        let blocks = PivotedPrefix::of_all(basis, &equations, &equilibrated).unwrap();
        assert_eq!((rows.excited(), blocks.excited()), (41, 41));
        for i in 0..=41 {
            // Pivots are above 1e-7, so their square roots keep eight digits at least.
            let close = |a: f64, b: f64| assert_relative_eq!(a, b, epsilon = 1e-8);
            close(
                rows.projected[i] / rows.projected[0],
                blocks.projected[i] / blocks.projected[0],
            );
            assert_eq!(rows.scale[i], blocks.scale[i]);
            (0..=41).for_each(|j| close(rows.lower[(i, j)], blocks.lower[(i, j)]));
        }
    }
}
