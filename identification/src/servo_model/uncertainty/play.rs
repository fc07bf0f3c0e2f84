//! Play in the gears, between the shaft and what is measured.
//!
//! It leaves errors that change their sign where the motion turns round. A fit takes some of it for friction and for a longer delay.

use crate::data::column::span;

/// Width of the play, from one end to the other, as a share of the range of the motion.
const PLAY: f64 = 0.01;

/// What such play would take from the outputs `simulated`, by stretch and sample \[output\].
pub(super) fn shortfalls(simulated: &[Vec<f64>]) -> Vec<Vec<[f64; 1]>> {
    let range = span(simulated.iter().flatten().copied()).unwrap_or_default();
    let of_stretch = |output: &Vec<f64>| play(output, PLAY * range);
    simulated.iter().map(of_stretch).collect()
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
