//! Numbers as a reader wants them: with the digits that say something, and no others.

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
    let leading = if number == 0.0 || !number.is_finite() {
        0.0
    } else {
        number.abs().log10().floor()
    };
    // The smallest positive number begins at the 324th decimal.
    let needed = (significant - 1 - leading as i32).clamp(4, 330);
    needed as usize
}

/// A level in percent: 57 rather than 56.99999999999999.
pub(crate) fn percent(level: f64) -> f64 {
    rounded(100.0 * level)
}

/// 2 rather than 2.0000000000000004.
pub(super) fn rounded(number: f64) -> f64 {
    (number * 1e6).round() / 1e6
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
