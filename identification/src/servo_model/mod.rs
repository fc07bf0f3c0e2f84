//! The servo as a machine: one nonlinear model that predicts servos which are not linear.
//!
//! A motor behind a position controller, with delay, limited drive, two speeds, dead band, friction and load, as far as
//! prediction needs them. The [equation](ServoParameters) has one integrator. The fit is by simulation error:
//! the record becomes stretches with a start each, a coarse search finds the valley, a ladder of terms is climbed by
//! prediction of parts that the fit has not seen, and the covariance and the servos that predict as well give intervals and
//! bands. `docs/servo-model.md` has measured tables.

mod beside_linear;
mod candidates;
mod command_range;
mod coordinates;
mod covariance;
mod current_limit;
mod cut_crests;
mod descent;
mod descent_of_offsets;
mod descent_step;
mod discrepancy;
mod error_row;
mod estimate;
mod fit;
mod hidden_parts;
mod hysteresis;
mod initial_state;
mod lack_of_fit;
mod ladder;
mod level_crests;
mod limit_at_work;
mod model;
mod motion;
mod neighbouring_terms;
mod noise_at_rest;
mod offset;
mod old_quantities;
mod other_fits;
mod other_valleys;
mod possible_servo;
mod prediction;
mod quantities;
mod quantity_kind;
mod reached_speeds;
mod recorded_motion;
mod run_offsets;
mod score_test;
mod search_progress;
mod speed_on_ladder;
mod starting_values;
mod stepped_outputs;
mod stiction;
mod stops;
mod stretches;
mod stroke_time;
mod unequal_sides;
mod validity;

#[cfg(test)]
mod coverage;
#[cfg(test)]
mod tests;

pub use beside_linear::fit_beside;
pub use command_range::CommandRange;
pub use coordinates::{Coordinate, LoadKind, Terms};
pub use estimate::{ServoModelOptions, fit, fit_watched};
pub use hysteresis::UnexplainedHysteresis;
pub(crate) use model::StopsDocument;
pub use model::{
    Alternative, Covariance, LadderRung, LinearKind, LinearModelFit, LinearModels, ServoFit,
    ServoModel, ServoResponse,
};
pub use prediction::no_prediction;
pub use quantities::{Quantity, Spread, Unit};
pub use quantity_kind::QuantityKind;
pub use reached_speeds::ReachedSpeeds;
pub use recorded_motion::RecordedMotion;
pub use search_progress::Watch;
pub use servoid_dynamics::{
    AtRest, DriveLimit, Friction, Load, ServoParameters, SpeedLimit, Stops,
};
