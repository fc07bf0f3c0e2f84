//! All banks n = 1, 3, 5, ... of one settling time from one factorisation.
//!
//! With the offset first and the frequencies ascending, the Cholesky factor of the largest bank
//! contains that of every smaller one, so the residual sum of squares, the standard deviations and
//! the uppermost frequencies of all banks cost no more than those of one.

use faer::Mat;

use crate::basis::Basis;
use crate::linear::inverse_of_lower;
use crate::moments::Moments;
use crate::normal::{Coordinates, NormalEquations};
use crate::truncation::unit_biases;

/// A squared pivot of the equilibrated equations below this means: a combination of lower
/// frequencies, not excited by itself.
const SMALLEST_PIVOT: f64 = 1e-9;

/// What one bank would give.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct BankCandidate {
    /// n.
    pub frequencies: usize,
    /// Generalised cross-validation: rows RSS / (rows - n - 1)².
    pub gcv: f64,
    /// Mean 99 % half width of the step response from the noise alone.
    pub noise_half_width: f64,
    /// Bound of the error from the frequencies left out, at 20 dB/decade.
    pub truncation_bias: f64,
}

impl BankCandidate {
    /// Half width of the honest band: noise and truncation together.
    #[must_use]
    pub fn half_width(&self) -> f64 {
        self.noise_half_width + self.truncation_bias
    }
}

/// Every bank of one settling time that the input excites.
pub(crate) struct NestedBanks {
    pub(crate) candidates: Vec<BankCandidate>,
}

impl NestedBanks {
    /// Scans the banks for one settling time and noise filter. `None` when not even the gain is
    /// determined.
    pub(crate) fn scan(
        moments: &Moments,
        settling: usize,
        ar: &[f64],
        roll_off: i32,
    ) -> Option<Self> {
        let basis = Basis::full(settling).ok()?;
        let in_theta = Coordinates::in_theta(basis);
        let factor = PivotedPrefix::new(&NormalEquations::new(moments, &in_theta, ar));
        let excited = factor.excited();
        if excited == 0 {
            return None;
        }
        let inverse = inverse_of_lower(&factor.lower);
        // F = Q L^-T for the step response, columns: offset first.
        let step = in_theta.step_map();
        let size = excited + 1;
        let scaled = Mat::from_fn(size, settling, |k, m| {
            if k == 0 {
                0.0
            } else {
                step[(m, k - 1)] * factor.scale[k]
            }
        });
        let spread = &inverse * scaled; // F', size x N
        let biases = unit_biases(settling, roll_off);
        let rows = moments.rows as f64;
        let critical = crate::band::pointwise_critical(0.99);
        let mut rss = factor.total - factor.projected[0].powi(2);
        let mut variances = vec![0.0; settling];
        let mut candidates = Vec::new();
        for k in 1..size {
            rss -= factor.projected[k].powi(2);
            for (m, variance) in variances.iter_mut().enumerate() {
                *variance += spread[(k, m)].powi(2);
            }
            if k % 2 == 0 {
                continue;
            }
            let dof = (rows - (k + 1 + ar.len()) as f64).max(1.0);
            let sigma = (rss.max(0.0) / dof).sqrt();
            let mean_sd = sigma * variances.iter().map(|v| v.sqrt()).sum::<f64>() / settling as f64;
            candidates.push(BankCandidate {
                frequencies: k,
                gcv: rows * rss.max(0.0) / (rows - (k + 1) as f64).max(1.0).powi(2),
                noise_half_width: critical * mean_sd,
                truncation_bias: factor.edge_magnitude(&inverse, k, sigma) * biases[k / 2],
            });
        }
        Some(Self { candidates })
    }

    /// The bank with the narrowest honest band.
    pub(crate) fn narrowest(&self) -> BankCandidate {
        self.best(BankCandidate::half_width)
    }

    /// The bank that predicts best.
    pub(crate) fn best_predictor(&self) -> BankCandidate {
        self.best(|candidate| candidate.gcv)
    }

    fn best(&self, merit: impl Fn(&BankCandidate) -> f64) -> BankCandidate {
        *self
            .candidates
            .iter()
            .min_by(|a, b| merit(a).total_cmp(&merit(b)))
            .expect("a scan has at least the bank of the gain")
    }

    /// The largest bank that the input excites.
    pub(crate) fn largest(&self) -> BankCandidate {
        self.candidates[self.candidates.len() - 1]
    }
}

/// The Cholesky factor of the equilibrated equations, offset first, as far as pivots are sound.
struct PivotedPrefix {
    lower: Mat<f64>,
    scale: Vec<f64>,
    /// L^-1 b.
    projected: Vec<f64>,
    /// Sum of squares of the filtered output.
    total: f64,
}

impl PivotedPrefix {
    fn new(equations: &NormalEquations) -> Self {
        let (a, scale) = equations.equilibrated();
        let p = scale.len();
        // The offset is last in the equations and first here.
        let original = |k: usize| if k == 0 { p - 1 } else { k - 1 };
        let mut lower = Mat::<f64>::zeros(p, p);
        let mut projected = Vec::with_capacity(p);
        for k in 0..p {
            let mut pivot = a[(original(k), original(k))];
            for j in 0..k {
                // Row k of L: earlier rows are known.
                let known: f64 = (0..j).map(|i| lower[(i, k)] * lower[(i, j)]).sum();
                let entry = (a[(original(k), original(j))] - known) / lower[(j, j)];
                lower[(j, k)] = entry;
                pivot -= entry * entry;
            }
            if pivot.is_nan() || pivot < SMALLEST_PIVOT {
                break;
            }
            lower[(k, k)] = pivot.sqrt();
            let known: f64 = (0..k).map(|i| lower[(i, k)] * projected[i]).sum();
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
            // Built as rows of L in columns, for contiguous inner products.
            lower: Mat::from_fn(size, size, |i, j| if j <= i { lower[(j, i)] } else { 0.0 }),
            scale: (0..size).map(|k| scale[original(k)]).collect(),
            projected,
            total: equations.c,
        }
    }

    /// Odd number of frequencies that are excited.
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
