//! Whether the errors hold what the equation does not have, by [score tests](crate::servo_model::uncertainty::score_test).
//!
//! Whatever is missing, such as another filter or a load of another shape, leaves errors at certain times after the command
//! changes: sums of these changes over a few stretches of time, as they are, by size and by size squared. Play in the gears leaves
//! errors that change their sign where the motion turns round; one width stands for all, since small play has one shape.

use super::covariance::Uncertainty;
use super::discrepancy::WINDOWS;
use super::score_test::score_test;
use crate::data::column::span;
use crate::servo_model::descent::coordinates::Point;
use crate::servo_model::stretches::Stretch;

/// Columns: each stretch of time with the change, its size, and its square with the sign.
const OF_COMMAND: usize = 3 * WINDOWS;

/// Width of the play, from one end to the other, as a share of the range of the motion.
const PLAY: f64 = 0.01;

/// Whether the errors follow the command beyond chance.
pub(super) fn follows_command(stretches: &[Stretch], point: &Point, found: &Uncertainty) -> bool {
    let columns: Vec<Vec<[f64; OF_COMMAND]>> = stretches
        .iter()
        .map(|stretch| sums(&stretch.input, found.window))
        .collect();
    beyond_chance(point, found, &columns)
}

/// Whether the errors are those of play in the gears, beyond chance.
pub(super) fn has_play(point: &Point, found: &Uncertainty) -> bool {
    let outputs = found.motion.simulated.iter().flatten().copied();
    let range = span(outputs).unwrap_or_default();
    let columns: Vec<Vec<[f64; 1]>> = found
        .motion
        .simulated
        .iter()
        .map(|output| play(output, PLAY * range))
        .collect();
    beyond_chance(point, found, &columns)
}

/// Whether `columns`, by stretch and sample, explain more of the errors than chance does.
fn beyond_chance<const N: usize>(
    point: &Point,
    found: &Uncertainty,
    columns: &[Vec<[f64; N]>],
) -> bool {
    let Some(noise) = &found.at_rest else {
        return false;
    };
    score_test(&found.rows, point.values.len(), columns, noise)
        .is_some_and(|score| score.is_beyond_chance())
}

/// For each sample the sums of earlier changes of the command, over windows of `window` samples.
fn sums(input: &[f64], window: usize) -> Vec<[f64; OF_COMMAND]> {
    let mut sums = vec![[0.0; OF_COMMAND]; input.len()];
    for (k, pair) in input.windows(2).enumerate() {
        let change = pair[1] - pair[0];
        if change == 0.0 {
            continue;
        }
        let last = input.len().min(k + 1 + WINDOWS * window);
        for (lag, sums) in sums[k + 1..last].iter_mut().enumerate() {
            let first = 3 * (lag / window);
            sums[first] += change;
            sums[first + 1] += change.abs();
            sums[first + 2] += change * change.abs();
        }
    }
    sums
}

/// For each sample how far play of a width lets the measured output lag behind, from the middle of the play on. Where no output was
/// measured, it stands still.
fn play(output: &[f64], width: f64) -> Vec<[f64; 1]> {
    let first = output.iter().find(|y| !y.is_nan());
    let mut behind = first.copied().unwrap_or(0.0);
    let lag = |y: &f64| {
        if y.is_nan() {
            return [0.0];
        }
        behind = behind.clamp(y - 0.5 * width, y + 0.5 * width);
        [behind - y]
    };
    output.iter().map(lag).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn play_lags_behind_by_half_its_width_after_a_turn() {
        let there_and_back = [0.0, 1.0, 2.0, 1.9, 1.0, f64::NAN, 0.0];
        let lag: Vec<f64> = play(&there_and_back, 0.4)
            .iter()
            .map(|[lag]| *lag)
            .collect();
        let exact = [0.0, -0.2, -0.2, -0.1, 0.2, 0.0, 0.2];
        for (lag, exact) in lag.iter().zip(exact) {
            assert!((lag - exact).abs() < 1e-12, "{lag} {exact}");
        }
    }
}
