//! The command as holds and strokes.

use std::ops::Range;

use crate::data::record::{Record, Run};

/// A stretch of samples over which the command stands still.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Hold {
    pub(crate) samples: Range<usize>,
    pub(crate) level: f64,
    /// The level before, if the change to this one is in the record.
    pub(crate) before: Option<f64>,
}

/// The holds of one run, in order. A missing command ends a hold, and the next has no level before.
pub(crate) fn holds(run: &Run) -> Vec<Hold> {
    let input = run.input();
    let mut holds: Vec<Hold> = Vec::new();
    for (k, &level) in input.iter().enumerate().filter(|(_, u)| !u.is_nan()) {
        match holds.last_mut() {
            Some(hold) if hold.samples.end == k && hold.level == level => hold.samples.end = k + 1,
            previous => {
                let before = match previous {
                    Some(hold) if hold.samples.end == k => Some(hold.level),
                    None if k == 0 => run.input_at_rest(),
                    _ => None,
                };
                holds.push(Hold {
                    samples: k..k + 1,
                    level,
                    before: before.filter(|before| *before != level),
                });
            }
        }
    }
    holds
}

/// Mean output over `samples`, without those missing; `None` when half of them are.
pub(crate) fn mean_output(run: &Run, samples: Range<usize>) -> Option<f64> {
    let wanted = samples.len();
    let present = run.output()[samples].iter().filter(|y| !y.is_nan());
    let (count, sum) = present.fold((0usize, 0.0), |(n, sum), y| (n + 1, sum + y));
    (count > 0 && 2 * count >= wanted).then(|| sum / count as f64)
}

/// The last quarter of a hold.
pub(crate) fn last_quarter(samples: &Range<usize>) -> Range<usize> {
    samples.end - (samples.len() / 4).max(1)..samples.end
}

/// A change of the command with rest before and after.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stroke {
    /// Commanded change, with its sign.
    pub(crate) size: f64,
    /// What was travelled, positive in the direction commanded \[output\].
    pub(crate) travel: f64,
    /// Mean speeds over the middle of the travel, 20 to 80 % and 35 to 65 % of it
    /// \[output per second\].
    pub(crate) speed: f64,
    pub(crate) mid_speed: f64,
}

/// The isolated strokes of a record: at least half of `settling` samples of hold before and all
/// of it after.
pub(crate) fn strokes(record: &Record, settling: usize) -> Vec<Stroke> {
    let period = record.sample_period_s();
    let mut strokes = Vec::new();
    for run in record.runs() {
        let holds = holds(run);
        for pair in holds.windows(2) {
            let (before, after) = (&pair[0], &pair[1]);
            let isolated = after.before.is_some()
                && 2 * before.samples.len() >= settling
                && after.samples.len() >= settling;
            if isolated && let Some(stroke) = measure(run, before, after, period) {
                strokes.push(stroke);
            }
        }
    }
    strokes
}

fn measure(run: &Run, before: &Hold, after: &Hold, period: f64) -> Option<Stroke> {
    let start = mean_output(run, last_quarter(&before.samples))?;
    let travel = mean_output(run, last_quarter(&after.samples))? - start;
    // From rest: a fast servo has left it by the first sample after the edge.
    let first = after.samples.start - before.samples.len().min(3);
    let relative: Vec<f64> = run.output()[first..after.samples.end]
        .windows(3)
        .map(|w| (w.iter().sum::<f64>() / 3.0 - start) / travel)
        .collect();
    let crossing = |level: f64| {
        let k = relative.iter().position(|z| *z >= level)?;
        let (low, high) = (*relative.get(k.checked_sub(1)?)?, relative[k]);
        let between = (level - low) / (high - low);
        // A missing sample on the way makes this NaN.
        between.is_finite().then_some((k - 1) as f64 + between)
    };
    let speed = |from: f64, to: f64| {
        let duration = (crossing(to)? - crossing(from)?) * period;
        (duration > 0.0).then(|| (to - from) * travel.abs() / duration)
    };
    let size = after.level - before.level;
    Some(Stroke {
        size,
        travel: travel * size.signum(),
        speed: speed(0.2, 0.8)?,
        mid_speed: speed(0.35, 0.65)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn holds_end_where_the_command_moves_or_is_missing() {
        let input = vec![1.0, 1.0, 2.0, 2.0, f64::NAN, 2.0, 3.0];
        let run = Run::new(input, vec![0.0; 7])
            .unwrap()
            .with_input_at_rest(0.0);
        let found: Vec<(Range<usize>, Option<f64>)> = holds(&run)
            .into_iter()
            .map(|hold| (hold.samples, hold.before))
            .collect();
        let expected = [
            (0..2, Some(0.0)),
            (2..4, Some(1.0)),
            (5..6, None),
            (6..7, Some(2.0)),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn a_straight_stroke_has_its_own_speed_whichever_part_is_timed() {
        let input: Vec<f64> = (0..80).map(|k| if k < 30 { 0.0 } else { 4.0 }).collect();
        let output: Vec<f64> = (0..80)
            .map(|k| (f64::from(k - 35) * 0.25).clamp(0.0, 4.0))
            .collect();
        let record = Record::from_slices(0.01, &input, &output).unwrap();
        let found = strokes(&record, 40);
        assert_eq!(found.len(), 1);
        assert_abs_diff_eq!(found[0].speed, 25.0, epsilon = 1e-9);
        assert_abs_diff_eq!(found[0].mid_speed, 25.0, epsilon = 1e-9);
        assert!(strokes(&record, 60).is_empty());
    }
}
