//! The forecast of a run: the width of the step response's band, the spectrum of the reference, and the questions
//! that it cannot answer.
//!
//! Of a simulated servo, simulated runs are identified as real ones will be. Only trying shows how much speed
//! limit, dead band and friction widen the band.
//!
//! Of a servo that is known by its model alone, only the linear part can be forecast. The width of a band then
//! depends on the reference, the noise and the settling time; the response itself does not enter. The width
//! comes from the covariance of generalised least squares, σ² (Z_D'Z_D)^-1, with the regressor Z of this
//! reference and the stated noise σ, D. The structure (N, n) is not known before the data are, so it comes from
//! identifications of simulated runs.

mod alternatives;
mod answerable_questions;
mod assumed_servo;
mod band_width;
mod beyond_stops;
mod error;
mod expectation;
mod forecast;
mod motion;
mod needed_runs;
mod plot;
mod request;
mod servo_quantities;
mod simulated_runs;
mod spectrum;
mod text;

pub use alternatives::Alternative;
pub use answerable_questions::Answer;
pub use assumed_servo::{AssumedServo, AssumedServoError, is_servo_model};
pub use band_width::{BandWidths, RunsNeeded};
pub use error::PlanError;
pub use forecast::Plan;
pub use plot::figure;
pub use request::PlanRequest;
pub use servo_quantities::ServoQuantities;
pub use spectrum::{Density, Octave, Spectrum};
pub use text::of_plan;

pub(crate) use band_width::NarrowingBand;

#[cfg(test)]
mod tests;
