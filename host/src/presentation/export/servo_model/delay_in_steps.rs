//! What is said of a delay that a program rounds to whole steps.

use super::subject::ServoExport;
use crate::presentation::summary::four_digits;

/// A rounding that is less than this part of a step is none.
const NONE: f64 = 1e-3;

/// The number in whole nanoseconds, which has few digits.
pub(super) fn to_nanoseconds(seconds: f64) -> f64 {
    (seconds * 1e9).round() / 1e9
}

/// Of a file that is late by `late_s` in steps of `step_s`, a sentence or two.
pub(super) fn delay_in_words(export: &ServoExport<'_>, late_s: f64, step_s: f64) -> String {
    let [own, late] = [export.parameters.delay_s, late_s].map(|s| four_digits(1e3 * s));
    match apart(export, late_s, step_s) {
        None => format!("the motion is late by {late} ms, as the servo is."),
        Some(apart) => format!(
            "the motion is late by {late} ms, where the servo is by {own} ms: {apart} by rounding to steps. A shorter --step-ms brings it closer."
        ),
    }
}

/// The same for the terminal, where it is rounded.
pub(super) fn rounded_delay(export: &ServoExport<'_>, late_s: f64, step_s: f64) -> Option<String> {
    let [own, late] = [export.parameters.delay_s, late_s].map(|s| four_digits(1e3 * s));
    let apart = apart(export, late_s, step_s)?;
    Some(format!(
        "the delay is {late} ms in place of {own} ms, {apart}, as this program rounds it to steps: a shorter --step-ms brings it closer"
    ))
}

/// "0.94 ms less", where it is rounded.
fn apart(export: &ServoExport<'_>, late_s: f64, step_s: f64) -> Option<String> {
    let more_s = late_s - export.parameters.delay_s;
    let way = if more_s < 0.0 { "less" } else { "more" };
    let apart = four_digits(1e3 * more_s.abs());
    (more_s.abs() > NONE * step_s).then(|| format!("{apart} ms {way}"))
}
