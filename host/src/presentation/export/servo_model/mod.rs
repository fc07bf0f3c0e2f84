//! The servo as a machine for other programs: its equation where they compute, and what comes closest to it where they
//! have a servo of their own.
//!
//! C, Python, Julia and MATLAB get the equation and its steps. JSBSim, ArduPilot and MuJoCo get the parameters of their own
//! servos. Every file states its largest difference from servoid's integrator under a [command](Trial) that it names, and what it
//! leaves out.

mod ardupilot;
mod broken_off_stroke;
mod delay_in_steps;
mod difference;
mod exported;
mod fixed_step;
mod full_command;
mod jsbsim;
mod languages;
mod load_mass;
mod motion_interval;
mod mujoco;
mod rate_limit;
mod recorded_range;
mod smooth_command;
mod speed_by_drive;
mod statement;
mod subject;
mod terms;
mod trial_command;
mod worst_command;

pub use exported::ExportedServo;
pub(crate) use jsbsim::STEP_S as JSBSIM_STEP_S;
pub use subject::{ServoExport, ServoExportOptions};
pub use trial_command::{Held, Trial};

use super::error::ExportError;
use super::target::Target;

impl ServoExport<'_> {
    /// The file for a target.
    ///
    /// # Errors
    /// The target cannot have this servo, or the step is too long for it.
    pub fn write(&self, target: Target) -> Result<ExportedServo, ExportError> {
        match target {
            Target::C => languages::c(self),
            Target::Python => languages::python(self),
            Target::Julia => languages::julia(self),
            Target::Matlab => languages::matlab(self),
            Target::Csv => Err(ExportError::NoTableOfServoModel),
            Target::Jsbsim => jsbsim::write(self),
            Target::Ardupilot => ardupilot::write(self),
            Target::Mujoco => mujoco::write(self),
        }
    }
}
