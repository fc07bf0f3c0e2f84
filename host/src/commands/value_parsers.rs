//! Parsers of numbers that several commands take as options.

/// A margin that a difference is compared with (percent).
pub(super) fn margin(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(percent) if percent >= 0.0 && percent.is_finite() => Ok(percent),
        _ => Err("it must be a number of percent, 0 or above".to_owned()),
    }
}

/// A confidence level: a fraction below one, or percent above it.
pub(super) fn level(text: &str) -> Result<f64, String> {
    let number = text.trim().trim_end_matches('%').trim_end();
    let percent = number.len() < text.trim().len();
    match number.parse::<f64>() {
        Ok(level) if !percent && level > 0.0 && level < 1.0 => Ok(level),
        Ok(level) if level > 1.0 && level < 100.0 => Ok(level / 100.0),
        _ => Err(
            "it must be a fraction such as 0.99, or percent such as 99, from 50 to 99.999 percent"
                .to_owned(),
        ),
    }
}

/// A time between samples (s).
pub(super) fn period(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if PERIODS_S.contains(&number) => Ok(number),
        _ => Err("it must be a number of seconds above 0".to_owned()),
    }
}

/// From a nanosecond to a day between samples: beyond, it is a slip.
const PERIODS_S: std::ops::RangeInclusive<f64> = 1e-9..=86_400.0;

/// Any number but NaN and infinity.
pub(super) fn finite(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err("it must be a number".to_owned()),
    }
}
