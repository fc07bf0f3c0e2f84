//! A comment line as a table.

use toml::{Table, Value};

/// Why a line above the rows is no comment.
pub(super) const NO_COMMENT: &str = "it is not of the form '# key = value'";

/// A comment is the inside of a TOML inline table: `key = value, key = value`.
pub(super) fn comment_table(comment: &[u8]) -> Result<Table, &'static str> {
    let text = std::str::from_utf8(comment).map_err(|_| "it is not UTF-8 text")?;
    let table: Result<Table, _> = toml::from_str(&format!("line = {{ {} }}", text.trim()));
    match table.map(|mut table| (table.remove("line"), table.is_empty())) {
        Ok((Some(Value::Table(inner)), true)) => Ok(inner),
        _ => Err(NO_COMMENT),
    }
}
