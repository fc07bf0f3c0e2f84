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
mod jsbsim;
mod julia;
mod matlab;
mod python;
mod scripts;
mod statement;
mod text;

use crate::data::model_metadata::ModelMetadata;
use servoid_identification::Model;
use servoid_identification::flight_model::{self, FlightModel, FlightModelOptions};

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

/// Why there is no export. The text says what to do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ExportError {
    /// The target is a ratio of polynomials.
    #[error(
        "a JSBSim actuator needs a low-order model, and there is none ({0}): export to c or csv, or record larger steps"
    )]
    NoLowOrder(String),
}

/// A model, ready to be written.
#[derive(Clone, Debug)]
pub struct Export<'a> {
    /// What the servo is called; any text.
    pub name: &'a str,
    /// Where the model comes from; any text.
    pub source: &'a str,
    /// The model.
    pub model: &'a Model,
    /// The model of low order, or why there is none.
    pub low_order: Result<FlightModel, String>,
    /// Units, and the pulse frame that holds a command before the servo, where they are known.
    pub metadata: ModelMetadata,
}

impl<'a> Export<'a> {
    /// A model with the low-order model that was fitted with it, or else one that is fitted now.
    #[must_use]
    pub fn new(
        name: &'a str,
        source: &'a str,
        model: &'a Model,
        fitted: Option<FlightModel>,
        metadata: ModelMetadata,
    ) -> Self {
        let options = FlightModelOptions {
            frame_period_s: metadata.pulse_frame_s.filter(|frame| *frame > 0.0),
            ..FlightModelOptions::default()
        };
        let low_order = match fitted {
            Some(fitted) => Ok(fitted),
            None => flight_model::of_model(model, &options).map_err(|error| error.to_string()),
        };
        Self {
            name,
            source,
            model,
            low_order,
            metadata,
        }
    }

    /// The frame that holds a command in what is written \[s\]: 0 where there is none, or none is known.
    fn frame_s(&self) -> f64 {
        self.metadata.pulse_frame_s.unwrap_or(0.0)
    }

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

    /// Largest distance of the low-order model's step response from the identified one at any sample
    /// but the last, which gathers what comes later \[% of the step\]; at least what its own fit says.
    pub(crate) fn largest_error_percent(&self, flight: &FlightModel) -> f64 {
        let step = &self.model.step.value;
        let count = step.len().saturating_sub(1);
        let discrete = flight.transfer.discrete(self.model.timing());
        let gain = step.last().copied().unwrap_or(f64::NAN).abs();
        let response = discrete.simulate(&vec![1.0; count], 0.0);
        let errors = response
            .iter()
            .zip(step)
            .map(|(a, b)| 100.0 * (a - b).abs() / gain);
        errors.fold(flight.largest_error_percent, f64::max)
    }

    /// The name as text within a language, with what has a meaning there escaped: `signs` get a
    /// backslash before them, as the backslash itself does.
    fn quoted_name(&self, signs: &[char]) -> String {
        let mut safe = String::new();
        for letter in text::plain(self.name).chars() {
            if letter == '\\' || signs.contains(&letter) {
                safe.push('\\');
            }
            safe.push(letter);
        }
        safe
    }
}
