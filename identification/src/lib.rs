#![doc = include_str!("../README.md")]
//!
//! # The method
//!
//! The output is y(k) = φ(k)'θ + c + ε(k)/D(z): frequency sampling filters φ of the input whose
//! parameters θ are the frequency response itself ([`basis`]), a constant, and autoregressive noise.
//! Generalised least squares finds θ and D in turn ([`gls`]). The bounds are Student's, with every
//! degree of freedom counted ([`curve`], [`band`]); what leaving out frequencies may hide is added to
//! them ([`truncation`]).
//!
//! # The way through the crate
//!
//! record → [`moments`] (one pass) → [`normal`] (least squares for any bank and noise filter) →
//! [`gls`] → [`curve`] and [`band`] → [`step`], [`frequency`], [`metrics`] → [`model`]. The [`structure`] is
//! chosen from the moments; [`residual`] tests and [`advice`] say how far to trust the result;
//! [`mod@reference`] is the slow and obvious way that the tests hold all of it against.
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

pub use data::quantisation;
pub use data::{moments, record, timing};
pub use diagnostics::explanation::Explanation;
pub use diagnostics::{
    correlogram, explanation, initial_rest, linearity, misfit, residual_tests, run_scatter,
    standstill_noise,
};
pub use error::Error;
pub use estimation::{
    direct, excitation, fsf_basis, gls, least_squares, nested_banks, noise_model, qr, truncation,
    variance,
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
pub use selection::settling_time;
