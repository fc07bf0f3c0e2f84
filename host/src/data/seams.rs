//! Runs that were written one after the other without anything that parts them.
//!
//! At such a seam the command goes from the last one of a run to the first one of the next, and the output does so in the same row, because it
//! rests at each. No servo does that: at the row of a command it is where it was. A recording whose every stroke looks so is of something that
//! is faster than its rows, and has no seams. One whose command never rests has its columns exchanged, or shows no seams. A jump by a step of
//! the sensor is none.

use servoid_identification::column::{mean, span};
use servoid_identification::results::{Advice, Check};
use servoid_identification::{Record, Run};

/// Rows on either side of a seam at which the output rests.
const RESTS: usize = 3;

/// How much of the jump the output may move there.
const STILL: f64 = 0.15;

/// Part of the travel that is a jump.
const JUMP: f64 = 0.05;

/// Steps of the sensor that are no jump yet: noise beside an edge makes two.
const STEPS: f64 = 2.5;

/// Part of the changes of the command, at most, that may be seams.
const FEW: f64 = 0.1;

/// Places that are named.
const NAMED: usize = 4;

/// Advice where runs seem to follow each other in one.
pub(super) fn advice(record: &Record) -> Option<Advice> {
    let travel = span(record.outputs())?;
    let found: Vec<Vec<usize>> = record.runs().iter().map(|run| seams(run, travel)).collect();
    let (run, rows) = (1..).zip(&found).find(|(_, rows)| !rows.is_empty())?;
    let seconds = |row: &usize| format!("{:.2}", *row as f64 * record.sample_period_s());
    let named: Vec<String> = rows.iter().take(NAMED).map(seconds).collect();
    let more = if rows.len() > NAMED { " and later" } else { "" };
    let of_run = match found.len() {
        1 => String::new(),
        _ => format!(" of run {run}"),
    };
    Some(Advice::new(
        Check::Seams,
        format!(
            "At {} s{more}{of_run} command and output jump in one row, and rest before and after it, as where one run was written behind another. \
             A run has nothing to do with the end of the one before it.",
            named.join(", ")
        ),
        rows.len() as f64,
        0.0,
        "Where these are runs, number them in a column and name it with --run, or split the file there.",
    ))
}

/// The first rows of what seem to be further runs.
fn seams(run: &Run<'_>, travel: f64) -> Vec<usize> {
    let (input, output) = (run.input(), run.output());
    let least = (JUMP * travel).max(STEPS * smallest_change(output));
    let pairs = input.iter().zip(input.iter().skip(1)).zip(1..);
    let changes: Vec<usize> = pairs
        .filter_map(|((before, command), row)| (before != command).then_some(row))
        .collect();
    let found: Vec<usize> = changes
        .iter()
        .copied()
        .filter(|&row| is_seam(input, output, row, least))
        .collect();
    match found.len() as f64 <= FEW * changes.len() as f64 {
        true => found,
        false => Vec::new(),
    }
}

/// Of any two rows: of a coarse sensor, its step.
fn smallest_change(output: &[f64]) -> f64 {
    let changes = output
        .iter()
        .zip(output.iter().skip(1))
        .map(|(a, b)| (b - a).abs());
    changes
        .filter(|change| *change > 0.0)
        .fold(f64::INFINITY, f64::min)
}

/// Whether the output jumps by more than `least` at a change of the command, and both rest before and after it.
fn is_seam(input: &[f64], output: &[f64], row: usize, least: f64) -> bool {
    let command_rests = sides(input, row).map(|sides| moved(sides) == 0.0);
    let jumps = |(before, after)| {
        let jump = (mean(after)? - mean(before)?).abs();
        Some(jump > least && moved((before, after)) < STILL * jump)
    };
    command_rests.unwrap_or(false) && sides(output, row).and_then(jumps).unwrap_or(false)
}

/// The values before a row, and those from it on.
fn sides(values: &[f64], row: usize) -> Option<(&[f64], &[f64])> {
    let before = values.get(row.checked_sub(RESTS)?..row)?;
    Some((before, values.get(row..row + RESTS)?))
}

/// By how much either side moves.
fn moved((before, after): (&[f64], &[f64])) -> f64 {
    let of = |side: &[f64]| span(side.iter().copied()).unwrap_or(0.0);
    of(before).max(of(after))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs of a lag of `lag` rows under fourteen levels each, which begin at rest at their first, as one.
    fn joined(runs: u32, lag: f64) -> Record<'static> {
        let level = |k: u32| 10.0 * (f64::from(k * k) * 0.7548776662).fract();
        let (mut input, mut output) = (Vec::new(), Vec::new());
        for run in 0..runs {
            let mut y = level(100 * run);
            for row in 0..700 {
                let command = level(100 * run + row / 50);
                let noise = 0.1 * ((f64::from(row * 7 + run) * 0.618).fract() - 0.5);
                input.push(command);
                output.push(y + noise);
                y += (command - y) / lag;
            }
        }
        Record::of_run(0.01, input, output).unwrap()
    }

    #[test]
    fn runs_end_to_end_are_seen_and_a_fast_servo_is_not() {
        let found = advice(&joined(4, 5.0)).unwrap();
        assert!(
            found.finding.starts_with("At 7.00, 14.00, 21.00 s command"),
            "{}",
            found.finding
        );
        assert_eq!(advice(&joined(1, 5.0)), None);
        assert_eq!(advice(&joined(1, 1.0)), None);
    }

    #[test]
    fn steps_of_a_sensor_and_exchanged_columns_are_no_seams() {
        let record = joined(1, 5.0);
        let run = &record.runs()[0];
        let coarse = run.output().iter().map(|y| (y / 2.0).round() * 2.0);
        let coarse = Record::of_run(0.01, run.input(), coarse.collect::<Vec<f64>>()).unwrap();
        assert_eq!(advice(&coarse), None);
        let exchanged = Record::of_run(0.01, run.output(), run.input()).unwrap();
        assert_eq!(advice(&exchanged), None);
    }
}
