//! Numbers as people read them, and without what rounding leaves.

/// `value`, or 0 where rounding made it negative. What is not a number stays so: a maximum with 0 would make it 0, and bounds without width of a variance that
/// could not be computed.
pub(crate) fn not_negative(value: f64) -> f64 {
    if value < 0.0 { 0.0 } else { value }
}

/// A number with four digits, for sentences: angles come from whole microseconds or counts.
pub(crate) fn four_digits(number: f64) -> f64 {
    format!("{number:.3e}").parse().unwrap_or(number)
}

/// A number with two digits: what is known of a standard deviation. However small it is, it does not read as nothing.
pub(crate) fn two_digits(number: f64) -> f64 {
    format!("{number:.1e}").parse().unwrap_or(number)
}

/// A number with its unit; alone where that is empty, as it is not known.
pub fn with_unit(number: impl std::fmt::Display, unit: &str) -> String {
    match unit {
        "" => number.to_string(),
        unit => format!("{number} {unit}"),
    }
}

/// A command with its sign, where `least` of those beside it is below 0. Pulse widths, and others on one side of 0, are positions and have none.
pub fn command_in_words(command: f64, least: f64) -> String {
    match least < 0.0 {
        true => format!("{command:+}"),
        false => command.to_string(),
    }
}

/// A number with six digits: 99 rather than 99.00000000000001.
#[must_use]
pub fn six_digits(number: f64) -> f64 {
    format!("{number:.5e}").parse().unwrap_or(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_command_to_both_sides_has_a_sign() {
        assert_eq!(command_in_words(1650.0, 1358.0), "1650");
        assert_eq!(command_in_words(10.0, 0.0), "10");
        assert_eq!(command_in_words(10.0, -10.0), "+10");
        assert_eq!(command_in_words(-10.0, -10.0), "-10");
    }
}
