//! Numbers without digits that nobody reads.

/// Six digits: 2 rather than 2.0000000000000004.
pub fn six_digits(number: f64) -> f64 {
    format!("{number:.5e}").parse().unwrap_or(number)
}
