//! The direction-split model: separate responses for up and down strokes.
//!
//! A loaded servo responds differently to up and down strokes, which no linear model can follow. Beside the
//! bank on the command u, the model has a second, short bank on the magnitude of its changes:
//!
//! ```text
//! y(k) = sum_i h_i u(k-i) + sum_i δ_i |u(k-i) - u(k-i-1)| + c + v(k)
//! g_up = g + δ,  g_down = g - δ
//! ```
//!
//! where g is the running sum of h. A stroke of size a upwards moves the output by a g_up(m), a stroke
//! downwards by -a g_down(m). δ vanishes after N samples, so both settle on one static line. A servo whose
//! gain differs between levels needs the level table of [`crate::nonlinear::limits`].
//!
//! A servo is asymmetric when δ leaves its simultaneous 99.9 % bounds around zero and the difference exceeds
//! 2 % of the stroke. Other nonlinearities of a symmetric servo, such as limited speed or play, also affect
//! δ: by up to 1.4 % on simulated servos, outside the bounds in one run of six.

#[cfg(test)]
mod tests;
mod two_inputs;

use faer::Mat;
use serde::{Deserialize, Serialize};

use crate::data::{Record, Run, Timing};
use crate::error::Error;
use crate::estimation::{Coordinates, CurveVariance, FsfBasis};
use crate::numerics::{
    causal_filter, chi_square_upper_tail, dot, pointwise_critical, simultaneous_critical,
    student_critical, symmetric_eigen, times,
};
use crate::options::NoiseOrder;
use crate::results::{Biases, Bounds, Interval, Model, StepBounds, StepResponse, fit_percent};
use crate::thresholds::{ASYMMETRY_FALSE_ALARM, MATERIAL_ASYMMETRY};
use two_inputs::{TwoInputFit, TwoInputMoments};

/// Number of frequencies of the bank on |du|. With fewer, truncation bias would pass for asymmetry.
const FREQUENCIES: usize = 31;

/// Directions of the covariance below this share of the largest are rounding.
const ROUNDING: f64 = 1e-10;

/// Whether up and down strokes differ.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Symmetry {
    /// Probability of parameters δ at least this far from zero if the servo is symmetric (Wald's
    /// test, χ² with as many degrees of freedom as δ has parameters).
    pub p: f64,
    /// Largest |δ_m| in standard deviations.
    pub largest_deviation: f64,
    /// Critical value, which `largest_deviation` exceeds with probability 0.001 if the servo is symmetric.
    pub critical_value: f64,
    /// `largest_deviation` exceeds `critical_value`, and the difference is more than 2 % of the
    /// stroke.
    pub asymmetric: bool,
    /// Largest difference g_up - g_down \[share of the stroke\].
    pub largest_difference: f64,
    /// When it occurs, after the edge \[s\].
    pub at_s: f64,
}

/// A model with one response to up strokes and one to down strokes.
#[derive(Debug, Clone)]
pub struct DirectionModel {
    /// N \[samples\].
    pub settling_samples: usize,
    /// d.
    pub noise_order: usize,
    /// Response to a unit step upwards. Its last value is the gain, as in [`StepResponse`].
    pub up: StepResponse,
    /// Response to a unit step downwards, inverted.
    pub down: StepResponse,
    /// Whether the two differ, where bounds hold: the test takes the errors for noise.
    pub symmetry: Bounds<Symmetry>,
    /// 100 (1 - |y - ŷ| / |y - mean y|), ŷ simulated from the input alone.
    pub simulation_percent: f64,
    /// Confidence level of the bands, where they hold.
    pub level: Bounds<f64>,
    pub(crate) fit: SplitFit,
}

/// Parameters and covariance of the fit, from which models are compared.
#[derive(Debug, Clone)]
pub(crate) struct SplitFit {
    /// Coordinates of the response to u, parameters of δ, offset about the centre.
    pub(crate) parameters: Vec<f64>,
    pub(crate) covariance: Mat<f64>,
    /// From parameters to g, N rows.
    pub(crate) step_map: Mat<f64>,
    /// From parameters to δ, N rows.
    pub(crate) split_map: Mat<f64>,
    centre: (f64, f64, f64),
    pub(crate) degrees_of_freedom: f64,
}

impl SplitFit {
    /// Rows of g_up, then of g_down: 2N x p.
    pub(crate) fn curves_map(&self) -> Mat<f64> {
        let n = self.step_map.nrows();
        Mat::from_fn(2 * n, self.step_map.ncols(), |i, k| {
            let sign = if i < n { 1.0 } else { -1.0 };
            self.step_map[(i % n, k)] + sign * self.split_map[(i % n, k)]
        })
    }

    /// Weights of the parameters in the output at rest at the command `u`, and its constant part.
    fn level_weights(&self, u: f64) -> (Vec<f64>, f64) {
        let last = self.step_map.nrows() - 1;
        let columns = self.step_map.ncols();
        let weights = (0..columns)
            .map(|k| {
                let split: f64 = self.split_map.col_as_slice(k).iter().sum();
                let offset = f64::from(u8::from(k + 1 == columns));
                self.step_map[(last, k)] * (u - self.centre.0) - split * self.centre.1 + offset
            })
            .collect();
        (weights, self.centre.2)
    }
}

/// Fits the direction-split model with the settling time, bank and level of a plain `model` of the
/// same record.
///
/// ```
/// use servoid_identification::{nonlinear::split_by_direction, identify, Options, Record, Settling};
/// // Up quickly, down slowly.
/// let u: Vec<f64> = (0..3000).map(|k| if k / 120 % 2 == 0 { 5.0 } else { -5.0 }).collect();
/// let y: Vec<f64> = u.iter().enumerate().scan(5.0, |y, (k, u)| {
///     *y += if u > y { 0.3 } else { 0.1 } * (u - *y);
///     Some(*y + 0.01 * ((k * 7919 % 101) as f64 - 50.0) / 50.0)
/// }).collect();
/// let record = Record::of_run(0.002, &u, &y)?;
/// let options = Options { settling: Settling::Samples(81), ..Options::default() };
/// let both = split_by_direction(&record, &identify(&record, &options)?)?;
/// assert!(both.asymmetric() && both.up.value[5] > both.down.value[5] + 0.2);
/// assert!((both.level_at(5.0).value.unwrap() - 5.0).abs() < 0.02);
/// # Ok::<(), servoid_identification::Error>(())
/// ```
///
/// # Errors
/// The record has too few samples, or strokes in one direction only, which do not separate the two
/// responses.
pub fn split_by_direction(record: &Record, model: &Model) -> Result<DirectionModel, Error> {
    split_with(record, model.basis()?, NoiseOrder::Auto, model.level())
}

/// [`split_by_direction`] with a given bank, noise order and level.
///
/// # Errors
/// As [`split_by_direction`].
pub(crate) fn split_with(
    record: &Record,
    basis: FsfBasis,
    order: NoiseOrder,
    level: Bounds<f64>,
) -> Result<DirectionModel, Error> {
    let settling = basis.settling();
    let second = changes_bank(settling)?;
    let moments = TwoInputMoments::of_record(record, settling);
    let parameters = basis.frequencies() + second.frequencies() + 1;
    let needed = 2 * parameters;
    let refused = Error::TooFewSamples {
        usable: moments.rows,
        history: settling + 1,
        parameters,
        needed,
    };
    if moments.rows < needed {
        return Err(refused);
    }
    let coordinates = Coordinates::new(basis);
    let Some(fit) = two_inputs::fit(&moments, &coordinates, &second, order) else {
        return Err(Error::OneDirection);
    };
    let timing = record.timing();
    Ok(build(&moments, &coordinates, &second, fit, timing, level))
}

/// The bank on |du| for a settling time.
pub(crate) fn changes_bank(settling: usize) -> Result<FsfBasis, Error> {
    let full = FsfBasis::full(settling)?.frequencies();
    FsfBasis::new(settling, FREQUENCIES.min(full))
}

fn build(
    moments: &TwoInputMoments,
    coordinates: &Coordinates,
    second: &FsfBasis,
    fit: TwoInputFit,
    timing: Timing,
    level: Bounds<f64>,
) -> DirectionModel {
    let (n, n2) = (coordinates.len(), second.frequencies());
    let p = n + n2 + 1;
    let (step, impulse) = (coordinates.step_map(), second.impulse_map());
    let settling = step.nrows();
    let within = |columns: std::ops::Range<usize>, map: &Mat<f64>| {
        Mat::from_fn(settling, p, |m, k| {
            if columns.contains(&k) {
                map[(m, k - columns.start)]
            } else {
                0.0
            }
        })
    };
    let split = SplitFit {
        step_map: within(0..n, &step),
        split_map: within(n..n + n2, &impulse),
        parameters: fit.parameters,
        covariance: fit.covariance,
        centre: moments.centre,
        degrees_of_freedom: fit.degrees_of_freedom,
    };
    let curves = split.curves_map();
    let half = |from: usize| {
        let map = Mat::from_fn(settling, p, |m, k| curves[(from + m, k)]);
        let spread = CurveVariance::of_functions(&map, &split.covariance, split.degrees_of_freedom);
        let value = times(&map, &split.parameters);
        let bounds = level.map(|level| StepBounds::new(&value, &spread, level, Biases::default()));
        StepResponse::new(timing.sample_period_s, value, bounds)
    };
    let symmetry = level.map(|_| symmetry(&split, n..n + n2, timing));
    DirectionModel {
        settling_samples: settling,
        noise_order: fit.ar.len(),
        up: half(0),
        down: half(settling),
        symmetry,
        simulation_percent: fit_percent(fit.error, moments.output_spread),
        level,
        fit: split,
    }
}

fn symmetry(split: &SplitFit, parameters: std::ops::Range<usize>, timing: Timing) -> Symmetry {
    let spread = CurveVariance::of_functions(
        &split.split_map,
        &split.covariance,
        split.degrees_of_freedom,
    );
    let delta = times(&split.split_map, &split.parameters);
    let deviation = |m: usize| {
        if spread.sd[m] > 0.0 {
            delta[m].abs() / spread.sd[m]
        } else {
            0.0
        }
    };
    let largest_deviation = (0..delta.len()).map(deviation).fold(0.0, f64::max);
    let normal = simultaneous_critical(&spread.neighbour_correlation, 1.0 - ASYMMETRY_FALSE_ALARM);
    let critical_value = student_critical(normal, &[split.degrees_of_freedom])[0];
    let at = (0..delta.len())
        .max_by(|&a, &b| delta[a].abs().total_cmp(&delta[b].abs()))
        .unwrap_or(0);
    let size = parameters.len();
    let block = Mat::from_fn(size, size, |i, j| {
        split.covariance[(parameters.start + i, parameters.start + j)]
    });
    let (statistic, degrees) = wald(&split.parameters[parameters], &block);
    Symmetry {
        p: chi_square_upper_tail(statistic, degrees),
        largest_deviation,
        critical_value,
        asymmetric: largest_deviation > critical_value
            && 2.0 * delta[at].abs() > MATERIAL_ASYMMETRY,
        largest_difference: 2.0 * delta[at],
        at_s: timing.seconds(at as f64),
    }
}

/// x'C^-1 x over the directions of C that are not rounding, and their number.
pub(crate) fn wald(x: &[f64], covariance: &Mat<f64>) -> (f64, usize) {
    let Some(eigen) = symmetric_eigen(covariance) else {
        return (0.0, 0);
    };
    let turned = times(&eigen.vectors.transpose().to_owned(), x);
    let largest = eigen.values.iter().copied().fold(0.0, f64::max);
    (0..x.len())
        .filter(|&i| eigen.values[i] > ROUNDING * largest)
        .fold((0.0, 0), |(sum, count), i| {
            (sum + turned[i] * turned[i] / eigen.values[i], count + 1)
        })
}

impl DirectionModel {
    /// Whether up and down strokes differ by enough to matter. Without bounds nothing is known of that.
    pub fn asymmetric(&self) -> bool {
        self.symmetry.valid().is_some_and(|found| found.asymmetric)
    }

    /// The output at rest at a constant command, on the static line of the model. It is valid for a record
    /// with two levels. With more levels, a servo whose gain depends on the level is not on one line.
    pub fn level_at(&self, command: f64) -> Interval {
        let (weights, constant) = self.fit.level_weights(command);
        let value = constant + dot(&weights, &self.fit.parameters);
        let sd = dot(&weights, &times(&self.fit.covariance, &weights))
            .max(0.0)
            .sqrt();
        let half = self.level.valid().map(|level| {
            let normal = pointwise_critical(*level);
            sd * student_critical(normal, &[self.fit.degrees_of_freedom])[0]
        });
        Interval::around(value, half)
    }
    /// The output that the model gives for the input of `run`, one value per sample. NaN where the history of N + 1 input
    /// samples is not complete; with [`Run::with_input_at_rest`] it is complete from the first sample on.
    #[must_use]
    pub fn simulate(&self, run: &Run) -> Vec<f64> {
        let fit = &self.fit;
        let step = self.mean_step();
        let before = std::iter::once(&0.0).chain(&step);
        let impulse: Vec<f64> = step.iter().zip(before).map(|(g, b)| g - b).collect();
        let (input, at_rest) = (run.input(), run.input_at_rest());
        let earlier = std::iter::once(at_rest.unwrap_or(f64::NAN)).chain(input.iter().copied());
        let changes: Vec<f64> = input
            .iter()
            .zip(earlier)
            .map(|(u, before)| (u - before).abs())
            .collect();
        let by_level = causal_filter(&impulse, input, at_rest);
        let split = times(&fit.split_map, &fit.parameters);
        let by_changes = causal_filter(&split, &changes, at_rest.map(|_| 0.0));
        let offset = self.offset();
        let both = by_level.iter().zip(by_changes);
        both.map(|(a, b)| a + b + offset).collect()
    }

    /// g, the mean of the responses to strokes up and down.
    pub(crate) fn mean_step(&self) -> Vec<f64> {
        times(&self.fit.step_map, &self.fit.parameters)
    }

    /// The output at rest at the command 0.
    pub(crate) fn offset(&self) -> f64 {
        let (weights, constant) = self.fit.level_weights(0.0);
        constant + dot(&weights, &self.fit.parameters)
    }
}
