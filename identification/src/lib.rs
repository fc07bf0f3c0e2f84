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

pub mod advice;
pub mod at_rest;
pub mod band;
pub mod basis;
mod chebyshev;
pub mod comparison;
pub mod convolution;
pub mod correlogram;
pub mod curve;
pub mod direction;
pub mod error;
pub mod excitation;
pub mod explanation;
pub mod factor;
mod fft;
pub mod flight_model;
pub mod frequency;
pub mod gls;
pub mod identify;
mod lag_products;
mod lagged_sums;
pub mod limits;
mod linear;
pub mod linearity;
mod low_passed;
mod matrix_serde;
pub mod metrics;
pub mod model;
pub mod model_error;
pub mod moments;
pub mod nested;
pub mod noise;
pub mod normal;
pub mod options;
pub mod record;
pub mod reference;
mod repetition;
pub mod residual;
pub mod resolution;
pub mod rest;
pub mod runs;
mod simulated;
pub mod step;
pub mod structure;
pub mod timing;
pub mod truncation;
pub mod validation;

pub use advice::Advice;
pub use error::Error;
pub use explanation::Explanation;
pub use identify::{Identification, identify, identify_explained, identify_moments};
pub use model::Model;
pub use options::{Frequencies, NoiseOrder, Options, Settling};
pub use record::{Record, Run};
pub use validation::Validation;
