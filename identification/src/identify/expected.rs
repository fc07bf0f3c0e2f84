//! The model that is expected of a recording which has not been made.

use crate::data::{Moments, Record};
use crate::diagnostics::{SlowColumns, simulated_whole};
use crate::error::Error;
use crate::estimation::{Coordinates, CurveVariance, FsfBasis, GlsFit, GlsOptions, RowInformation};
use crate::numerics::matrix_rows::to_rows;
use crate::options::NoiseOrder;
use crate::results::{Bounds, Model, ParameterBounds, SelectedBy, StepBounds, StepResponse};

/// The model that records like `record` are expected to give of the servo `truth`: its response and noise, with
/// the structure of `example`, which was identified from a simulation of such a record. The covariance is that of
/// generalised least squares at this noise. Bounds have the `level`, where those of `example` hold and that noise is
/// known.
///
/// # Errors
/// The input does not determine the structure of `example`.
pub fn expected_model(
    example: &Model,
    record: &Record,
    truth: &Model,
    level: Bounds<f64>,
) -> Result<Model, Error> {
    let basis = example.basis()?;
    let (settling, order) = (basis.settling(), truth.noise.ar.len());
    let information =
        RowInformation::from_moments(Moments::of_record(record, settling + order, order + 1));
    let coordinates = Coordinates::new(basis);
    let options = GlsOptions {
        order: NoiseOrder::Order(order),
        start: truth.noise.ar.clone(),
        ..GlsOptions::default()
    };
    let not_excited = || Error::nothing_excited(basis.frequencies());
    let mut fit = GlsFit::of(&information, &coordinates, &options).ok_or_else(not_excited)?;
    // The covariance of D is the fit's; D and σ are the assumed ones.
    fit.ar.clone_from(&truth.noise.ar);
    fit.variance = truth.noise.sigma.powi(2);
    fit.solution = information
        .solve(&coordinates, &fit.ar)
        .ok_or_else(not_excited)?;
    if example.structure.selected_by == SelectedBy::Auto && basis.is_complete() {
        let moments = &information.moments;
        if let Some(columns) =
            SlowColumns::new(&simulated_whole(record, moments, &fit), moments, &fit, 0.0)
        {
            columns.expect_in(&mut fit);
        }
    }
    let spread = CurveVariance::of_fit(&information, &fit, &coordinates.step_map());
    let last = truth.step.value.last().copied().unwrap_or(0.0);
    let mut value = truth.step.value.clone();
    value.resize(settling, last);
    // The last element is the final value by definition.
    value[settling - 1] = last;
    let n = basis.frequencies();
    let covariance = fit.covariance().as_ref().submatrix(0, 0, n, n).to_owned();
    let known = level.zip(example.step.bounds.as_ref());
    let step_bounds =
        known.map(|(level, known)| StepBounds::new(&value, &spread, level, known.biases()));
    Ok(Model {
        theta: parameters(&basis, &value),
        bounds: level
            .zip(example.level())
            .map(|(_, level)| ParameterBounds {
                level,
                covariance: to_rows(&covariance),
            }),
        noise: truth.noise.clone(),
        step: StepResponse::new(example.sample_period_s, value, step_bounds),
        ..example.clone()
    })
}

/// The parameters θ of a step response.
fn parameters(basis: &FsfBasis, step: &[f64]) -> Vec<f64> {
    let analysis = basis.analysis_map();
    let before = std::iter::once(&0.0).chain(step);
    let impulse: Vec<f64> = step.iter().zip(before).map(|(g, b)| g - b).collect();
    let of_row = |row| {
        let products = impulse.iter().zip(0..).map(|(h, k)| analysis[(row, k)] * h);
        products.sum()
    };
    (0..basis.frequencies()).map(of_row).collect()
}
