//! A stretch of a record that is held out: models that are identified from the rest can show how they predict it.

use super::{Controllers, Dataset};
use servoid_identification::{Record, Run};
use std::ops::Range;

/// Runs from which on a whole one can be spared.
const RUNS: usize = 4;

/// A stretch, and the data without it.
#[derive(Clone, Debug)]
pub struct HeldOut {
    /// The data without the stretch.
    pub rest: Dataset,
    /// The whole run to which it belongs.
    pub run: Run,
    /// The name of what drove that run; `None` where all runs have the same.
    pub controller: Option<f64>,
    /// The samples of the run that are held out.
    pub samples: Range<usize>,
    /// "the last run", for a caption.
    pub words: &'static str,
}

impl Dataset {
    /// Holds out the last run of four or more, else the last fifth of the last run. A controller that drives no other run
    /// is not held out. `None` where nothing can be identified from the rest.
    #[must_use]
    pub fn held_out(&self) -> Option<HeldOut> {
        let runs = self.record.runs();
        let spared = (0..runs.len())
            .rev()
            .find(|&run| runs.len() >= RUNS && self.controllers.drives_another_than(run));
        let (number, first, words) = match spared {
            Some(run) if run + 1 == runs.len() => (run, 0, "the last run"),
            Some(run) => (run, 0, "one run"),
            None => {
                let last = runs.len().checked_sub(1)?;
                let first = runs[last].len() * 4 / 5;
                (last, first, "the last fifth of the last run")
            }
        };
        let run = runs[number].clone();
        let mut others = runs.to_vec();
        let mut controllers = self.controllers.clone();
        if first == 0 {
            others.remove(number);
            controllers.remove(number);
        } else {
            others[number] = run.part(0..first);
        }
        let record = Record::new(self.record.sample_period_s(), others).ok()?;
        Some(HeldOut {
            rest: Dataset {
                record: record
                    .with_sample_phase(self.record.sample_phase_s())
                    .with_rest(self.record.rest().to_vec()),
                controllers,
                about: self.about.clone(),
            },
            samples: first..run.len(),
            controller: self.controllers.0.get(number).copied(),
            run,
            words,
        })
    }
}

impl Controllers {
    /// Whether what drove the run number `run` drove another one too.
    fn drives_another_than(&self, run: usize) -> bool {
        let others = |name: &f64| self.0.iter().filter(|other| *other == name).count() > 1;
        self.0.get(run).is_none_or(others)
    }

    fn remove(&mut self, run: usize) {
        if run < self.0.len() {
            self.0.remove(run);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn data(runs: usize, controllers: &[f64]) -> Dataset {
        let run = |k: usize| {
            let u: Vec<f64> = (0..10).map(|j| ((j + k) % 3) as f64).collect();
            Run::new(u.clone(), u).unwrap()
        };
        Dataset {
            record: Record::new(0.01, (0..runs).map(run).collect())
                .unwrap()
                .with_sample_phase(0.002),
            controllers: Controllers(controllers.to_vec()),
            about: super::super::About::default(),
        }
    }

    #[test]
    fn of_many_runs_one_is_held_out_and_of_few_the_end() {
        let one = data(1, &[]).held_out().unwrap();
        assert_eq!(one.samples, 8..10);
        assert_eq!(one.rest.record.samples(), 8);
        assert_eq!(one.rest.record.sample_phase_s(), 0.002);
        let many = data(5, &[]).held_out().unwrap();
        assert_eq!((many.samples, many.words), (0..10, "the last run"));
        assert_eq!(many.rest.record.runs().len(), 4);
    }

    #[test]
    fn a_controller_that_drives_no_other_run_stays() {
        let all = data(4, &[400.0, 400.0, 400.0, 800.0]).held_out().unwrap();
        assert_eq!(all.controller, Some(400.0));
        assert_eq!(all.rest.controllers.names(), [400.0, 800.0]);
        let none = data(4, &[1.0, 2.0, 3.0, 4.0]).held_out().unwrap();
        assert_eq!(none.controller, Some(4.0));
        assert_eq!(none.samples, 8..10);
        assert_eq!(none.rest.controllers.names(), [1.0, 2.0, 3.0, 4.0]);
    }
}
