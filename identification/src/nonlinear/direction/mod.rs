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

mod slow_end_of_split;
mod split_fit;
#[cfg(test)]
mod tests;
mod two_inputs;

use faer::Mat;
use serde::{Deserialize, Serialize};

use crate::data::{Record, Run, Timing};
use crate::error::Error;
use crate::estimation::{Coordinates, CurveVariance, FsfBasis};
use crate::numerics::{
    chi_square_upper_tail, dot, pointwise_critical, simultaneous_critical, student_critical,
    symmetric_eigen, times,
};
use crate::options::NoiseOrder;
use crate::results::{
    Biases, Bounds, Interval, Model, Reason, SelectedBy, StepBounds, StepResponse, fit_percent,
};
use crate::thresholds::{ASYMMETRY_FALSE_ALARM, MATERIAL_ASYMMETRY};
use slow_end_of_split::allow_for_slow_end;
use split_fit::SplitFit;
use two_inputs::TwoInputMoments;

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
    /// Largest difference g_up - g_down \[share of the stroke, which is what the servo moves: the gain for each unit of the command\].
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
    /// Response to a unit step of the input upwards. Its last value is the gain, as in [`StepResponse`].
    pub up: StepResponse,
    /// Response to a unit step of the input downwards, inverted.
    pub down: StepResponse,
    /// Whether the two differ, where bounds hold: the test takes the errors for noise.
    pub symmetry: Bounds<Symmetry>,
    /// 100 (1 - |y - ŷ| / |y - mean y|), ŷ simulated from the input alone.
    pub simulation_percent: f64,
    /// Confidence level of the bands, where they hold.
    pub level: Bounds<f64>,
    pub(crate) fit: SplitFit,
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
    split_with(
        record,
        model.basis()?,
        NoiseOrder::Auto,
        model.level(),
        |split| model.structure.selected_by == SelectedBy::Auto && explains_errors(model, split),
    )
}

/// [`split_by_direction`] with a given bank, noise order and level. `may_go_on` says of the fit \[percent\] of the split model whether the response may go on beyond the settling
/// time of a complete bank.
///
/// # Errors
/// As [`split_by_direction`].
pub(crate) fn split_with(
    record: &Record,
    basis: FsfBasis,
    order: NoiseOrder,
    level: Bounds<f64>,
    may_go_on: impl FnOnce(f64) -> bool,
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
    let mut split = SplitFit::new(&moments, &coordinates, &second, &fit);
    let simulation_percent = fit_percent(fit.error, moments.output_spread);
    let ends_unseen = may_go_on(simulation_percent)
        && basis.is_complete()
        && !allow_for_slow_end(record, &moments, (&coordinates, &second), &fit, &mut split);
    let level = level.unless(ends_unseen.then_some(Reason::EndUnseen));
    Ok(DirectionModel::new(
        split,
        fit.ar.len(),
        simulation_percent,
        record.timing(),
        level,
    ))
}

/// The share of what is not linear that is most of it.
const MOST: f64 = 0.5;

/// Whether a response for each direction, with this fit \[percent\], explains most of what a servo has beside the linear `model`. Else its errors follow the motion as those
/// of the linear one do, and look like slow ends.
pub(crate) fn explains_errors(model: &Model, split: f64) -> bool {
    let beyond = model
        .residuals
        .beyond_linear_percent
        .filter(|_| !model.linear);
    let square = |percent: f64| (percent / 100.0).powi(2);
    let explained = square(100.0 - model.fit.simulation_percent) - square(100.0 - split);
    beyond.is_none_or(|beyond| explained > MOST * square(beyond))
}

/// The bank on |du| for a settling time.
pub(crate) fn changes_bank(settling: usize) -> Result<FsfBasis, Error> {
    let full = FsfBasis::full(settling)?.frequencies();
    FsfBasis::new(settling, FREQUENCIES.min(full))
}

fn symmetry(split: &SplitFit, timing: Timing) -> Symmetry {
    let parameters = split.of_changes.clone();
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
    // Commands in µs have gains of a tenth of a degree: δ alone is no share of a stroke.
    let largest_difference = 2.0 * delta[at] / split.gain();
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
            && largest_difference.abs() > MATERIAL_ASYMMETRY,
        largest_difference,
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
    fn new(
        split: SplitFit,
        noise_order: usize,
        simulation_percent: f64,
        timing: Timing,
        level: Bounds<f64>,
    ) -> Self {
        let (settling, p) = (split.step_map.nrows(), split.step_map.ncols());
        let curves = split.curves_map();
        let half = |from: usize| {
            let map = Mat::from_fn(settling, p, |m, k| curves[(from + m, k)]);
            let spread =
                CurveVariance::of_functions(&map, &split.covariance, split.degrees_of_freedom);
            let value = times(&map, &split.parameters);
            let bounds =
                level.map(|level| StepBounds::new(&value, &spread, level, Biases::default()));
            StepResponse::new(timing.sample_period_s, value, bounds)
        };
        Self {
            settling_samples: settling,
            noise_order,
            up: half(0),
            down: half(settling),
            symmetry: level.map(|_| symmetry(&split, timing)),
            simulation_percent,
            level,
            fit: split,
        }
    }

    /// Whether up and down strokes differ by enough to matter. Without bounds nothing is known of that.
    pub fn asymmetric(&self) -> bool {
        self.symmetry.valid().is_some_and(|found| found.asymmetric)
    }

    /// The final value, which strokes up and down have in common.
    #[must_use]
    pub fn gain(&self) -> Interval {
        let last = |of: &[f64]| of.last().copied().unwrap_or(f64::NAN);
        let (lower, upper) = match self.up.bounds.valid() {
            Some(bounds) => (last(&bounds.pointwise.lower), last(&bounds.pointwise.upper)),
            None => (f64::NAN, f64::NAN),
        };
        Interval::new(last(&self.up.value), lower, upper)
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
        self.fit.simulate(run)
    }

    /// g, the mean of the responses to strokes up and down.
    pub(crate) fn mean_step(&self) -> Vec<f64> {
        self.fit.mean_step()
    }

    /// The output at rest at the command 0.
    pub(crate) fn offset(&self) -> f64 {
        self.fit.offset()
    }
}
