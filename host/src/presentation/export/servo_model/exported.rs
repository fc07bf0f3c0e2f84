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
    /// What turns that which the program gives into the position, a sentence; `None` where the file does so. The difference is that of such
    /// a position.
    pub beside: Option<String>,
}

impl ExportedServo {
    /// Text with its difference, of a file that gives the position.
    ///
    /// # Errors
    /// The motion has no end, so there is no difference.
    pub(super) fn new(text: String, difference: Difference) -> Result<Self, ExportError> {
        match difference.largest.is_finite() {
            true => Ok(Self {
                text,
                trial: difference.trial,
                largest_difference: difference.largest,
                root_mean_square_difference: difference.root_mean_square,
                beside: None,
            }),
            false => Err(ExportError::Impossible),
        }
    }

    /// The same of a file that needs this beside it.
    pub(super) fn with(self, beside: String) -> Self {
        Self {
            beside: Some(beside),
            ..self
        }
    }
}
