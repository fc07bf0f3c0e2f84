//! A cell's number.

/// What stands before the fraction of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Decimal {
    /// 0.5
    Point,
    /// 0,5, in tables whose cells are parted by something else.
    Comma,
}

impl Decimal {
    /// The byte of it.
    fn sign(self) -> u8 {
        match self {
            Self::Point => b'.',
            Self::Comma => b',',
        }
    }
}

/// What programs write where they have no number, in lower letters.
const MISSING: [&str; 6] = ["na", "n/a", "null", "none", "#n/a", "-nan(ind)"];

/// Longest number that is looked at where a comma stands for the point: beyond, it is no number.
const LONGEST: usize = 64;

/// A finite number; NaN where the cell is empty or marked as missing, `None` where it is neither.
#[inline]
pub(super) fn parse(cell: &[u8], decimal: Decimal) -> Option<f64> {
    if cell.is_empty() {
        return Some(f64::NAN);
    }
    if let Some(number) = short(cell, decimal) {
        return Some(number);
    }
    let text = std::str::from_utf8(cell).ok()?;
    match text.parse::<f64>() {
        Ok(number) if number.is_infinite() => None,
        Ok(number) => Some(number),
        Err(_) => otherwise(text, decimal),
    }
}

/// A number as nearly every cell has one, "-12.345": a sign, digits, a point and digits after it, and no
/// more of them than a number of 53 bits can hold. Then the digits, taken as a whole number, and the power of
/// ten are both exact, and their quotient is the nearest number to the text (W. D. Clinger, "How to read
/// floating point numbers accurately", PLDI 1990). It takes a third of the time of the general way.
#[inline]
fn short(cell: &[u8], decimal: Decimal) -> Option<f64> {
    let (negative, text) = match cell {
        [b'-', text @ ..] => (true, text),
        text => (false, text),
    };
    if text.len() > MOST_DIGITS + 1 {
        return None;
    }
    let (whole, rest) = leading_digits(0, text);
    let number = match rest {
        [] if !text.is_empty() => whole as f64,
        [point, places @ ..] if *point == decimal.sign() => {
            let power = TENS.get(places.len().checked_sub(1)?)?;
            let (all, []) = leading_digits(whole, places) else {
                return None;
            };
            all as f64 / power
        }
        _ => return None,
    };
    Some(if negative { -number } else { number })
}

/// `number` with the digits that `text` begins with written behind it, and what follows them.
#[inline]
fn leading_digits(mut number: u64, text: &[u8]) -> (u64, &[u8]) {
    let mut rest = text;
    while let [byte @ b'0'..=b'9', behind @ ..] = rest {
        number = number * 10 + u64::from(byte - b'0');
        rest = behind;
    }
    (number, rest)
}

/// Digits of which every number is below 2^53. One more may stand where the point would be; such a whole
/// number is rounded to the nearest one, once, as it becomes one of floating point.
const MOST_DIGITS: usize = 15;

/// From 10 on, the power of ten for one place behind the point, for two, and so on. All are exact, as they are up
/// to 10^22.
const TENS: [f64; MOST_DIGITS] = [
    1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
];

/// A cell that is no number with a decimal point: the rare case.
#[cold]
fn otherwise(text: &str, decimal: Decimal) -> Option<f64> {
    if decimal == Decimal::Comma && text.contains(',') {
        return with_comma(text);
    }
    MISSING
        .contains(&text.to_lowercase().as_str())
        .then_some(f64::NAN)
}

/// "0,5" or "1,5e-3": one comma, digits after it, and no point.
fn with_comma(text: &str) -> Option<f64> {
    let (whole, fraction) = text.split_once(',')?;
    let digits = fraction.starts_with(|letter: char| letter.is_ascii_digit());
    if !digits || text.len() > LONGEST || text.contains('.') || fraction.contains(',') {
        return None;
    }
    let number: f64 = format!("{whole}.{fraction}").parse().ok()?;
    number.is_finite().then_some(number)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

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

    /// The general way, for text that the short one takes too.
    fn general(text: &str, decimal: Decimal) -> Option<f64> {
        match decimal {
            Decimal::Point => text.parse().ok(),
            Decimal::Comma => text.replace(',', ".").parse().ok(),
        }
    }

    fn agree(text: &str) {
        for (text, decimal) in [
            (text.to_owned(), Decimal::Point),
            (text.replace('.', ","), Decimal::Comma),
        ] {
            if let Some(number) = short(text.as_bytes(), decimal) {
                let expected = general(&text, decimal).map(f64::to_bits);
                assert_eq!(Some(number.to_bits()), expected, "{text}");
            }
        }
    }

    #[test]
    fn the_short_way_takes_what_files_have_and_nothing_else() {
        for usual in [
            "0",
            "-0",
            "-5.0",
            "0.123456",
            "123456789012345",
            "0.00000000000001",
        ] {
            assert!(short(usual.as_bytes(), Decimal::Point).is_some(), "{usual}");
            agree(usual);
        }
        for unusual in [
            "",
            "-",
            "+1",
            "1.",
            ".",
            "-.",
            "1.2.3",
            "1e3",
            "1,5",
            "1 ",
            "--1",
            "1234567890.1234567",
            "\u{b2}",
        ] {
            assert_eq!(short(unusual.as_bytes(), Decimal::Point), None, "{unusual}");
        }
    }

    proptest! {
        /// To the last bit.
        #[test]
        fn both_ways_agree(text in "-?[0-9]{0,9}[.,]?[0-9]{0,9}", any_text in "[-+0-9.,e ]{0,8}") {
            agree(&text);
            agree(&any_text);
        }

        #[test]
        fn what_is_written_with_a_few_places_comes_back(value in -1e6..1e6, places in 0_usize..9) {
            agree(&format!("{value:.places$}"));
        }
    }
}
