//! Models to take away: the same model as a script, a header or a fragment for other programs.
//!
//! | target   | what is written                                                                    |
//! |----------|------------------------------------------------------------------------------------|
//! | matlab   | a script: structure with data, `tf` and `frd` (MATLAB, or Octave's control package) |
//! | python   | a module: numpy arrays, and python-control's objects where it is installed          |
//! | julia    | a module without packages, that can make objects of ControlSystems.jl               |
//! | c        | a C99 header: finite impulse response and discrete state space, without allocation  |
//! | csv      | a table: step and frequency response with bounds, parameters with their covariance  |
//! | jsbsim   | a system with the actuator, which is the low-order model, and the covariance of that |
//!
//! Each says how the samples lie, units and signs, where it comes from, what its bounds are and where
//! they do not hold. What is exact is the finite impulse response; the low-order model, for programs
//! that want a ratio of polynomials, says how far it is from it.

mod c;
mod csv;
mod described_model;
mod error;
mod jsbsim;
mod julia;
mod matlab;
mod python;
mod scripts;
mod statement;
mod text;

pub use described_model::Export;
pub use error::ExportError;
pub use text::identifier;

/// What a model is written for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// A MATLAB script, which Octave runs too.
    Matlab,
    /// A Python module.
    Python,
    /// A Julia module.
    Julia,
    /// A C99 header.
    C,
    /// A table.
    Csv,
    /// A JSBSim system.
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

    /// As the command line says it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Matlab => "matlab",
            Self::Python => "python",
            Self::Julia => "julia",
            Self::C => "c",
            Self::Csv => "csv",
            Self::Jsbsim => "jsbsim",
        }
    }
}

impl Export<'_> {
    /// The text of the file.
    ///
    /// # Errors
    /// [`ExportError`].
    pub fn write(&self, target: Target) -> Result<String, ExportError> {
        Ok(match target {
            Target::Matlab => matlab::write(self),
            Target::Python => python::write(self),
            Target::Julia => julia::write(self),
            Target::C => c::write(self),
            Target::Csv => csv::write(self),
            Target::Jsbsim => jsbsim::write(self)?,
        })
    }
}
