//! Why a reference cannot be made of a specification.

use super::kind::Kind;
use crate::data::table::TableError;

/// Why a reference cannot be made of a specification. The text names the remedy.
#[derive(Debug, thiserror::Error)]
pub enum ReferenceError {
    /// An option that does not apply to this reference.
    #[error("{option} is not for the reference {kind}: it is for {instead}")]
    NotFor {
        /// The option.
        option: &'static str,
        /// The reference.
        kind: Kind,
        /// The references that the option applies to.
        instead: &'static str,
    },
    /// A number out of its range.
    #[error("{0}")]
    OutOfRange(String),
    /// The table of steps.
    #[error(transparent)]
    Table(#[from] TableError),
}
