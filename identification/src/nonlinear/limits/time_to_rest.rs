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

#[cfg(test)]
mod tests {
    use super::*;

    /// Strokes of 40 take 80 samples; a flight has hundreds of changes by 0.2 that are held for a while, and over at once.
    #[test]
    fn small_changes_say_nothing_of_strokes() {
        let strokes = (0..20).flat_map(|k| [40.0 * f64::from(k % 2); 200]);
        let flight = (0..300).flat_map(|k| [0.2 * f64::from(k % 2); 12]);
        let input: Vec<f64> = strokes.chain(flight).collect();
        let follow = |y: &mut f64, (k, u): (usize, &f64)| {
            *y += (u - *y).clamp(-0.5, 0.5);
            // White enough to have a spread at rest.
            Some(*y + 1e-3 * (((k * 7919) % 101) as f64 - 50.0) / 50.0)
        };
        let output: Vec<f64> = input.iter().enumerate().scan(0.0, follow).collect();
        let record = Record::of_run(0.01, input, output).unwrap();
        let found = time_to_rest(&record).unwrap();
        // To within 1 % of the way: 0.4 of the 40.
        assert!((79..=80).contains(&found), "{found}");
    }
}
