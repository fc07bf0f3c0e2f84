//! The same model as a script, a header or a fragment for other programs.
//!
//! Every file states its sample times, units and signs, the origin of the model, and its bounds or why there are
//! none. The finite impulse response is exact. The low-order model, for programs that need a ratio of
//! polynomials, states its difference from it. The [servo model](servo_model) is the equation itself, or what comes closest
//! to it in a program that has servos of its own.

mod csv;
mod doubts;
mod emulation;
mod error;
mod frame_hold;
mod jsbsim;
mod jsbsim_delay;
mod languages;
mod model;
pub mod servo_model;
mod statement;
mod strokes;
mod target;
mod text;
mod unseen_limit;

pub use error::ExportError;
pub use model::Export;
pub use target::Target;
pub(crate) use text::identifier;

impl Export<'_> {
    /// The text of the file.
    ///
    /// # Errors
    /// [`ExportError`].
    pub fn write(&self, target: Target) -> Result<String, ExportError> {
        Ok(match target {
            Target::Matlab => languages::matlab(self),
            Target::Python => languages::python(self),
            Target::Julia => languages::julia(self),
            Target::C => languages::c(self),
            Target::Csv => csv::write(self),
            Target::Jsbsim => jsbsim::write(self)?,
            Target::Ardupilot | Target::Mujoco => return Err(ExportError::NeedsServoModel),
        })
    }
}
