//! A comparison as text.

use super::advice::write_advice;
use super::lines::wrapped;
use super::metrics::difference_rows;
use super::numbers::{percent, probability};
use servoid_identification::comparison::{Comparison, ComparisonBounds, DifferenceCurve, Stroke};
use servoid_identification::results::{Bounds, Interval};
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
    writeln!(text, "A  {a}\nB  {b}\n\n{}\n", wrapped(&found.summary, 0))?;
    for (name, value) in facts_of_comparison("A", "B", found) {
        writeln!(text, "  {name:NAMES$} {}", wrapped(&value, NAMES + 3))?;
    }
    write!(text, "\n{}", table_of_comparison("A", "B", found))?;
    write_advice(text, &found.advice)
}

/// Width of the column with the names of facts \[letters\].
const NAMES: usize = 30;

/// Why metrics of two sides are not set against each other.
pub const NOT_COMPARED: &str = "No differences of metrics: without bounds they may mean nothing.";

/// Metrics of both sides and their difference with its bounds, and how they were made.
#[must_use]
pub fn table_of_comparison(a: &str, b: &str, found: &Comparison) -> String {
    let Bounds::Valid(bounds) = &found.bounds else {
        let instead = "'servoid identify' prints the metrics of each side, and 'servoid report' both side by side.";
        return format!("  {}\n", wrapped(&format!("{NOT_COMPARED} {instead}"), 2));
    };
    let mut text = format!(
        "  {:32} {a:>10} {b:>10} {:>12}  {} % interval\n",
        "",
        "difference",
        percent(bounds.level)
    );
    for row in difference_rows(found, "") {
        if let [(a, _), (b, _), (difference, bounds)] = &row.cells[..] {
            let _infallible = writeln!(
                text,
                "  {:32} {a:>10} {b:>10} {difference:>12}  {bounds}",
                row.label
            );
        }
    }
    text + "\n  " + &wrapped(how_compared(found), 2) + "\n"
}

/// How the metrics of a comparison were made, which are not those of each side by itself.
#[must_use]
pub fn how_compared(found: &Comparison) -> &'static str {
    // Only recordings show where a side comes to rest.
    match found.levels {
        Some(_) => {
            "Difference: second less first. Both sides as the comparison takes them, with one settling \
             time and number of frequencies for both: a side by itself, with a structure of its own, has \
             metrics that differ a little."
        }
        None => {
            "Difference: second less first. Each side as its model has it, with a structure of its own; \
             the recordings, taken with one structure for both, give metrics that differ a little."
        }
    }
}

/// What was found beside the metrics, a line each: what it is, and what it came to.
#[must_use]
pub fn facts_of_comparison(a: &str, b: &str, found: &Comparison) -> Vec<(String, String)> {
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
            match &found.bounds {
                Bounds::Valid(bounds) => largest_difference(bounds),
                Bounds::Withdrawn(reason) => {
                    format!("no bounds can be given: {}", reason.because())
                }
            },
        ),
    ];
    if let Bounds::Valid(bounds) = &found.bounds {
        facts.extend(delay_shift(a, b, found, bounds));
        facts.push((
            "which means".to_owned(),
            found.delay_shift_definition.clone(),
        ));
    }
    facts.extend([(
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
    )]);
    facts.extend(over_prediction(a, b, found));
    facts.extend(levels(a, b, found));
    facts.extend(asymmetry(a, b, found));
    facts
}

fn largest_difference(bounds: &ComparisonBounds) -> String {
    let difference = &bounds.difference_percent;
    let stroke = match difference.stroke {
        Stroke::Both => "",
        Stroke::Up => " of an up stroke",
        Stroke::Down => " of a down stroke",
    };
    format!(
        "at least {:.2} %, at most {:.2} % of the step ({} %), surest {:.0} ms after the edge{stroke}",
        difference.at_least,
        difference.at_most,
        percent(bounds.level),
        1e3 * difference.at_s
    )
}

/// The equivalent delay shift, stroke by stroke where they are taken apart.
fn delay_shift(
    a: &str,
    b: &str,
    found: &Comparison,
    bounds: &ComparisonBounds,
) -> Vec<(String, String)> {
    let milliseconds = |value: Option<f64>, bounds: Option<[f64; 2]>| {
        let Some(value) = value else {
            return "an unknown time".to_owned();
        };
        let bounds = bounds.map_or_else(
            || " (no bounds)".to_owned(),
            |[low, high]| format!(" ({:+.2} .. {:+.2})", 1e3 * low, 1e3 * high),
        );
        format!("{:+.2} ms{bounds}", 1e3 * value)
    };
    let of = |curve: &DifferenceCurve, way: &str| {
        let shift = &curve.delay_shift_s;
        let bounds = shift.lower.zip(shift.upper).map(<[f64; 2]>::from);
        let left = curve.shift_leaves_percent.map_or_else(String::new, |left| {
            format!(", which leaves up to {left:.1} % of the final value unexplained")
        });
        milliseconds(shift.value, bounds) + way + &left
    };
    let name = format!("{b} is behind {a} by");
    match &found.curves[..] {
        [up, down] => {
            let both = milliseconds(found.delay_shift_s, bounds.delay_shift_s);
            vec![
                (name, of(up, " on the way up")),
                (String::new(), of(down, " on the way down")),
                (String::new(), format!("{both} by one delay for both")),
            ]
        }
        curves => vec![(name, curves.iter().map(|curve| of(curve, "")).collect())],
    }
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
                "{} when commanded {:+}, {} when commanded {:+}",
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
                "{:.1} % of the stroke apart where they differ most ({} by chance alone)",
                side.largest_percent?.abs(),
                probability(side.p)
            );
            Some((format!("{name}, up against down strokes"), text))
        })
        .collect()
}
