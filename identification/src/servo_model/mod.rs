//! The servo as a machine: one nonlinear model that predicts real servos.

mod coordinates;
#[cfg(test)]
mod coverage;
mod estimate;
mod fit;
mod ladder;
mod model;
mod physics;
mod quantities;
mod search;
mod simulation;
mod start;
mod stretches;
mod uncertainty;
mod validity;

pub use coordinates::{Coordinate, LoadKind, Terms};
pub use estimate::{ServoModelOptions, fit};
pub use model::{Covariance, LadderRung, ServoFit, ServoModel, ServoResponse};
pub use quantities::{Quantity, Unit};
