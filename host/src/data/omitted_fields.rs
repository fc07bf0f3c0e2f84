//! What is not stated is left out of a document.

/// Whether a number is the one that stands for no statement.
#[expect(clippy::trivially_copy_pass_by_ref)] // serde passes references
pub(crate) fn is_zero(number: &f64) -> bool {
    *number == 0.0
}
