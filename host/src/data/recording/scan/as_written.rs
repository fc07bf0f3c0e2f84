//! Undoes the changes that editors and other systems make to text.

use crate::data::table::BYTE_ORDER_MARK;
use std::borrow::Cow;

/// A file without a byte order mark, carriage returns before every line end, and empty lines at the end.
/// All of that can be taken out again without a doubt, and the CRCs then prove the rest.
pub(super) fn as_written(bytes: &[u8]) -> Cow<'_, [u8]> {
    let bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
    let ends = || memchr::memchr_iter(b'\n', bytes);
    let returns = ends().all(|end| end.checked_sub(1).and_then(|at| bytes.get(at)) == Some(&b'\r'));
    let mut bytes = match returns && ends().next().is_some() {
        true => Cow::Owned(without_returns(bytes)),
        false => Cow::Borrowed(bytes),
    };
    while bytes.ends_with(b"\n\n") {
        match &mut bytes {
            Cow::Owned(bytes) => drop(bytes.pop()),
            Cow::Borrowed(bytes) => *bytes = bytes.strip_suffix(b"\n").unwrap_or(bytes),
        }
    }
    bytes
}

fn without_returns(bytes: &[u8]) -> Vec<u8> {
    let mut kept = Vec::with_capacity(bytes.len());
    for line in bytes.split_inclusive(|&b| b == b'\n') {
        match line.strip_suffix(b"\r\n") {
            Some(line) => kept.extend(line.iter().chain(b"\n")),
            None => kept.extend(line),
        }
    }
    kept
}
