//! A comparison as text.

use super::{difference_rows, probability, write_advice};
use servoid_identification::comparison::{Comparison, Stroke};
use servoid_identification::metrics::Interval;
use std::fmt::Write;

/// What came of a comparison, for a terminal.
#[must_use]
pub fn of_comparison(a: &str, b: &str, found: &Comparison) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _infallible = write_comparison(&mut text, a, b, found);
    text
}

fn write_comparison(text: &mut String, a: &str, b: &str, found: &Comparison) -> std::fmt::Result {
    writeln!(text, "A  {a}\nB  {b}\n\n{}\n", found.summary)?;
    for (name, value) in facts_of_comparison("A", "B", found) {
        writeln!(text, "  {name:30} {value}")?;
    }
    writeln!(
        text,
        "\n  {:32} {:>10} {:>10} {:>12}  {} % interval",
        "",
        "A",
        "B",
        "B - A",
        100.0 * found.level
    )?;
    for row in difference_rows(found) {
        if let [(a, _), (b, _), (difference, bounds)] = &row.cells[..] {
            writeln!(
                text,
                "  {:32} {a:>10} {b:>10} {difference:>12}  {bounds}",
                row.label
            )?;
        }
    }
    write_advice(text, &found.advice)
}

/// What was found beside the metrics, a line each: what it is, and what it came to.
#[must_use]
pub fn facts_of_comparison(a: &str, b: &str, found: &Comparison) -> Vec<(String, String)> {
    let bounds = &found.difference_percent;
    let stroke = match bounds.stroke {
        Stroke::Both => "",
        Stroke::Up => " of an up stroke",
        Stroke::Down => " of a down stroke",
    };
    let mut facts = vec![
        (
            "verdict".to_owned(),
            format!(
                "{} (margin {} % of the step)",
                format!("{:?}", found.verdict).to_lowercase(),
                found.margin_percent
            ),
        ),
        (
            "largest difference".to_owned(),
            format!(
                "at least {:.2} %, at most {:.2} % of the step ({} %), surest {:.0} ms after the edge{stroke}",
                bounds.at_least,
                bounds.at_most,
                100.0 * found.level,
                1e3 * bounds.at_s
            ),
        ),
        (
            format!("{b} is later than {a} by"),
            format!("{:+.2} ms", 1e3 * found.delay_shift_s),
        ),
        (
            "chance, scatter of runs".to_owned(),
            match found.p_value {
                Some(_) => format!(
                    "{} with {} and {} runs",
                    probability(found.p_value),
                    found.runs[0],
                    found.runs[1]
                ),
                None => format!(
                    "not tested: needs three runs a side (here {} and {})",
                    found.runs[0], found.runs[1]
                ),
            },
        ),
    ];
    facts.extend(over_prediction(a, b, found));
    facts.extend(levels(a, b, found));
    facts.extend(asymmetry(a, b, found));
    facts
}

fn over_prediction(a: &str, b: &str, found: &Comparison) -> Vec<(String, String)> {
    let Some(over) = &found.over_prediction else {
        return Vec::new();
    };
    let share = |interval: &Interval| match (interval.value, interval.lower, interval.upper) {
        (Some(v), Some(low), Some(high)) => format!("{v:.2} % ({low:.2} .. {high:.2})"),
        _ => "-".to_owned(),
    };
    vec![
        (
            format!("{a} over-predicts {b}"),
            format!(
                "+ side {}, - side {}, travel {}",
                share(&over.plus_percent),
                share(&over.minus_percent),
                share(&over.travel_percent)
            ),
        ),
        ("which means".to_owned(), over.definition.clone()),
    ]
}

fn levels(a: &str, b: &str, found: &Comparison) -> Vec<(String, String)> {
    let rest = |level: &Interval| match (level.value, level.lower, level.upper) {
        (Some(value), Some(low), Some(high)) => format!("{value:.3} ({low:.3} .. {high:.3})"),
        _ => "-".to_owned(),
    };
    let sides = found.levels.iter().flat_map(|l| [(a, &l.a), (b, &l.b)]);
    sides
        .map(|(name, side)| {
            let text = format!(
                "{} when told {:+}, {} when told {:+}",
                rest(&side.plus),
                side.command_plus,
                rest(&side.minus),
                side.command_minus
            );
            (format!("{name} rests at"), text)
        })
        .collect()
}

fn asymmetry(a: &str, b: &str, found: &Comparison) -> Vec<(String, String)> {
    let sides = found.asymmetry.iter().flat_map(|s| [(a, &s.a), (b, &s.b)]);
    sides
        .filter_map(|(name, side)| {
            let text = format!(
                "{}, differ by up to {:.1} % of the stroke",
                probability(side.p),
                side.largest_percent?.abs()
            );
            Some((format!("{name}, up against down strokes"), text))
        })
        .collect()
}
