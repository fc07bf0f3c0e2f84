//! The result: a servo, how sure it is, and how it was chosen.

use super::coordinates::{Coordinate, Point, Terms};
use super::fit::MOST;
use super::quantities::Quantity;
use super::simulation::{Grid, Start, simulate};
use super::start::find_starts;
use super::stretches::stretches;
use crate::data::{Record, Run};
use crate::error::Error;
use crate::numerics::{Dual, Scalar};
use crate::results::{Bounds, Noise, fit_percent, pointwise_critical};
use serde::{Deserialize, Serialize};

/// Longest step of the integration \[s\].
pub(super) const LONGEST_STEP_S: f64 = 1e-3;

/// The servo as a machine: see the [module](super).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ServoModel {
    /// Sample period of the record \[s\].
    pub sample_period_s: f64,
    /// Time from the edge of the input to the sample of the output that belongs to it \[s\].
    pub sample_phase_s: f64,
    /// The terms of the equation that prediction needs.
    pub terms: Terms,
    /// Controllers that drove the same mechanism.
    pub controllers: usize,
    /// Radians for each unit of the command, which a load that turns with the shaft needs.
    pub radians_per_command: f64,
    /// The coordinates of the fit, in the order of `values` and of the covariance.
    pub coordinates: Vec<Coordinate>,
    /// Their values.
    pub values: Vec<f64>,
    /// Covariance of the coordinates, where bounds hold.
    pub covariance: Bounds<Covariance>,
    /// Parameters and what follows from them, in people's terms.
    pub quantities: Vec<Quantity>,
    /// How well it follows the record.
    pub fit: ServoFit,
    /// Noise of the errors of simulation.
    pub noise: Noise,
    /// What was tried, in order.
    pub ladder: Vec<LadderRung>,
}

/// Covariance of the coordinates, and the level of bounds that are made of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Covariance {
    /// Confidence level.
    pub level: f64,
    /// Rows of the covariance.
    pub rows: Vec<Vec<f64>>,
}

/// How well a servo follows a record.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ServoFit {
    /// 100 (1 - |y - ŷ| / |y - mean y|), simulated from the input alone.
    pub simulation_percent: f64,
    /// The same for parts of the record that the fit had not seen.
    pub held_out_percent: f64,
    /// The same for a linear servo of second order.
    pub linear_held_out_percent: f64,
    /// Root mean square of the errors.
    pub rmse: f64,
    /// Samples used.
    pub samples_used: usize,
    /// Samples without an output, or without an input.
    pub samples_missing: usize,
}

/// Terms that were tried.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LadderRung {
    /// The terms.
    pub terms: Terms,
    /// Fit of what it had not seen \[%\].
    pub held_out_percent: f64,
    /// Fit of the whole record \[%\].
    pub fit_percent: f64,
    /// Whether it was chosen.
    pub chosen: bool,
}

/// A simulated response with its bounds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ServoResponse {
    /// The output, sample by sample.
    pub value: Vec<f64>,
    /// Half width of the band about each sample, at the level of the model: that of the servo's own response, without
    /// the noise of the sensor.
    #[serde(flatten)]
    pub half_width: Bounds<Vec<f64>>,
}

impl ServoModel {
    /// The point of the search that it stands for.
    pub(super) fn point(&self) -> Point {
        Point {
            terms: self.terms,
            coordinates: self.coordinates.clone(),
            values: self.values.clone(),
            radians: self.radians_per_command,
        }
    }

    fn grid(&self) -> Grid {
        Grid::new(self.sample_period_s, self.sample_phase_s, LONGEST_STEP_S)
    }

    /// The response of the servo with the controller number `controller` (from 0) to `input`, from rest at the first
    /// command.
    #[must_use]
    pub fn respond(&self, input: &[f64], controller: usize) -> ServoResponse {
        let Some(first) = input.first() else {
            return ServoResponse {
                value: Vec::new(),
                half_width: self.covariance.as_ref().map(|_| Vec::new()),
            };
        };
        let point = self.point();
        let physics = point.physics(controller, |i, value| Dual::<MOST>::variable(value, i));
        let start = Start {
            output: physics.resting_output(Dual::constant(*first)),
            rate: Dual::constant(0.0),
            command_before: Some(Dual::constant(*first)),
        };
        let mut value = Vec::with_capacity(input.len());
        let mut half = Vec::with_capacity(input.len());
        let covariance = self.covariance.valid();
        let critical = covariance.map_or(f64::NAN, |found| pointwise_critical(found.level));
        simulate(&physics, &self.grid(), &start, input, |_, y| {
            value.push(y.value);
            if let Some(found) = covariance {
                half.push(critical * quadratic(&found.rows, &y.slope).max(0.0).sqrt());
            }
        });
        ServoResponse {
            value,
            half_width: self.covariance.as_ref().map(|_| half),
        }
    }

    /// The output of each run of a record, simulated from its input and its first samples. NaN where an input is missing,
    /// until the motion is known again. `controllers` has the controller of each run; without it, all have the first.
    ///
    /// # Errors
    /// The record has another sample period.
    pub fn simulate(&self, record: &Record, controllers: &[usize]) -> Result<Vec<Vec<f64>>, Error> {
        let (expected, found) = (self.sample_period_s, record.sample_period_s());
        if ((found - expected) / expected).abs() > 1e-6 {
            return Err(Error::PeriodMismatch { expected, found });
        }
        let point = self.point();
        let grid = Grid::new(found, record.sample_phase_s(), LONGEST_STEP_S);
        let (mut parts, _) = stretches(record, controllers);
        find_starts(&mut parts, &point, &grid);
        let unknown = |run: &Run| vec![f64::NAN; run.len()];
        let mut outputs: Vec<Vec<f64>> = record.runs().iter().map(unknown).collect();
        for part in &parts {
            let physics = point.physics(part.controller, |_, value| value);
            let output = &mut outputs[part.run][part.first..];
            simulate(&physics, &grid, &part.start, &part.input, |k, y| output[k] = y);
        }
        Ok(outputs)
    }

    /// How well the model predicts a record that it has not seen \[%\].
    ///
    /// # Errors
    /// As [`ServoModel::simulate`].
    pub fn predict_percent(&self, record: &Record, controllers: &[usize]) -> Result<f64, Error> {
        let simulated = self.simulate(record, controllers)?;
        let measured = record.runs().iter().map(Run::output);
        let pairs = || measured.clone().flatten().zip(simulated.iter().flatten());
        let known = || pairs().filter(|(y, predicted)| !(*y - *predicted).is_nan());
        let count = known().count() as f64;
        let mean = known().map(|(y, _)| y).sum::<f64>() / count;
        let error = known().map(|(y, predicted)| (y - predicted).powi(2)).sum();
        let spread = known().map(|(y, _)| (y - mean).powi(2)).sum();
        Ok(fit_percent(error, spread))
    }

    /// Whether the servo is linear: no term but delay, stiffness and damping helps prediction.
    #[must_use]
    pub fn is_linear(&self) -> bool {
        self.terms == Terms::default()
    }
}

/// s'Cs.
fn quadratic(rows: &[Vec<f64>], slopes: &[f64]) -> f64 {
    let row = |(row, a): (&Vec<f64>, &f64)| a * row.iter().zip(slopes).map(|(c, b)| c * b).sum::<f64>();
    rows.iter().zip(slopes).map(row).sum()
}
