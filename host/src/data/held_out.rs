//! A stretch of a record that is held out: models that are identified from the rest can show how they predict it.

use crate::data::dataset::Dataset;
use servoid_identification::Run;
use std::ops::Range;

/// Runs from which on a whole one can be spared.
const RUNS: usize = 4;

/// A stretch, and the data without it.
#[derive(Clone, Debug)]
pub struct HeldOut<'a> {
    /// The data without the stretch.
    pub rest: Dataset<'a>,
    /// The whole run to which it belongs.
    pub run: Run<'a>,
    /// The name of what drove that run; `None` where all runs have the same.
    pub controller: Option<f64>,
    /// The samples of the run that are held out.
    pub samples: Range<usize>,
    /// "the last run", for a caption.
    pub words: &'static str,
}

/// A stretch of a record, and what two models predict of it that were identified without it.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldOutPrediction {
    /// What part of the record it is, in words.
    pub stretch: &'static str,
    /// Sample period \[s\].
    pub period_s: f64,
    /// Fit of the linear model and of the servo model, on the samples that both predict \[%\].
    pub fits_percent: [f64; 2],
    /// The measured output, sample by sample.
    pub measured: Vec<f64>,
    /// The output of the linear model; NaN where its history is not complete.
    pub by_linear: Vec<f64>,
    /// The output of the servo model.
    pub by_servo: Vec<f64>,
}

impl<'a> HeldOut<'a> {
    /// Holds out the last run of four or more, else the last fifth of the last run. A controller that drives no other run
    /// is not held out. `None` where nothing can be identified from the rest.
    #[must_use]
    pub fn of(data: &'a Dataset) -> Option<Self> {
        let runs = data.record.runs();
        let spared = (0..runs.len())
            .rev()
            .find(|&run| runs.len() >= RUNS && data.controllers.drives_another_than(run));
        let number = spared.or(runs.len().checked_sub(1))?;
        let run = runs.get(number)?;
        let (first, words) = match spared {
            Some(run) if run + 1 == runs.len() => (0, "the last run"),
            Some(_) => (0, "one run"),
            None => (run.len() * 4 / 5, "the last fifth of the last run"),
        };
        let mut others = runs.to_vec();
        let kept = (first > 0).then(|| run.part(0..first));
        if spared.is_none() && kept.is_none() {
            return None;
        }
        others.splice(number..=number, kept);
        Some(Self {
            rest: Dataset {
                record: data.record.try_with_runs(others).ok()?,
                controllers: match first {
                    0 => data.controllers.without(number),
                    _ => data.controllers.clone(),
                },
                about: data.about.clone(),
            },
            samples: first..run.len(),
            controller: data.controllers.of_run(number),
            run: run.clone(),
            words,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::dataset::{About, Controllers};
    use servoid_identification::Record;

    fn data(runs: usize, controllers: &[f64]) -> Dataset<'static> {
        let run = |k: usize| {
            let u: Vec<f64> = (0..10).map(|j| ((j + k) % 3) as f64).collect();
            Run::new(u.clone(), u).unwrap()
        };
        Dataset {
            record: Record::new(0.01, (0..runs).map(run).collect())
                .unwrap()
                .with_sample_phase(0.002),
            controllers: Controllers::of_runs(controllers.to_vec()),
            about: About::default(),
        }
    }

    #[test]
    fn of_many_runs_one_is_held_out_and_of_few_the_end() {
        let [one, many] = [1, 5].map(|runs| data(runs, &[]));
        let one = HeldOut::of(&one).unwrap();
        assert_eq!(one.samples, 8..10);
        assert_eq!(one.rest.record.samples(), 8);
        assert_eq!(one.rest.record.sample_phase_s(), 0.002);
        let many = HeldOut::of(&many).unwrap();
        assert_eq!((many.samples, many.words), (0..10, "the last run"));
        assert_eq!(many.rest.record.runs().len(), 4);
    }

    #[test]
    fn a_controller_that_drives_no_other_run_stays() {
        let all = data(4, &[400.0, 400.0, 400.0, 800.0]);
        let all = HeldOut::of(&all).unwrap();
        assert_eq!(all.controller, Some(400.0));
        assert_eq!(all.rest.controllers.names(), [400.0, 800.0]);
        let none = data(4, &[1.0, 2.0, 3.0, 4.0]);
        let none = HeldOut::of(&none).unwrap();
        assert_eq!(none.controller, Some(4.0));
        assert_eq!(none.samples, 8..10);
        assert_eq!(none.rest.controllers.names(), [1.0, 2.0, 3.0, 4.0]);
    }
}
