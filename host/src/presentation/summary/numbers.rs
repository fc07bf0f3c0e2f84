//! Numbers with the digits that mean something, and no others.

use servoid_identification::results::{Bounds, Interval, six_digits};

/// "p = 0.021"; a test that could not be made has none.
pub(crate) fn probability(p: Option<f64>) -> String {
    match p {
        None => "p = -".to_owned(),
        Some(p) if p < 0.001 => "p < 0.001".to_owned(),
        Some(p) => format!("p = {p:.3}"),
    }
}

/// Decimals that show at least so many digits of a number, and four where that is more.
pub(crate) fn decimals(number: f64, significant: i32) -> usize {
    let leading = match number.abs().log10().floor() {
        leading if leading.is_finite() => leading,
        _ => 0.0,
    };
    // The smallest positive number begins at the 324th decimal.
    (significant - 1 - leading as i32).clamp(4, 330) as usize
}

/// A level in percent: 57 rather than 56.99999999999999.
pub(crate) fn percent(level: f64) -> f64 {
    six_digits(100.0 * level)
}

/// The level of bounds as the head of their column.
pub(crate) fn head_of_bounds(level: Bounds<f64>) -> String {
    match level {
        Bounds::Valid(level) => format!("{} % interval", percent(level)),
        Bounds::Withdrawn(_) => "no bounds".to_owned(),
    }
}

/// "1.20 ms (1.10 .. 1.30)"; "-" without a value.
pub(super) fn with_bounds(
    interval: &Interval,
    unit: &str,
    number: impl Fn(f64) -> String,
) -> String {
    let Some(value) = interval.value.map(&number) else {
        return "-".to_owned();
    };
    match interval.lower.zip(interval.upper) {
        Some((low, high)) => format!("{value}{unit} ({} .. {})", number(low), number(high)),
        None => format!("{value}{unit} (no bounds)"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_numbers_keep_their_digits() {
        let shown = |number: f64, digits| format!("{number:.*}", decimals(number, digits));
        assert_eq!(shown(0.97, 4), "0.9700");
        assert_eq!(shown(0.000_012_36, 4), "0.00001236");
        assert_eq!(
            (shown(0.0, 4), shown(123.4, 2)),
            ("0.0000".into(), "123.4000".into())
        );
        assert_eq!(percent(0.57), 57.0);
    }
}
