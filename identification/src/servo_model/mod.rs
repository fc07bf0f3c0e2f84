//! The servo as a machine: one nonlinear model that predicts servos which are not linear.
//!
//! A motor behind a position controller, with delay, limited drive, two speeds, dead band, play, friction and load, as far as
//! prediction needs them. The [equation](ServoParameters) has one integrator. The fit is by simulation error:
//! the record becomes stretches with a start each, a coarse search finds the valley, a ladder of terms is climbed by
//! prediction of parts that the fit has not seen, and the covariance and the servos that predict as well give intervals and
//! bands. `docs/servo-model.md` has measured tables.
//!
//! From a record to a servo, in this order: `stretches`, `descent` (the fit of chosen terms), `terms` (which are chosen),
//! `uncertainty`, `candidates` (whether others predict as well), `motion` and `quantities` (what people ask of it), `model` (the result).
//! `estimate` leads through them.

mod beside_linear;
mod candidates;
mod descent;
mod estimate;
mod model;
mod motion;
mod quantities;
mod runs_alone;
mod search_progress;
mod search_setup;
mod stretches;
mod terms;
mod uncertainty;

#[cfg(test)]
mod coverage;
#[cfg(test)]
mod tests;

pub use beside_linear::fit_beside;
pub use descent::coordinates::{Coordinate, LoadKind, Terms};
pub use estimate::{ServoModelOptions, fit, fit_watched};
pub(crate) use model::StopsDocument;
pub use model::hysteresis::UnexplainedHysteresis;
pub use model::prediction::no_prediction;
pub use model::sine_response::SineResponse;
pub use model::stall::Stall;
pub use model::{
    Alternative, Covariance, LadderRung, LinearKind, LinearModelFit, LinearModels, ServoFit,
    ServoModel, ServoResponse, WaitsForPulses,
};
pub use motion::command_range::CommandRange;
pub use motion::reached_speeds::ReachedSpeeds;
pub use motion::recorded_motion::RecordedMotion;
pub use quantities::quantity_kind::QuantityKind;
pub use quantities::{Quantity, Spread, Unit};
pub use search_progress::Watch;
pub use servoid_dynamics::{
    AtRest, DriveLimit, Friction, Load, PulseEnd, ServoParameters, SpeedLimit, Stops,
};
