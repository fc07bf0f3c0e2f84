//! Whether the output moves beyond where it rests under an outermost command: it does not, if that is a stop.

use crate::data::column::{mean, span};
use crate::data::{Record, Run, sensor_step, white_noise};

/// Rows in sequence whose mean is held against the rest: bounces of a stop and single wrong readings are shorter.
const ROWS: usize = 8;

/// Standard deviations of the white noise of such a mean that are no motion. Many means are tried.
const BY_NOISE: f64 = 5.0;

/// Share of the travel that is none.
const SHARE: f64 = 2e-3;

/// Whether the output of `record` moves beyond its `rest` under an outermost `command` that is held, by more than noise and a step of the sensor, while commands are farther out: what is beyond
/// under that command itself is an overshoot.
pub(crate) fn moves_beyond(record: &Record, [command, rest]: [f64; 2]) -> bool {
    let outputs: Vec<f64> = record.outputs().collect();
    let inputs: Vec<f64> = record.inputs().collect();
    let (Some(middle), Some(travel)) = (mean(&outputs), span(outputs.iter().copied())) else {
        return false;
    };
    let outwards = (rest - middle).signum();
    let side = mean(&inputs).map_or(0.0, |middle| (command - middle).signum());
    let is_out = |u: &f64| side * (u - command) > 0.0;
    let noise = white_noise(record).unwrap_or_default() / (ROWS as f64).sqrt();
    let step = sensor_step(record).unwrap_or_default();
    let least = (BY_NOISE * noise).max(step).max(SHARE * travel);
    let is_beyond = |(commands, outputs): (&[f64], &[f64])| {
        let mean = outputs.iter().sum::<f64>() / outputs.len() as f64;
        commands.iter().all(is_out) && outwards * (mean - rest) > least
    };
    let moves = |run: &Run<'_>| {
        let mut rows = run.input().windows(ROWS).zip(run.output().windows(ROWS));
        rows.any(is_beyond)
    };
    record.runs().iter().any(moves)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten stairs to 5 and back, then once to `farthest`.
    fn record(farthest: f64) -> Record<'static> {
        let stair = |k: u32| 5.0 * f64::from(k / 40 % 2);
        let crest = |k: u32| farthest * (std::f64::consts::PI * f64::from(k) / 100.0).sin();
        let noise = |k: u32| 0.02 * (0.7 * f64::from(k * k)).sin();
        let output: Vec<f64> = ((0..800).map(stair).chain((0..100).map(crest)).zip(0..))
            .map(|(y, k)| y + noise(k))
            .collect();
        Record::of_run(0.002, output.clone(), output).unwrap()
    }

    #[test]
    fn a_rest_that_the_output_passes_is_no_stop() {
        assert!(moves_beyond(&record(5.2), [5.0, 5.0]));
        assert!(!moves_beyond(&record(4.9), [5.0, 5.0]));
        // An overshoot under the farthest command.
        assert!(!moves_beyond(&record(5.2), [5.3, 5.0]));
    }
}
