//! Whether the input is made of the output: what is new in it is explained by the outputs before.
//!
//! A planned command owes nothing to the motion. What its own past does not say of the next command, the past outputs do not say either.
//! A controller makes each command of them, and a servo whose columns were exchanged does so, too. The share that they explain,
//!
//! ```text
//! 1 - (RSS with outputs / its degrees of freedom) / (RSS of the own past / its degrees of freedom)
//! ```
//!
//! (C. W. J. Granger, *Investigating causal relations by econometric models and cross-spectral methods*, Econometrica 37, 1969) needs
//! no model of the servo, so that it also speaks where none describes the record.
//!
//! A command that is held for several samples has something new where it changes, and its past is in the levels before: ten samples may be a
//! single level, and the motion would say better how a planned command goes on.

use crate::data::{Record, usual_exact_hold};
use crate::diagnostics::residuals::simulation_error::{SAMPLES, beginnings};
use crate::thresholds::PLANNED;
use faer::Mat;

/// Levels of the input, and samples of the output, of the past. The present output is not among them: it may answer the present input.
const LAGS: usize = 10;

/// Regressors: 1, the last input and its changes; then the output and its changes.
const OWN: usize = LAGS + 1;
const ALL: usize = OWN + LAGS;

/// Changes of the input that are needed: several for each regressor.
const FEWEST_ROWS: usize = 8 * ALL;

/// Share of its variance that must be new in an input: below it is what rounding leaves of a smooth one.
const NEW: f64 = 1e-8;

/// Pivots below this share are combinations of the regressors before them.
const SEPARATE: f64 = 1e-9;

/// The share of what is new in the input that the outputs explain; `None` where nothing is new, or too few samples are there.
pub(crate) fn explained_by_output(record: &Record) -> Option<f64> {
    let mut products = Mat::<f64>::zeros(ALL + 1, ALL + 1);
    let mut rows = 0;
    let hold = usual_exact_hold(record).max(1);
    for run in beginnings(record.runs(), SAMPLES) {
        let (input, output) = (run.input(), run.output());
        for k in LAGS * hold..run.len() {
            if input[k] == input[k - 1] {
                continue;
            }
            let level = |lag: usize| match lag {
                0 => input[k],
                _ => input[k - 1 - (lag - 1) * hold],
            };
            let row = row(level, &output[k - LAGS..=k]);
            if row.iter().any(|value| value.is_nan()) {
                continue;
            }
            rows += 1;
            for i in 0..=ALL {
                for j in 0..=i {
                    products[(i, j)] += row[i] * row[j];
                }
            }
        }
    }
    if rows < FEWEST_ROWS {
        return None;
    }
    let sizes: Vec<f64> = (0..=ALL).map(|i| products[(i, i)]).collect();
    let (own, used) = left_after(&mut products, &sizes, 0..OWN);
    if own.is_nan() || own <= NEW * sizes[ALL] {
        return None;
    }
    let (with_output, more) = left_after(&mut products, &sizes, OWN..ALL);
    let per_degree = |sum: f64, used: usize| sum / (rows - used) as f64;
    Some(1.0 - per_degree(with_output, used + more) / per_degree(own, used))
}

/// Regressors, and the change of the input at last, from the levels of the input up to lag [`LAGS`] and the last samples of the output.
fn row(level: impl Fn(usize) -> f64, output: &[f64]) -> [f64; ALL + 1] {
    let mut row = [1.0; ALL + 1];
    let step = |lag: usize| level(lag) - level(lag + 1);
    (row[1], row[OWN]) = (level(1), output[LAGS - 1]);
    for lag in 1..LAGS {
        row[1 + lag] = step(lag);
        row[OWN + lag] = output[LAGS - lag] - output[LAGS - lag - 1];
    }
    row[ALL] = step(0);
    row
}

/// Takes these regressors out of all that come after them (elimination of symmetric equations); `sizes` are their squares. Returns what
/// is left of the target's square, and how many of them were no combinations of others.
fn left_after(
    products: &mut Mat<f64>,
    sizes: &[f64],
    regressors: std::ops::Range<usize>,
) -> (f64, usize) {
    let mut used = 0;
    for i in regressors {
        let pivot = products[(i, i)];
        if pivot.is_nan() || pivot <= SEPARATE * sizes[i] {
            continue;
        }
        used += 1;
        for a in i + 1..=ALL {
            let share = products[(a, i)] / pivot;
            for b in i + 1..=a {
                let product = products[(b, i)];
                products[(a, b)] -= share * product;
            }
        }
    }
    (products[(ALL, ALL)].max(0.0), used)
}

/// Second differences of the input that are none: below this share of the largest one, they are rounding.
const STRAIGHT: f64 = 1e-5;

/// Second differences of the output below this share of their rms say nothing of the input.
const AT_REST: f64 = 1e-2;

/// Whether the input is made of straight pieces, also where the output is not: a controller would carry the bends of the output into it.
pub(crate) fn is_of_straight_pieces(record: &Record) -> bool {
    let bends = |samples: &[f64]| -> Vec<f64> {
        let bend = |w: &[f64]| (w[2] - 2.0 * w[1] + w[0]).abs();
        samples.windows(3).map(bend).collect()
    };
    let pairs: Vec<(f64, f64)> = beginnings(record.runs(), SAMPLES)
        .flat_map(|run| bends(run.input()).into_iter().zip(bends(run.output())))
        .filter(|(u, y)| !u.is_nan() && !y.is_nan())
        .collect();
    let largest = pairs.iter().fold(0.0, |most: f64, (u, _)| most.max(*u));
    let mean_square = pairs.iter().map(|(_, y)| y * y).sum::<f64>() / pairs.len() as f64;
    let moving = || {
        pairs
            .iter()
            .filter(|(_, y)| *y > AT_REST * mean_square.sqrt())
    };
    let straight = moving().filter(|(u, _)| *u <= STRAIGHT * largest).count();
    straight as f64 > PLANNED * moving().count() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    /// A lag of 5 samples with noise under a reference of levels of 20 samples, planned or in the loop of a controller that answers one
    /// sample later.
    fn record(gain: f64, noise: f64) -> Record<'static> {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let levels: Vec<f64> = (0..300)
            .map(|_| random.random_range(-5.0..5.0f64).round())
            .collect();
        commanded(|k| levels[k / 20], gain, noise, 1)
    }

    /// The same lag under another reference, with commands that are held for so many samples.
    fn commanded(
        reference: impl Fn(usize) -> f64,
        gain: f64,
        noise: f64,
        held: usize,
    ) -> Record<'static> {
        let mut random = ChaCha8Rng::seed_from_u64(8);
        let (mut command, mut servo, mut measured, mut last) = (0.0, 0.0, 0.0, 0.0);
        let (mut input, mut output) = (Vec::new(), Vec::new());
        for k in 0..6000 {
            if k % held == 0 {
                command = reference(k) + gain * (reference(k) - measured);
            }
            servo += (last - servo) / 5.0;
            last = command;
            measured = servo + noise * random.sample::<f64, _>(StandardNormal);
            input.push(command);
            output.push(measured);
        }
        Record::of_run(0.01, input, output).unwrap()
    }

    #[test]
    fn outputs_explain_the_input_of_a_loop_and_not_a_planned_one() {
        for noise in [0.01, 0.5] {
            let planned = explained_by_output(&record(0.0, noise)).unwrap();
            assert!(planned < 0.05, "{planned}");
        }
        let looped = explained_by_output(&record(0.8, 2.0)).unwrap();
        assert!(looped > 0.5, "{looped}");
        // Exchanged columns: the command of before is in what is then the output.
        let one = record(0.0, 0.01);
        let run = &one.runs()[0];
        let exchanged = Record::of_run(0.01, run.output(), run.input()).unwrap();
        assert!(explained_by_output(&exchanged).unwrap() > 0.9);
    }

    /// The motion explained how a planned sum of sines went on, because ten samples of it were one level.
    #[test]
    fn a_planned_command_in_frames_has_its_past_in_frames() {
        let sines = |k: usize| -> f64 {
            let time = 0.002 * k as f64;
            let sine = |i: u32| {
                let hz = 5.5 + 0.1 * f64::from(i);
                (std::f64::consts::TAU * hz * time + f64::from(i * i)).sin()
            };
            ((0..11).map(sine).sum::<f64>() * 20.0).round() / 10.0
        };
        let planned = explained_by_output(&commanded(sines, 0.0, 0.01, 10)).unwrap();
        assert!(planned < 0.2, "{planned}");
        let looped = explained_by_output(&commanded(sines, 0.8, 2.0, 10)).unwrap();
        assert!(looped > 0.5, "{looped}");
    }

    #[test]
    fn planned_levels_are_straight_pieces_and_the_commands_of_a_loop_are_not() {
        assert!(is_of_straight_pieces(&record(0.0, 0.5)));
        assert!(!is_of_straight_pieces(&record(0.3, 0.5)));
        assert!(!is_of_straight_pieces(&record(0.3, 0.0)));
    }

    #[test]
    fn nothing_is_new_in_a_sum_of_sines() {
        let sines = |k: u32| (f64::from(k) * 0.03).sin() + (f64::from(k) * 0.11).sin();
        let input: Vec<f64> = (0..900).map(sines).collect();
        let output: Vec<f64> = (0..900u32)
            .map(|k| sines(k.saturating_sub(6)) + f64::from(k * 7919 % 101) * 1e-3)
            .collect();
        assert_eq!(
            explained_by_output(&Record::of_run(0.01, &input, &output).unwrap()),
            None
        );
    }
}
