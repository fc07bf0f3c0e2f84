//! A comparison as text.

use crate::data::units::Units;
use crate::presentation::summary::response::metrics::difference_rows;
use crate::presentation::summary::wording::layout::{findings_with, wrapped};
use crate::presentation::summary::wording::numbers::{
    digits_beside, percent, probability, signed, with_bounds,
};
use servoid_identification::comparison::{
    Comparison, ComparisonBounds, DifferenceCurve, Direction, ServoModelComparison, Subject,
    Verdict,
};
use servoid_identification::results::{Advice, Bounds, Interval, command_in_words};

/// A comparison of the sides A and B, for a terminal, beside that of both as `machines`.
#[must_use]
pub fn of_comparison(
    found: &Comparison,
    machines: Option<&ServoModelComparison>,
    units: Units<'_>,
) -> String {
    let summary = found.summary_beside(machines, units.output.unwrap_or_default());
    let mut text = format!("{}\n\n", wrapped(summary, 0));
    for (name, value) in facts_of_comparison("A", "B", found, units) {
        text += &format!("  {name:NAMES$} {}\n", wrapped(&value, NAMES + 3));
    }
    text + "\n"
        + &table_of_comparison("A", "B", found)
        + &findings_with(&found.advice, "Option of 'servoid identify'")
}

/// Width of the column with the names of facts \[letters\].
const NAMES: usize = 30;

/// Why metrics of two sides are not compared.
pub(crate) const NOT_COMPARED: &str =
    "No differences of metrics: without bounds they may mean nothing.";

/// Metrics of both sides and their difference with its bounds, and the way they were computed.
pub(crate) fn table_of_comparison(a: &str, b: &str, found: &Comparison) -> String {
    let Bounds::Valid(bounds) = &found.bounds else {
        let instead = "'servoid identify' prints the metrics of each side, and 'servoid report' both side by side.";
        return format!("  {}\n", wrapped(&format!("{NOT_COMPARED} {instead}"), 2));
    };
    let level = percent(bounds.level);
    // The metrics of each side by itself, which are printed elsewhere, are others.
    let structure = match found.one_structure {
        true => "with one N and n for both sides",
        false => "each with its own N and n",
    };
    let rows = difference_rows(found, "");
    let has_intervals = rows
        .iter()
        .any(|row| matches!(&row.cells[..], [.., (_, bounds)] if !bounds.is_empty()));
    let head = match (has_intervals, found.of) {
        (true, _) => format!("{level} % interval{}", whose_intervals(found)),
        (false, Subject::Servos) => "no intervals: not each run by itself has these".to_owned(),
        (false, Subject::Runs) => "no intervals".to_owned(),
    };
    let mut text = format!(
        "  {structure:32} {a:>10} {b:>10} {:>12}  {head}\n",
        "difference"
    );
    for row in rows {
        if let [(a, _), (b, _), (difference, bounds)] = &row.cells[..] {
            let label = row.label;
            text += &format!("  {label:32} {a:>10} {b:>10} {difference:>12}  {bounds}\n");
        }
    }
    text + "\n  " + &wrapped(how_compared(found), 2) + "\n"
}

/// What is added to the head of intervals where they are those of motions, and not of two servos.
fn whose_intervals(found: &Comparison) -> &'static str {
    match found.descriptions_of_different_motions {
        true => ", of two motions",
        false if found.advice.iter().any(Advice::is_of_linearity) => ", of this motion",
        false => "",
    }
}

/// The way the metrics of a comparison were computed, which differ from those of each side by itself.
pub(crate) fn how_compared(found: &Comparison) -> &'static str {
    // Only recordings show where a side comes to rest.
    match (found.one_structure, found.levels) {
        (true, _) => {
            "Difference: second less first. The comparison takes one settling time and number of \
             frequencies for both sides: a side by itself, with a structure of its own, has other \
             metrics: its settling time may be quite another."
        }
        (false, Some(_)) => {
            "Difference: second less first. Each side has a settling time and number of frequencies of its own: one for both would leave a side that is not \
             linear without bounds, or with its answers to the steps before."
        }
        (false, None) => {
            "Difference: second less first. Each side has the structure of its own model: the \
             recordings, compared with one structure for both, give other metrics, the settling time above all."
        }
    }
}

/// A verdict in one word.
pub(crate) fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Different => "different",
        Verdict::Same => "same",
        Verdict::Undecided => "undecided",
    }
}

/// What a verdict is of.
pub(crate) fn subject_in_words(found: &Comparison) -> &'static str {
    match (found.of, &found.motions) {
        (Subject::Servos, _) => "of the servos",
        (Subject::Runs, Some(_)) => "of these recordings",
        (Subject::Runs, None) => "of these models",
    }
}

/// The results beside the metrics: names and values.
pub(crate) fn facts_of_comparison(
    a: &str,
    b: &str,
    found: &Comparison,
    units: Units<'_>,
) -> Vec<(String, String)> {
    let (verdict, margin) = (verdict(found.verdict), found.margin_percent);
    let of = subject_in_words(found);
    let undecided_by = match found.verdict {
        Verdict::Undecided => " by the step responses",
        Verdict::Different | Verdict::Same => "",
    };
    let margin = format!("{verdict}{undecided_by} ({of}; margin {margin} % of the step)");
    let mut facts = vec![("verdict".to_owned(), margin)];
    let mut add = |name: &str, value: String| facts.push((name.to_owned(), value));
    match &found.bounds {
        Bounds::Valid(bounds) => {
            add("largest difference", largest_difference(bounds));
            // A servo that is limited is later in larger strokes, whichever it is.
            let mut name = match found.descriptions_of_different_motions {
                true => format!("{b}'s motion is behind {a}'s by"),
                false => format!("{b} is behind {a} by"),
            };
            for shift in delay_shifts(found, bounds) {
                add(&std::mem::take(&mut name), shift);
            }
            add("definition", found.delay_shift_definition.clone());
        }
        Bounds::Withdrawn(reason) => {
            let because = reason.because();
            add(
                "largest difference",
                format!("no bounds can be given: {because}"),
            );
        }
    }
    if let Some(over) = &found.over_prediction {
        let share = |interval: &Interval| with_bounds(interval, " %", |v| format!("{v:.2}"));
        let [plus, minus, travel] = [
            &over.plus_percent,
            &over.minus_percent,
            &over.travel_percent,
        ]
        .map(share);
        let shares = format!("+ side {plus}, - side {minus}, travel {travel}");
        add(&format!("{a} over-predicts {b}"), shares);
        add("definition", over.definition.clone());
    }
    let [input, output] = [units.input, units.output]
        .map(|unit| unit.map(|unit| format!(" {unit}")).unwrap_or_default());
    for (name, side) in found.levels.iter().flat_map(|l| [(a, &l.a), (b, &l.b)]) {
        let rest = |(level, command): (&Interval, f64)| {
            level.value?;
            let rest = with_bounds(level, &output, |v| digits_beside(v, 4, level.width()));
            let command = (1e3 * command).round() / 1e3;
            let command = command_in_words(command, side.command_minus);
            Some(format!("{rest} when commanded {command}{input}"))
        };
        let ends = [
            (&side.plus, side.command_plus),
            (&side.minus, side.command_minus),
        ];
        let rests: Vec<String> = ends.into_iter().filter_map(rest).collect();
        if !rests.is_empty() {
            add(&format!("{name} rests at"), rests.join(", "));
        }
    }
    for (name, side) in found.asymmetry.iter().flat_map(|s| [(a, &s.a), (b, &s.b)]) {
        if let Some(largest) = side.largest_percent {
            let (largest, p) = (largest.abs(), probability(side.p));
            let apart = format!(
                "{largest:.1} % of the stroke apart where they differ most ({p} by chance alone in a linear servo whose commands wait for nothing; in one with limits strokes of several sizes differ by themselves)"
            );
            add(&format!("{name}, up against down strokes"), apart);
        }
    }
    facts
}

fn largest_difference(bounds: &ComparisonBounds) -> String {
    let difference = &bounds.difference_percent;
    let stroke = match difference.stroke {
        Direction::Both => "",
        Direction::Up => " of an up stroke",
        Direction::Down => " of a down stroke",
    };
    let surest = match difference.at_least > 0.0 {
        true => format!(
            ", surest {:.0} ms after the edge{stroke}",
            1e3 * difference.at_s
        ),
        false => String::new(),
    };
    format!(
        "at least {:.2} %, at most {:.2} % of the step ({} %){surest}",
        difference.at_least,
        difference.at_most,
        percent(bounds.level),
    )
}

/// The equivalent delay shift, by direction of stroke where the two are compared separately.
fn delay_shifts(found: &Comparison, bounds: &ComparisonBounds) -> Vec<String> {
    let milliseconds = |shift: &Interval| with_bounds(shift, " ms", |s| signed(1e3 * s, 2));
    let of = |curve: &DifferenceCurve, way: &str| {
        let rest = curve.shift_leaves_percent.map_or_else(String::new, |rest| {
            format!(
                "; the shifted curves still differ by up to about {rest:.1} % of the final value"
            )
        });
        milliseconds(&curve.delay_shift_s) + way + &rest
    };
    match &found.curves[..] {
        [up, down] => {
            let [lower, upper] = bounds
                .delay_shift_s
                .map_or([None; 2], |ends| ends.map(Some));
            let value = found.delay_shift_s;
            let both = milliseconds(&Interval {
                value,
                lower,
                upper,
            });
            let both = format!("{both} by one delay for both");
            vec![of(up, " on the way up"), of(down, " on the way down"), both]
        }
        curves => vec![curves.iter().map(|curve| of(curve, "")).collect()],
    }
}
