//! Whether the second side turns the other way under the same command.
//!
//! Bounds of both gains say it where there are any. Elsewhere the records do: an output goes where its command went within the last quarter of a
//! second, and the sign of their correlation is that of the servo, whatever it is like. Without bounds the end of a step response may have the
//! other sign: of motions that never rest, and of responses that are not over.

use super::outcome::Comparison;
use super::pair::Identified;
use crate::data::{Record, Run};
use crate::results::Bounds;
use crate::thresholds::{FOLLOWS_COMMAND, FOLLOWS_ONE_WAY};

/// The longest time by which an output is looked for behind its command \[s\].
const FARTHEST_S: f64 = 0.25;

/// From the bounds of both gains, or else from the records.
pub(super) fn turns(found: &Comparison, sides: [&Identified<'_>; 2]) -> bool {
    match found.bounds {
        Bounds::Valid(_) => by_bounds(found),
        Bounds::Withdrawn(_) => {
            let [a, b] = sides.map(|side| {
                let reason = side.alone.level().withdrawn();
                let of_servo = reason.is_none_or(|reason| reason.leaves_a_servo());
                of_servo.then(|| is_along(side.record)).flatten()
            });
            a.zip(b).is_some_and(|(a, b)| a != b)
        }
    }
}

/// Whether the gains surely have different signs.
pub(super) fn by_bounds(found: &Comparison) -> bool {
    let mut rows = found.differences.iter();
    let gain = rows.find(|row| row.metric == "dc_gain");
    let both = gain.and_then(|row| row.a_bounds.zip(row.b_bounds));
    both.is_some_and(|([low_a, high_a], [low_b, high_b])| {
        (low_a > 0.0 && high_b < 0.0) || (high_a < 0.0 && low_b > 0.0)
    })
}

/// Whether the output follows the command in its direction, or against it; `None` where it may be either, as where the command is a sine.
fn is_along(record: &Record) -> Option<bool> {
    let farthest = (FARTHEST_S / record.sample_period_s()).ceil() as usize;
    let correlations = || (0..=farthest).map(|lag| correlation(record.runs(), lag));
    let along = correlations().fold(0.0, f64::max);
    let against = -correlations().fold(0.0, f64::min);
    let is_clear = along.max(against) > FOLLOWS_COMMAND
        && along.min(against) < FOLLOWS_ONE_WAY * along.max(against);
    is_clear.then_some(along > against)
}

/// The correlation of the output with the command so many samples before; NaN where one of them is constant.
fn correlation(runs: &[Run<'_>], lag: usize) -> f64 {
    let pairs = || {
        let of_run = |run| Run::output(run).iter().skip(lag).zip(Run::input(run));
        let known = |(y, u): &(&f64, &f64)| !(**y * **u).is_nan();
        runs.iter().flat_map(of_run).filter(known)
    };
    let count = pairs().count() as f64;
    let (y_sum, u_sum) = pairs().fold((0.0, 0.0), |(y_sum, u_sum), (y, u)| (y_sum + y, u_sum + u));
    let (y_mean, u_mean) = (y_sum / count, u_sum / count);
    let [yu, yy, uu] = pairs().fold([0.0; 3], |[yu, yy, uu], (y, u)| {
        let (y, u) = (y - y_mean, u - u_mean);
        [yu + y * u, yy + y * y, uu + u * u]
    });
    yu / (yy * uu).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(input: Vec<f64>, gain: f64, delay: usize) -> Option<bool> {
        let output: Vec<f64> = (0..input.len())
            .map(|k| gain * k.checked_sub(delay).map_or(0.0, |before| input[before]))
            .collect();
        is_along(&Record::of_run(0.01, input, output).unwrap())
    }

    #[test]
    fn the_direction_is_that_of_the_gain_and_of_a_sine_it_is_open() {
        // Levels as if at random, held for half the delay.
        let levels = |k: usize| ((k / 3 + 1).pow(2) * 3001 % 9973) as f64 - 4986.5;
        for gain in [1.0, -1.0, -0.2] {
            assert_eq!(
                of((0..900).map(levels).collect(), gain, 6),
                Some(gain > 0.0)
            );
        }
        let sine = |k: usize| (0.4 * k as f64).sin();
        assert_eq!(of((0..900).map(sine).collect(), -1.0, 6), None);
    }
}
