//! How long a servo takes to rest, by its output alone.
//!
//! The settling time of a linear model that does not describe the servo is no time to rest: friction and play make it seconds.

use crate::data::{EXACTLY, Record, holds, last_quarter, mean_output};

/// Share of the way to a rest within which a servo is at rest, and standard deviations of the noise there.
const OF_WAY: f64 = 0.01;
const OF_NOISE: f64 = 4.0;

/// Share of the squares of the strokes whose rests are reached within the time: a glitch, or noise, makes some late, and the many small changes of a
/// smooth motion, which hardly move the servo, say nothing of strokes.
const REACHED: f64 = 0.9;

/// Samples from the edge of a command until the output stays at its rest, in most of the holds in which it comes to one, larger strokes counting for more;
/// `None` where it does in none.
pub(super) fn time_to_rest(record: &Record) -> Option<usize> {
    let mut times = Vec::new();
    for run in record.runs() {
        for hold in &holds(run, EXACTLY) {
            let Some(before) = hold.before else {
                continue;
            };
            let last = last_quarter(&hold.samples);
            let Some(rest) = mean_output(run, last.clone()) else {
                continue;
            };
            let errors = run.output()[last.clone()].iter().map(|y| y - rest);
            let (count, square) = errors
                .filter(|error| !error.is_nan())
                .fold((0.0, 0.0), |(n, sum), error| (n + 1.0, sum + error * error));
            let way = (run.output()[hold.samples.start] - rest).abs();
            let still = (OF_WAY * way).max(OF_NOISE * f64::sqrt(square / count));
            let output = &run.output()[hold.samples.clone()];
            let time = output
                .iter()
                .rposition(|y| (y - rest).abs() > still)
                .map_or(0, |moving| moving + 1);
            // One that rests in its last quarter alone may not have come to rest.
            if hold.samples.start + time < last.start {
                times.push((time, (hold.level - before).powi(2)));
            }
        }
    }
    times.sort_by_key(|(time, _)| *time);
    let all: f64 = times.iter().map(|(_, square)| square).sum();
    let mut reached = 0.0;
    let most = times.iter().find(|(_, square)| {
        reached += square;
        reached >= REACHED * all
    });
    most.map(|(time, _)| *time)
}
