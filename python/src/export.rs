//! The options of an export.

use pyo3::prelude::*;
use servoid::analysis::ExportRequest;
use servoid::presentation::export::Target;

/// The options of `servoid export`, the target as a word.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct ExportOptions {
    to: String,
    servo_model: bool,
    controller: Option<f64>,
    step_ms: Option<f64>,
    full_command: Option<f64>,
    frame_ms: Option<f64>,
    name: String,
    source: String,
}

impl ExportOptions {
    /// What they ask for.
    ///
    /// # Errors
    /// There is no such target, or the options do not fit it or each other.
    pub(crate) fn request(self) -> anyhow::Result<ExportRequest> {
        let request = ExportRequest {
            target: self.to.parse::<Target>().map_err(anyhow::Error::msg)?,
            servo_model: self.servo_model,
            controller: self.controller,
            step_ms: self.step_ms,
            full_command: self.full_command,
            frame_ms: self.frame_ms,
            name: self.name,
            source: self.source,
        };
        request.check().map_err(anyhow::Error::msg)?;
        Ok(request)
    }
}
