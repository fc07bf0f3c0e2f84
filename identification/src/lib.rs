#![doc = include_str!("../README.md")]
//!
//! # The method
//!
//! The output is y(k) = φ(k)'θ + c + ε(k)/D(z): the filters φ of the input (frequency sampling filters, FSF), whose
//! parameters θ are the frequency response, an offset, and autoregressive noise.
//!
//! A [`Record`] is reduced to its lagged [`Moments`] in one pass. Least squares and generalised least squares
//! follow from the moments for any bank of filters and any noise filter, and so does the choice of the structure.
//! The covariance of the estimate and critical values give its bounds, to which the bias of frequencies that were
//! left out is added. The [`results`] are a step response, a frequency response and metrics in a
//! [`Model`](results::Model). [`diagnostics`] show how far to trust it, and [`nonlinear`] what no linear model has.
//!
//! Sources: L. Wang and W. R. Cluett, *From Plant Data to Process Control*, 2000 (the filters);
//! D. W. Clarke, "Generalised least squares estimation", IFAC 1967; S. Worsley, "An improved
//! Bonferroni inequality", Biometrika 1982; F. E. Satterthwaite, Biometrics 1946.

mod error;
pub mod thresholds;

mod options;

mod numerics;

mod data;
mod estimation;
pub mod results;
mod selection;

pub mod diagnostics;
pub mod flight_model;
pub mod nonlinear;
pub mod servo_model;

pub mod comparison;
mod identify;

#[cfg(test)]
mod tests;

pub use data::{MomentStream, Moments, Quantisation, Record, Run, Timing, column, only_stroke};
pub use error::Error;
pub use identify::{
    Identification, expected_model, identify, identify_explained, identify_moments,
};
pub use options::{Detrend, Frequencies, NoiseOrder, Options, Prior, Settling};
