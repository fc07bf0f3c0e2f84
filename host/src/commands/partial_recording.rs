//! The outcome of a command that has left a partial recording: an exit code of its own.

use std::fmt;

/// A recording was written, and something of its run is missing.
#[derive(Debug)]
pub struct PartialRecording {
    sentence: String,
    result: Option<String>,
}

impl PartialRecording {
    /// Exit code of the program: neither success nor an error that left nothing.
    pub const EXIT_CODE: u8 = 3;

    /// With the sentence that says what is missing.
    pub(super) fn named(sentence: String) -> Self {
        let result = None;
        Self { sentence, result }
    }

    /// As the user wanted it, with the result of the command.
    pub(super) fn asked_for(result: String) -> Self {
        Self {
            sentence: "stopped by the user".to_owned(),
            result: Some(result),
        }
    }

    /// The result for standard output, where there is one.
    pub fn result(&self) -> Option<&str> {
        self.result.as_deref()
    }
}

impl fmt::Display for PartialRecording {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.sentence)
    }
}

impl std::error::Error for PartialRecording {}
