//! Numbers with the digits that mean something, and no others.

use servoid_identification::results::{Bounds, Interval, six_digits, with_unit};

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

/// "0.120 deg"; the number alone where the unit is not known.
pub(crate) fn number_with_unit(number: f64, digits: usize, unit: Option<&str>) -> String {
    with_unit(format!("{number:.digits$}"), unit.unwrap_or_default())
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

/// An end of an interval that is so many times as large as the other one, or as the value, says nothing.
pub(crate) const WORTH_PRINTING: f64 = 1000.0;

/// "1.20 ms (1.10 .. 1.30)"; "-" without a value.
pub(crate) fn with_bounds(
    interval: &Interval,
    unit: &str,
    number: impl Fn(f64) -> String,
) -> String {
    let Some(value) = interval.value.map(&number) else {
        return "-".to_owned();
    };
    match interval.ends() {
        Some([low, high]) => format!("{value}{unit} ({} .. {})", number(low), number(high)),
        None => format!("{value}{unit} (no bounds)"),
    }
}

/// Powers of ten that are written out: of 0.00004347 nobody counts the zeros.
const POWERS: std::ops::Range<f64> = -4.0..9.0;

/// A number with four digits; one that nobody reads as digits, as a power of ten.
pub(crate) fn four_digits(value: f64) -> String {
    digits(value, 4)
}

/// A number with so many digits.
pub(crate) fn digits(value: f64, count: usize) -> String {
    digits_beside(value, count, None)
}

/// Digits of the width of an interval that are shown: what is smaller says nothing.
const OF_WIDTH: usize = 3;

/// The width of an interval beside which a number has so many decimals at the most.
pub(crate) fn widest_shown_with(decimals: usize) -> f64 {
    10f64.powi(OF_WIDTH as i32 - 1 - decimals as i32)
}

/// Digits beyond which nothing of a servo is known, however narrow an interval.
const MOST_DIGITS: usize = 6;

/// A number with so many digits, or as many as distinguish it from the ends of its interval of this `width`, which is by half as many of the
/// width; none is small beside that.
pub(crate) fn digits_beside(value: f64, count: usize, width: Option<f64>) -> String {
    let leading = |value: f64| Some(value.abs().log10().floor()).filter(|power| power.is_finite());
    let decimals = |power: f64, count: usize| count as i32 - 1 - power as i32;
    let width = width.and_then(leading);
    let [fewest, enough] = match width {
        Some(power) => [count / 2, OF_WIDTH].map(|count| decimals(power, count)),
        None => [i32::MIN, i32::MAX],
    };
    let Some(power) = leading(value) else {
        // A negative zero is 0.
        return format!("{:.0}", value + 0.0);
    };
    if !POWERS.contains(&power) && decimals(power, count) <= enough {
        return format!("{value:.0$e}", count - 1);
    }
    let most = enough.min(decimals(power, MOST_DIGITS));
    let decimals = (decimals(power, count).max(fewest).min(most)).clamp(0, 9) as usize;
    fixed(value, decimals)
}

/// A number with so many decimals; a small one of either sign may round to 0, which has none.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let is_zero = text.chars().all(|letter| "-0.".contains(letter));
    match text.strip_prefix('-') {
        Some(zero) if is_zero => zero.to_owned(),
        _ => text,
    }
}

/// The same with its sign; what rounds to 0 is "+0.00".
pub(crate) fn signed(value: f64, decimals: usize) -> String {
    let text = fixed(value, decimals);
    match text.starts_with('-') {
        true => text,
        false => format!("+{text}"),
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

    #[test]
    fn a_negative_zero_is_zero() {
        assert_eq!([digits(-0.0, 4), digits(0.0, 4)], ["0", "0"]);
    }

    #[test]
    fn what_rounds_to_zero_has_no_minus() {
        assert_eq!([fixed(-0.001, 2), fixed(-0.006, 2)], ["0.00", "-0.01"]);
        assert_eq!(
            [signed(-0.001, 2), signed(0.0, 1), signed(-3.0, 1)],
            ["+0.00", "+0.0", "-3.0"]
        );
    }

    #[test]
    fn the_ends_of_a_narrow_interval_differ_from_the_value() {
        let shown = |width| [12.639, 12.641, 12.643].map(|value| digits_beside(value, 4, width));
        assert_eq!(shown(None), ["12.64", "12.64", "12.64"]);
        assert_eq!(shown(Some(0.004)), ["12.6390", "12.6410", "12.6430"]);
        assert_eq!(shown(Some(1e-8)), ["12.6390", "12.6410", "12.6430"]);
        assert_eq!(digits_beside(333.132_839_653, 3, Some(1e-8)), "333.133");
        assert_eq!(shown(Some(0.4)), ["12.64", "12.64", "12.64"]);
        assert_eq!(shown(Some(40.0)), ["12.6", "12.6", "12.6"]);
        assert_eq!(shown(Some(0.0)), ["12.64", "12.64", "12.64"]);
        assert_eq!(
            digits_beside(-0.0004, 4, Some(widest_shown_with(3))),
            "0.000"
        );
    }
}
