//! A damage in a file.

/// Something that is not as it was written.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::data::recording) struct Damage {
    /// Row, from 1; `None` for the lines above the rows.
    pub(in crate::data::recording) row: Option<usize>,
    /// Line, from 1.
    pub(in crate::data::recording) line: usize,
    /// The fault.
    pub(in crate::data::recording) reason: String,
}
