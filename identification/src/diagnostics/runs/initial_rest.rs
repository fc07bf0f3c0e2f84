//! Test of the stated input before a run against its first readings.
//!
//! The statement adds N-1 rows to the regression that would have no history otherwise. A wrong statement
//! causes errors of several times the bounds. Before the servo has moved, the first readings show whether it
//! was where the stated input would have brought it.

use serde::{Deserialize, Serialize};

use crate::data::{Record, Run};
use crate::results::Model;
use crate::thresholds::INITIAL_REST_MISSED;

/// Readings used at the beginning of a run. The servo has not moved far by the last one.
const READINGS: usize = 3;

/// A run whose first readings contradict the stated input.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Contradicted {
    /// Run, counted from 1.
    pub run: usize,
    /// The input that was stated.
    pub stated: f64,
    /// Distance of the first readings from the stated rest \[output\].
    pub error: f64,
    /// The same in multiples of the usual error (rms).
    pub times_usual: f64,
    /// The input at which the servo would rest at the first readings, by the model's gain.
    pub rather: f64,
}

/// The run of `record` that contradicts its statement most, if any.
#[must_use]
pub(crate) fn contradicted_rest(record: &Record, model: &Model) -> Option<Contradicted> {
    record.runs().iter().find_map(Run::input_at_rest)?;
    let errors: Vec<Vec<f64>> = record
        .runs()
        .iter()
        .map(|run| {
            let pairs = run.output().iter().zip(model.simulate(run));
            pairs.map(|(y, s)| y - s).collect()
        })
        .collect();
    let usual = usual(&errors, model.structure.settling_samples)?;
    let gain = *model.theta.first()?;
    // Remaining share, sample by sample, of an error at the beginning.
    let remaining: Vec<f64> = model.step.value.iter().map(|g| 1.0 - g / gain).collect();
    let of_run = |(index, (run, errors)): (usize, (&Run, &Vec<f64>))| {
        let stated = run.input_at_rest()?;
        let first = errors.iter().take(READINGS).zip(&remaining);
        let (square, product) = first
            .filter(|(error, _)| !error.is_nan())
            .fold((0.0, 0.0), |(square, product), (error, share)| {
                (square + share * share, product + share * error)
            });
        let error = product / square;
        (square > 0.0).then_some(Contradicted {
            run: index + 1,
            stated,
            error,
            times_usual: error.abs() / usual,
            rather: stated + error / gain,
        })
    };
    record
        .runs()
        .iter()
        .zip(&errors)
        .enumerate()
        .filter_map(of_run)
        .filter(|found| found.times_usual > INITIAL_REST_MISSED)
        .max_by(|a, b| a.times_usual.total_cmp(&b.times_usual))
}

/// Root mean square of the errors after the first settling time of each run, or of all errors when runs are
/// too short.
fn usual(errors: &[Vec<f64>], settling: usize) -> Option<f64> {
    let rms = |skipped: usize| {
        let later = errors.iter().flat_map(|run| run.iter().skip(skipped));
        let (count, square) = later
            .filter(|error| !error.is_nan())
            .fold((0usize, 0.0), |(n, sum), error| {
                (n + 1, sum + error * error)
            });
        let rms = (square / count as f64).sqrt();
        (count >= settling && rms > 0.0).then_some(rms)
    };
    rms(settling).or_else(|| rms(0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::Check;
    use crate::{Options, identify};

    /// A first-order servo that has rested at 2 and then gets random levels.
    fn record(stated: f64) -> Record<'static> {
        let level = |k: usize| (k / 9 * 7919 % 101) as f64 / 25.0;
        let input: Vec<f64> = (0..900).map(level).collect();
        let mut s = 2.0;
        let noise = |k: usize| 0.02 * ((k * 7919 % 101) as f64 - 50.0) / 50.0;
        let output: Vec<f64> = input
            .iter()
            .enumerate()
            .map(|(k, u)| {
                s += 0.3 * (u - s);
                s + noise(k)
            })
            .collect();
        let run = Run::new(input, output).unwrap().with_input_at_rest(stated);
        Record::new(0.01, vec![run]).unwrap()
    }

    #[test]
    fn a_wrong_statement_is_contradicted_and_a_right_one_is_not() {
        let found = |stated: f64| {
            let record = record(stated);
            let model = identify(&record, &Options::default()).unwrap();
            (contradicted_rest(&record, &model), model)
        };
        let (right, model) = found(2.0);
        assert_eq!(right, None);
        assert!(
            model
                .advice
                .iter()
                .all(|advice| advice.check != Check::AtRest)
        );
        let (wrong, model) = found(-1.0);
        let wrong = wrong.unwrap();
        // The wrong rows bend the model.
        assert!((1.0..3.0).contains(&wrong.rather), "{wrong:?}");
        let advice = model
            .advice
            .iter()
            .find(|advice| advice.check == Check::AtRest);
        assert!(advice.unwrap().finding.contains("-1"), "{advice:?}");
    }
}
