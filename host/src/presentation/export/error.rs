//! Why a model cannot be written for a target.

/// There is no export. The text names the remedy.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ExportError {
    /// The target is a ratio of polynomials.
    #[error(
        "a JSBSim actuator needs a low-order model, and there is none ({0}): export to c or csv, or record larger steps"
    )]
    NoLowOrder(String),
}
