//! Single rows of a recording that stand apart from their neighbours, as spikes of a sensor or of its line do.
//!
//! A motor cannot leave its course for one row: what a model misses goes on from row to row, and a spike does not. So the error of each row is held
//! against the median of the six around it, two of which may be spikes too. The reading itself stands apart there as well, at least by half of that: else it is the model that jumps.

use servoid_identification::Run;
use servoid_identification::column::median;

/// A row is apart by more than so many times what is usual: noise of heavy tails goes on from there. By choice, not tuned.
const APART: f64 = 50.0;

/// Rows on each side that a row is held against.
const BESIDE: usize = 3;

/// The spikes of some runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Spikes {
    /// How many rows.
    pub(crate) count: usize,
    /// When the first of them is, within its run \[s\].
    pub(crate) first_s: f64,
    /// The error of all other rows (rms).
    pub(crate) left: f64,
}

impl Spikes {
    /// Those of runs against what a model `simulated` of them; `None` where there are none.
    pub(crate) fn of(runs: &[Run<'_>], simulated: &[Vec<f64>], period_s: f64) -> Option<Self> {
        let errors = |(run, simulated): (&Run<'_>, &Vec<f64>)| -> Vec<f64> {
            let pairs = run.output().iter().zip(simulated);
            pairs
                .map(|(measured, simulated)| measured - simulated)
                .collect()
        };
        let errors: Vec<Vec<f64>> = runs.iter().zip(simulated).map(errors).collect();
        let apart: Vec<Vec<f64>> = errors.iter().map(|run| beside_neighbours(run)).collect();
        let known = apart
            .iter()
            .flatten()
            .copied()
            .filter(|apart| !apart.is_nan());
        let usual = median(known.collect())?;
        let readings: Vec<Vec<f64>> = runs
            .iter()
            .map(|run| beside_neighbours(run.output()))
            .collect();
        let is_spike =
            |(apart, reading): (f64, f64)| apart > APART * usual && reading > 0.5 * apart;
        let apart: Vec<Vec<bool>> = (apart.iter().zip(&readings))
            .map(|(run, readings)| {
                let both = run.iter().copied().zip(readings.iter().copied());
                both.map(is_spike).collect()
            })
            .collect();
        let first = |run: &Vec<bool>| run.iter().position(|is_spike| *is_spike);
        let first = apart.iter().find_map(first)?;
        let rows = || apart.iter().flatten().zip(errors.iter().flatten());
        let others = rows().filter(|(is_spike, error)| !error.is_nan() && !**is_spike);
        let (count, squares) = others.fold((0.0, 0.0), |(count, squares), (_, error)| {
            (count + 1.0, squares + error * error)
        });
        Some(Self {
            count: rows().filter(|(is_spike, _)| **is_spike).count(),
            first_s: first as f64 * period_s,
            left: (squares / count).sqrt(),
        })
    }
}

/// How far each error is from the median of its neighbours; a number only where enough of these are known.
fn beside_neighbours(errors: &[f64]) -> Vec<f64> {
    let apart = |k: usize| {
        let around = k.saturating_sub(BESIDE)..(k + BESIDE + 1).min(errors.len());
        let beside = around.filter(|other| *other != k);
        let known: Vec<f64> = beside
            .filter_map(|other| errors.get(other).copied())
            .filter(|error| !error.is_nan())
            .collect();
        let is_enough = known.len() > BESIDE;
        let middle = median(known).filter(|_| is_enough).unwrap_or(f64::NAN);
        errors
            .get(k)
            .map_or(f64::NAN, |error| (error - middle).abs())
    };
    (0..errors.len()).map(apart).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Noise in ±0.1 about a model that a wrong delay makes miss by up to 5 in motion, and spikes of 40 at some rows.
    fn found(spikes: &[usize]) -> Option<Spikes> {
        let simulated: Vec<f64> = (0..600).map(|k| 10.0 * (0.05 * k as f64).sin()).collect();
        let measured: Vec<f64> = (0..600)
            .map(|k| {
                let noise = 0.1 * ((k * 7919 % 101) as f64 / 50.0 - 1.0);
                let spike = if spikes.contains(&k) { 40.0 } else { 0.0 };
                10.0 * (0.05 * (k as f64 - 10.0)).sin() + noise + spike
            })
            .collect();
        let run = Run::new(vec![0.0; 600], measured).unwrap();
        Spikes::of(&[run], &[simulated], 0.01)
    }

    #[test]
    fn single_rows_are_spikes_and_motion_that_a_model_misses_is_none() {
        assert_eq!(found(&[]), None);
        let spikes = found(&[100, 250, 251, 400]).unwrap();
        assert_eq!((spikes.count, spikes.first_s), (4, 1.0));
        // The wrong delay alone is left: 2 sin(0.25) of 10, rms.
        let of_delay = 10.0 * 2.0 * 0.25_f64.sin() / 2.0_f64.sqrt();
        assert!((spikes.left / of_delay - 1.0).abs() < 0.05, "{spikes:?}");
    }

    #[test]
    fn missing_rows_are_no_spikes() {
        let measured: Vec<f64> = (0..200)
            .map(|k| {
                if k % 50 == 0 {
                    f64::NAN
                } else {
                    0.1 * (k % 3) as f64
                }
            })
            .collect();
        let run = Run::new(vec![0.0; 200], measured).unwrap();
        assert_eq!(Spikes::of(&[run], &[vec![0.0; 200]], 0.01), None);
    }
}
