#![doc = include_str!("../README.md")]
//!
//! # The method
//!
//! The output is y(k) = φ(k)'θ + c + ε(k)/D(z): the filters φ of the input ([`fsf_basis`]), whose parameters
//! θ are the frequency response, an offset, and autoregressive noise ([`noise_model`]).
//!
//! A [`record`] is reduced to its lagged [`moments`] in one pass. Least squares ([`least_squares`]) and
//! generalised least squares ([`gls`]) follow from the moments for any bank and noise filter, and so does the
//! [`choice`] of the structure. The [`variance`] of the estimate and the
//! [`critical_values`] give its bounds, to which the [`truncation`] bias is added. The results are a
//! [`step_response`], a [`frequency_response`] and [`metrics`] in a [`model`]. [`residual_tests`] and
//! [`advice`] show how far to trust it.
//!
//! Sources: L. Wang and W. R. Cluett, *From Plant Data to Process Control*, 2000 (the filters);
//! D. W. Clarke, "Generalised least squares estimation", IFAC 1967; S. Worsley, "An improved
//! Bonferroni inequality", Biometrika 1982; F. E. Satterthwaite, Biometrics 1946.

pub mod comparison;
mod data;
mod diagnostics;
mod error;
mod estimation;
pub mod flight_model;
mod identify;
mod nonlinear;
mod numerics;
pub mod options;
mod results;
mod selection;
pub mod thresholds;

pub use data::quantisation;
pub use data::{moments, record, timing};
pub use diagnostics::explanation::Explanation;
pub use diagnostics::{
    correlogram, explanation, initial_rest, linearity, misfit, residual_tests, run_scatter,
    standstill_noise,
};
pub use error::Error;
pub use estimation::{
    excitation, fsf_basis, gls, least_squares, nested_banks, noise_model, qr, truncation, variance,
};
pub use identify::{Identification, identify, identify_explained, identify_moments};
pub use nonlinear::{direction, limits};
pub use numerics::{convolution, critical_values};
pub use options::{Frequencies, NoiseOrder, Options, Settling};
pub use record::{Record, Run};
pub use results::advice::Advice;
pub use results::model::Model;
pub use results::validation::Validation;
pub use results::{
    advice, frequency_response, metrics, model, residuals, servo_response, step_response,
    validation, validity,
};
pub use selection::{choice, settling_range};
