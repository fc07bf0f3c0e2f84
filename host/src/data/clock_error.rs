//! The error of a board's internal oscillator, in words.

use servoid_protocol::hello::INTERNAL_CLOCK_ERROR;

/// The least and the most, such as "-1 to +1 %".
pub fn internal_clock_error() -> String {
    let [slow, fast] = INTERNAL_CLOCK_ERROR.map(|share| 100.0 * share);
    format!("{slow} to +{fast} %")
}
