//! Exports of the servo model: each is run in its program, against servoid's own integrator under the command that the file
//! states.

mod ardupilot;
mod c;
mod jsbsim;
mod motion_interval;
mod mujoco;
mod rates;
mod refusals;
mod scripts;
mod smooth;
mod statements;
mod subjects;
mod warnings;

pub(super) use subjects::{AIRCRAFT, SERVOS};
