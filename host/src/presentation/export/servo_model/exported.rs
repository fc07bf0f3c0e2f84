//! The result of an export.

use super::difference::Difference;
use super::subject::ServoExport;
use super::terms::Term;
use super::trial_command::Trial;
use crate::presentation::export::error::ExportError;

/// A file, and how far it is from the servo model.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportedServo {
    /// The file.
    pub text: String,
    /// The command under which the difference was computed.
    pub trial: Trial,
    /// The largest difference of the position under that command \[unit of the position\].
    pub largest_difference: f64,
    /// The largest where every stroke is held or broken off once, without the repeated reversals \[unit of the position\].
    pub largest_difference_in_strokes: f64,
    /// Its root mean square over all of the command \[unit of the position\].
    pub root_mean_square_difference: f64,
    /// What whoever uses the file must know: what to apply beside it, and what was assumed. The difference is that of a position so computed.
    pub remarks: Vec<String>,
    /// What limits the use of the file: that it is far from the servo and what its program lacks, or that its steps are long.
    pub warnings: Vec<String>,
    /// Whether it is closer to the servo than one that stands still.
    follows: bool,
}

/// A file that is farther from the servo than this part of the largest stroke lacks something that counts: of the servos in
/// docs/servo-model.md those that lack none are within 6.4 %, all others beyond 34 %.
const FAR: f64 = 0.1;

/// Largest commanded strokes by which a file that goes where it is sent, late and beyond a stop, is never wrong.
const RUNS_AWAY: f64 = 2.0;

impl ExportedServo {
    /// Text with its difference, of a file that gives the position.
    ///
    /// # Errors
    /// The motion has no end, so there is no difference.
    pub(super) fn new(text: String, difference: Difference) -> Result<Self, ExportError> {
        match difference.root_mean_square.is_finite() {
            true => Ok(Self {
                text,
                trial: difference.trial,
                follows: difference.follows,
                largest_difference: difference.largest,
                largest_difference_in_strokes: difference.largest_in_strokes,
                root_mean_square_difference: difference.root_mean_square,
                remarks: Vec::new(),
                warnings: Vec::new(),
            }),
            false => Err(ExportError::Endless),
        }
    }

    /// The same, of a program that lacks these terms.
    ///
    /// # Errors
    /// It does not follow.
    pub(super) fn lacking(
        self,
        export: &ServoExport<'_>,
        program: &str,
        terms: &[Term],
    ) -> Result<Self, ExportError> {
        let found = self.that_follows(export, || {
            format!(
                "as {}: export to c, python, julia or matlab (--servo-model), which {}",
                what_lacks(export, program, terms),
                what_languages_have(export)
            )
        })?;
        Ok(found.warned_where_far(export, || {
            format!(
                "{}; c, python, julia and matlab {}",
                what_lacks(export, program, terms),
                what_languages_have(export)
            )
        }))
    }

    /// The same, unless a servo that stands still is closer to the servo model, or a stroke that is held or broken off once is wrong by
    /// [`RUNS_AWAY`]; `why` says why, and what to do.
    ///
    /// # Errors
    /// It is.
    pub(super) fn that_follows(
        self,
        export: &ServoExport<'_>,
        why: impl FnOnce() -> String,
    ) -> Result<Self, ExportError> {
        let stroke = self.trial.largest_commanded(&export.parameters);
        match self.follows && self.largest_difference_in_strokes < RUNS_AWAY * stroke {
            true => Ok(self),
            false => Err(ExportError::FollowsNothing {
                percent: export.percent_of_strokes(&self),
                why: why(),
            }),
        }
    }

    /// The same with a warning where it is [`FAR`] from the servo model; `why` says why, and what to do.
    pub(super) fn warned_where_far(
        self,
        export: &ServoExport<'_>,
        why: impl FnOnce() -> String,
    ) -> Self {
        let is_far = self.largest_difference >= FAR * self.trial.largest_travel(&export.parameters);
        let warning = is_far.then(|| {
            format!(
                "this file is up to {} % of the largest stroke away from the servo model in repeated reversals ({} % in strokes that are held or broken off once): {}",
                export.percent_of_largest(&self),
                export.percent_of_strokes(&self),
                why()
            )
        });
        self.warned(warning)
    }

    /// The same with another warning, if there is one.
    pub(super) fn warned(mut self, warning: Option<String>) -> Self {
        self.warnings.extend(warning);
        self
    }

    /// The same of a file of which these are to be said.
    pub(super) fn with(self, remarks: impl IntoIterator<Item = String>) -> Self {
        Self {
            remarks: remarks.into_iter().collect(),
            ..self
        }
    }
}

/// What the files for languages have of the equation.
fn what_languages_have(export: &ServoExport<'_>) -> &'static str {
    match export.parameters.pulse_end {
        None => "have all of it",
        Some(_) => "have all of it but that longer pulses act later",
    }
}

/// "JSBSim leaves out the load", or that it has all terms and moves in another way.
fn what_lacks(export: &ServoExport<'_>, program: &str, terms: &[Term]) -> String {
    match export.names_of(terms) {
        names if names.is_empty() => {
            format!("{program} has a servo of another kind, which moves in another way")
        }
        names => format!("{program} leaves out {names}"),
    }
}
