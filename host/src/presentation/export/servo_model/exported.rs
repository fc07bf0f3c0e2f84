//! The result of an export.

use super::trial_command::{Difference, Trial};
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
    /// Its root mean square \[unit of the position\].
    pub root_mean_square_difference: f64,
    /// What whoever uses the file must know: what to apply beside it, and what was assumed. The difference is that of a position so computed.
    pub remarks: Vec<String>,
}

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
                largest_difference: difference.largest,
                root_mean_square_difference: difference.root_mean_square,
                remarks: Vec::new(),
            }),
            false => Err(ExportError::Impossible),
        }
    }

    /// The same of a file of which these are to be said.
    pub(super) fn with(self, remarks: impl IntoIterator<Item = String>) -> Self {
        Self {
            remarks: remarks.into_iter().collect(),
            ..self
        }
    }
}
