//! The evidence behind the findings on a model.

use crate::data::{Record, References, Run};
use crate::diagnostics::explanation::Explanation;
use crate::diagnostics::linearity::Linearity;
use crate::diagnostics::misfit::Misfit;
use crate::diagnostics::misfit::slow_errors::SlowErrors;
use crate::diagnostics::validity::Validity;
use crate::numerics::with_unit;
use crate::options::Options;
use crate::results::{Model, Reason};

/// What advice is drawn from.
pub(crate) struct Evidence<'a> {
    /// The model, whose bounds are withdrawn already where they do not hold.
    pub(crate) model: &'a Model,
    /// Whether they hold, and what the input does not determine.
    pub(crate) validity: &'a Validity,
    pub(crate) explanation: &'a Explanation,
    pub(crate) options: &'a Options,
    /// With its disturbances; `None` where moments came without their record.
    pub(crate) recorded: Option<&'a Record<'a>>,
    /// Samples of the record, missing ones included.
    pub(crate) samples: usize,
}

impl<'a> Evidence<'a> {
    /// What the run of this number, from 1, is called: its label, or else its number.
    pub(super) fn run_name(&self, number: usize) -> String {
        let run = self
            .recorded
            .and_then(|record| record.runs().get(number.checked_sub(1)?));
        let label = run.and_then(Run::label);
        label.map_or_else(|| number.to_string(), |label| label.to_string())
    }

    /// A number of the input as a sentence has it, with its unit where that is known.
    pub(super) fn input(&self, number: impl std::fmt::Display) -> String {
        self.with_unit(0, number)
    }

    /// A number of the output likewise.
    pub(super) fn output(&self, number: impl std::fmt::Display) -> String {
        self.with_unit(1, number)
    }

    fn with_unit(&self, column: usize, number: impl std::fmt::Display) -> String {
        let unit = self.recorded.map_or("", |record| record.units()[column]);
        with_unit(number, unit)
    }

    /// Whether the model has bounds, of which advice may speak.
    pub(super) fn has_bounds(&self) -> bool {
        self.model.bounds.valid().is_some()
    }

    /// What was found when the errors are not noise.
    pub(super) fn misfit(&self) -> Option<&'a Misfit> {
        self.explanation.model_errors.as_ref()
    }

    /// Whether the errors are more than noise, so that they do not show how large the noise is.
    pub(super) fn errors_follow_motion(&self) -> bool {
        let linearity = self.explanation.linearity.as_ref();
        self.misfit().is_some() || linearity.is_some_and(Linearity::errors_follow_motion)
    }

    /// Whether runs have the same reference as others.
    pub(super) fn has_runs_of_one_order(&self) -> bool {
        (self.recorded).is_some_and(|record| References::repeat(record.runs()))
    }

    /// Errors that are slow, where they are not noise.
    pub(super) fn slow_errors(&self) -> Option<SlowErrors> {
        self.misfit()?;
        SlowErrors::of(self.recorded?, self.model)
    }

    /// Whether bounds are withdrawn because the input follows the output.
    pub(super) fn is_closed_loop(&self) -> bool {
        self.validity.level.withdrawn() == Some(Reason::InputFollowsOutput)
    }

    /// Half the sampling rate.
    pub(super) fn nyquist_hz(&self) -> f64 {
        0.5 / self.model.sample_period_s
    }
}

/// A number with its first two digits.
pub(super) fn two_digits(number: f64) -> String {
    let decimals = (1.0 - number.log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{number:.decimals$}")
}
