//! Where the output of a record comes to rest under the commands that are held.

use crate::data::column::span;
use crate::data::{EXACTLY, Hold, Record, Run, holds, last_quarter, mean_output};

/// Commands that show a line and its end at least: those of the line, and those of an end that rest at one angle with another. With fewer, a
/// bend is a stop. A run of fewer rests does not show its own offset: it is left out beside runs that do.
pub(super) const FEWEST: usize = 3;

/// Share of the way to a rest below which the last two eighths of a hold agree. Holds that end before the servo rests are no rests, and
/// scatter about the line more than a stop is short.
const AT_REST: f64 = 0.05;

/// Where the output comes to rest under a command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rest {
    pub(super) run: usize,
    pub(super) command: f64,
    pub(super) output: f64,
}

/// Command and mean output of the holds in which the output comes to rest, by the command.
pub(super) fn rests(record: &Record) -> Vec<Rest> {
    rests_with_outputs_of(record, record)
}

/// The same with the outputs that `still` has there.
pub(super) fn rests_with_outputs_of(record: &Record, still: &Record) -> Vec<Rest> {
    let both = record.runs().iter().zip(still.runs());
    let by_run: Vec<Vec<(f64, f64)>> = both.map(|(run, still)| rests_of(run, still)).collect();
    let has_enough = |rests: &Vec<(f64, f64)>| rests.len() >= FEWEST;
    let show_offsets = by_run.iter().any(has_enough);
    let of_run = |(run, rests): (usize, &Vec<(f64, f64)>)| {
        let run = if show_offsets { run } else { 0 };
        let rest = |&(command, output): &(f64, f64)| Rest {
            run,
            command,
            output,
        };
        rests.iter().map(rest).collect::<Vec<_>>()
    };
    let used = (by_run.iter().enumerate()).filter(|(_, rests)| !show_offsets || has_enough(rests));
    let mut all: Vec<Rest> = used.flat_map(of_run).collect();
    all.sort_by(|a, b| a.command.total_cmp(&b.command));
    all
}

/// Those of one run: the two halves of the last quarter agree, beside the way there. Where most holds do not end so, the motion goes on, and those that seem to
/// are where it turns round.
///
/// One in which the output stays where it was is a rest, too: there is no way between commands beyond a stop.
fn rests_of(run: &Run<'_>, still: &Run<'_>) -> Vec<(f64, f64)> {
    let range = |column: &[f64]| span(column.iter().copied()).unwrap_or_default();
    let gain = range(run.output()) / range(run.input());
    let ends = |hold: &Hold| {
        let last = last_quarter(&hold.samples);
        let middle = last.start + last.len() / 2;
        let [first, second] =
            [last.start..middle, middle..last.end].map(|part| mean_output(run, part));
        let (first, second) = first.zip(second)?;
        let start = run.output()[hold.samples.start];
        Some(HoldEnd {
            command: hold.level,
            rest: mean_output(still, last)?,
            left: (second - first).abs(),
            way: (second - start).abs(),
            asked: gain * (hold.level - hold.before?).abs(),
        })
    };
    let held = holds(run, EXACTLY);
    let long = held
        .iter()
        .filter(|hold| last_quarter(&hold.samples).len() > 1);
    let ends: Vec<HoldEnd> = long.filter_map(ends).collect();
    let arrived = ends.iter().filter(|end| end.is_rest()).count();
    if 2 * arrived <= ends.len() {
        return Vec::new();
    }
    let rests = ends.iter().filter(|end| end.is_rest() || end.stays());
    rests.map(|end| (end.command, end.rest)).collect()
}

/// How a hold ends.
struct HoldEnd {
    command: f64,
    /// Mean output in the last quarter.
    rest: f64,
    /// From the first half of that quarter to the second.
    left: f64,
    /// From the beginning of the hold to its end.
    way: f64,
    /// The way that the command asks for, by the gain over the whole run.
    asked: f64,
}

impl HoldEnd {
    fn is_rest(&self) -> bool {
        self.left < AT_REST * self.way
    }

    /// Whether the output does not follow the command at all.
    fn stays(&self) -> bool {
        self.left.max(self.way) < AT_REST * self.asked
    }
}
