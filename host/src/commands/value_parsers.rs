//! Parsers of numbers that several commands take as options.

use crate::presentation::summary::AskedSine;

fn number(text: &str, is_valid: impl Fn(f64) -> bool, form: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok();
    number
        .filter(|n| is_valid(*n))
        .ok_or_else(|| format!("it must be {form}"))
}

/// A margin that a difference is compared with (percent).
pub(super) fn margin(text: &str) -> Result<f64, String> {
    let is_valid = |percent: f64| percent >= 0.0 && percent.is_finite();
    number(text, is_valid, "a number of percent, 0 or above")
}

/// A confidence level: a fraction below one, or percent above it.
pub(super) fn level(text: &str) -> Result<f64, String> {
    let plain = text.trim().trim_end_matches('%').trim_end();
    let form = "a fraction such as 0.99, or percent such as 99, from 50 to 99.999 percent";
    let is_percent = plain.len() < text.trim().len();
    let level = number(plain, f64::is_finite, form)?;
    let level = if is_percent || level > 1.0 {
        level / 100.0
    } else {
        level
    };
    number(
        &level.to_string(),
        |level| (0.5..=0.99999).contains(&level),
        form,
    )
}

/// A time between samples, from a nanosecond to a day (s): beyond, it is a slip.
pub(super) fn period(text: &str) -> Result<f64, String> {
    let is_valid = |period: f64| (1e-9..=86_400.0).contains(&period);
    number(text, is_valid, "a number of seconds above 0")
}

/// A frequency (Hz), and an amplitude behind a colon.
pub(super) fn sine(text: &str) -> Result<AskedSine, String> {
    let positive = |value: f64| value > 0.0 && value.is_finite();
    let form = "a number of hertz above 0, such as 8, or one with an amplitude, such as 8:5";
    let (hertz, amplitude) = match text.split_once(':') {
        Some((hertz, amplitude)) => (hertz, Some(number(amplitude, positive, form)?)),
        None => (text, None),
    };
    Ok(AskedSine {
        hertz: number(hertz, positive, form)?,
        amplitude,
    })
}

/// Any number but NaN and infinity.
pub(super) fn finite(text: &str) -> Result<f64, String> {
    number(
        text,
        f64::is_finite,
        "a number without a unit, such as 12.5",
    )
}

/// A count, or a pulse in whole microseconds.
pub(super) fn whole(text: &str) -> Result<u16, String> {
    let whole = text.parse();
    whole.map_err(|_| {
        format!(
            "it must be a whole number from 0 to {} without a unit",
            u16::MAX
        )
    })
}
