//! The same model as a script, a header or a fragment for other programs.
//!
//! Every file states its sample times, units and signs, the origin of the model, and its bounds or why there are
//! none. The finite impulse response is exact. The low-order model, for programs that need a ratio of
//! polynomials, states its difference from it.

mod csv;
mod error;
mod jsbsim;
mod languages;
mod model;
mod statement;
mod text;

pub use error::ExportError;
pub use model::Export;

/// The target program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Target {
    /// A script with tf and frd, which Octave runs too
    Matlab,
    /// A module with numpy, and python-control where it is there
    Python,
    /// A module without packages; objects of ControlSystems.jl
    Julia,
    /// A C99 header: impulse response and state space, no allocation
    C,
    /// A table: step and frequency response with bounds
    #[value(alias = "simulink-csv")]
    Csv,
    /// A system with the actuator: hold, delay and poles
    Jsbsim,
}

impl Target {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Matlab,
        Self::Python,
        Self::Julia,
        Self::C,
        Self::Csv,
        Self::Jsbsim,
    ];
}

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
        })
    }
}
