//! A comparison as text for a terminal.

use super::write_advice;
use servoid_identification::comparison::Comparison;
use servoid_identification::metrics::Interval;
use std::fmt::Write;

/// What came of a comparison.
#[must_use]
pub fn of_comparison(a: &str, b: &str, found: &Comparison) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _infallible = write_comparison(&mut text, a, b, found);
    text
}

fn write_comparison(text: &mut String, a: &str, b: &str, found: &Comparison) -> std::fmt::Result {
    let level = 100.0 * found.level;
    writeln!(text, "A  {a}\nB  {b}\n\n{}\n", found.summary)?;
    writeln!(
        text,
        "  verdict                       {} (margin {} % of the step)",
        format!("{:?}", found.verdict).to_lowercase(),
        found.margin_percent
    )?;
    writeln!(
        text,
        "  largest difference            at least {:.2} %, at most {:.2} % of the step ({level} %), surest {:.0} ms after the edge",
        found.difference_percent.at_least,
        found.difference_percent.at_most,
        1e3 * found.difference_percent.at_s
    )?;
    writeln!(
        text,
        "  B is later than A by          {:+.2} ms",
        1e3 * found.delay_shift_s
    )?;
    match found.p_value {
        Some(p) => writeln!(text, "  chance, scatter of runs       p = {p:.3}")?,
        None => writeln!(
            text,
            "  chance                        not tested: needs three runs a side (here {} and {})",
            found.runs[0], found.runs[1]
        )?,
    }
    if let Some(over) = &found.over_prediction {
        let share = |interval: &Interval| match (interval.value, interval.lower, interval.upper) {
            (Some(v), Some(low), Some(high)) => format!("{v:.2} % ({low:.2} .. {high:.2})"),
            _ => "-".to_owned(),
        };
        writeln!(
            text,
            "  A over-predicts B             + side {}, - side {}, travel {}",
            share(&over.plus_percent),
            share(&over.minus_percent),
            share(&over.travel_percent)
        )?;
    }
    if let Some(levels) = &found.levels {
        for (name, side) in [("A", &levels.a), ("B", &levels.b)] {
            writeln!(
                text,
                "  {name} rests at                    {} when told {:+}, {} when told {:+}",
                rest_text(&side.plus),
                side.command_plus,
                rest_text(&side.minus),
                side.command_minus
            )?;
        }
    }
    if let Some(asymmetry) = &found.asymmetry {
        for (name, side) in [("A", &asymmetry.a), ("B", &asymmetry.b)] {
            if let (Some(p), Some(largest)) = (side.p, side.largest_percent) {
                writeln!(
                    text,
                    "  {name}, up against down strokes     p = {p:.3}, differ by {largest:.1} % of the stroke at most"
                )?;
            }
        }
    }
    writeln!(
        text,
        "\n  {:32} {:>10} {:>10} {:>12}  {level} % interval",
        "", "A", "B", "difference"
    )?;
    for difference in &found.differences {
        let number = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{v:.4}"));
        writeln!(
            text,
            "  {:32} {:>10} {:>10} {:>12}  {} .. {}",
            difference.metric,
            number(difference.a),
            number(difference.b),
            number(difference.difference),
            number(difference.lower),
            number(difference.upper)
        )?;
    }
    write_advice(text, &found.advice)
}

fn rest_text(level: &Interval) -> String {
    match (level.value, level.lower, level.upper) {
        (Some(value), Some(low), Some(high)) => format!("{value:.3} ({low:.3} .. {high:.3})"),
        _ => "-".to_owned(),
    }
}
