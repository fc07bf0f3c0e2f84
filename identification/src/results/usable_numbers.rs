//! Numbers of documents that were read from elsewhere.

/// The largest number in a document that was read from elsewhere: products of four such numbers are
/// still numbers.
pub(crate) const LARGEST: f64 = 1e75;

/// Whether a number can be computed with.
pub(crate) fn is_usable(value: &f64) -> bool {
    value.abs() <= LARGEST
}

/// Whether these are `length` numbers that can be computed with.
pub(crate) fn is_sized(values: &[f64], length: usize) -> bool {
    values.len() == length && values.iter().all(is_usable)
}
