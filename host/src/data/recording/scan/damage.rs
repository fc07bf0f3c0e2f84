//! What is wrong with a file, and where.

/// Something that is not as it was written.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::data::recording) struct Damage {
    /// Row, from 1; `None` for the lines above the rows.
    pub(in crate::data::recording) row: Option<usize>,
    /// Line, from 1.
    pub(in crate::data::recording) line: usize,
    /// What is wrong.
    pub(in crate::data::recording) reason: String,
}

impl Damage {
    /// Damage above the rows.
    pub(super) fn above_rows(line: usize, reason: impl Into<String>) -> Self {
        Self {
            row: None,
            line,
            reason: reason.into(),
        }
    }

    /// Damage at a row.
    pub(super) fn at_row(row: usize, line: usize, reason: impl Into<String>) -> Self {
        Self {
            row: Some(row),
            line,
            reason: reason.into(),
        }
    }
}
