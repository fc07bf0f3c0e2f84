//! A cell's number.

/// What stands before the fraction of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Decimal {
    /// 0.5
    Point,
    /// 0,5, in tables whose cells are parted by something else.
    Comma,
}

/// What programs write where they have no number, in lower letters.
const MISSING: [&str; 6] = ["na", "n/a", "null", "none", "#n/a", "-nan(ind)"];

/// A finite number; NaN where the cell is empty or marked as missing, `None` where it is neither.
pub(super) fn parse(cell: &[u8], decimal: Decimal) -> Option<f64> {
    if cell.is_empty() {
        return Some(f64::NAN);
    }
    let text = std::str::from_utf8(cell).ok()?;
    match text.parse::<f64>() {
        Ok(number) => (!number.is_infinite()).then_some(number),
        Err(_) if decimal == Decimal::Comma && text.contains(',') => with_comma(text),
        Err(_) => MISSING
            .contains(&text.to_lowercase().as_str())
            .then_some(f64::NAN),
    }
}

/// "0,5" or "1,5e-3": one comma, digits after it, and no point.
fn with_comma(text: &str) -> Option<f64> {
    let (whole, fraction) = text.split_once(',')?;
    let digits = fraction.starts_with(|letter: char| letter.is_ascii_digit());
    if !digits || text.contains('.') || fraction.contains(',') {
        return None;
    }
    let number: f64 = format!("{whole}.{fraction}").parse().ok()?;
    number.is_finite().then_some(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_gaps_and_other_words_are_distinguished() {
        let point = |text: &str| parse(text.as_bytes(), Decimal::Point);
        assert_eq!(point("-1.5e-3"), Some(-1.5e-3));
        for missing in ["", "nan", "NaN", "NAN", "N/A", "NULL"] {
            assert!(point(missing).unwrap().is_nan(), "{missing}");
        }
        for other in ["inf", "1e999", "1,5", "up", "5 deg", "0x10", "-"] {
            assert_eq!(point(other), None, "{other}");
        }
        let comma = |text: &str| parse(text.as_bytes(), Decimal::Comma);
        assert_eq!(
            (comma("-0,25"), comma("3"), comma("1,5e-3")),
            (Some(-0.25), Some(3.0), Some(1.5e-3))
        );
        for other in ["1.234,5", "1,234,5", "1,", ","] {
            assert_eq!(comma(other), None, "{other}");
        }
    }
}
