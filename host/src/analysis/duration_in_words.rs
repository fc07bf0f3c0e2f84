//! Durations as people write them.

/// "12 ms", of three digits at most.
pub(super) fn in_words(seconds: f64) -> String {
    let number = |value: f64| {
        let digits = (2.0 - value.abs().log10().floor()).clamp(0.0, 6.0) as usize;
        let text = format!("{value:.digits$}");
        match text.contains('.') {
            true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
            false => text,
        }
    };
    match seconds >= 1.0 {
        true => format!("{} s", number(seconds)),
        false => format!("{} ms", number(1e3 * seconds)),
    }
}
