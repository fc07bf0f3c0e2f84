//! The rows of a table.

/// Reads rows of any length; cells are trimmed where they are used, as trimming whole rows would copy
/// each of them.
pub(super) fn reader(rows: &[u8], separator: u8) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .delimiter(separator)
        .has_headers(false)
        .flexible(true)
        .from_reader(rows)
}
