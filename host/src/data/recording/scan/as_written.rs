//! Undoes the changes that editors and other systems make to text.

use crate::data::table::BYTE_ORDER_MARK;
use memchr::{memchr_iter, memmem};
use std::borrow::Cow;

/// A file without a byte order mark, carriage returns before every line end, and empty lines at the end.
/// All of that can be taken out again without a doubt, and the CRCs then prove the rest.
pub(super) fn as_written(bytes: &[u8]) -> Cow<'_, [u8]> {
    let bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    let returns = memmem::find_iter(bytes, b"\r\n").count();
    if returns == 0 || returns < memchr_iter(b'\n', bytes).count() {
        return Cow::Borrowed(bytes.get(..end(bytes)).unwrap_or_default());
    }
    let lines = bytes.split(|&byte| byte == b'\n');
    let lines: Vec<&[u8]> = lines
        .map(|line| line.strip_suffix(b"\r").unwrap_or(line))
        .collect();
    let mut text = lines.join(&b'\n');
    text.truncate(end(&text));
    Cow::Owned(text)
}

/// Length without empty lines at the end.
fn end(text: &[u8]) -> usize {
    let last = text.iter().rposition(|&byte| byte != b'\n');
    last.map_or(1, |last| last + 2).min(text.len())
}
