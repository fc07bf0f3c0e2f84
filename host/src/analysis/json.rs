//! Results as the program writes them.

use anyhow::{Context, Result};
use serde::Serialize;

/// A result as indented JSON with a final line end.
///
/// # Errors
/// A number has no form in JSON.
pub fn to_json(value: &impl Serialize) -> Result<String> {
    Ok(serde_json::to_string_pretty(value).context("the result cannot be written as JSON")? + "\n")
}
