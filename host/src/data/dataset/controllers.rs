//! Several controllers on one mechanism: which of them drove each run.

/// What the controller of each run is called, such as its gain; empty where all runs have the same one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Controllers(pub(super) Vec<f64>);

/// A run has a controller that a model does not know.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "the controller {found} is none of those of the model ({}): identify with runs of that controller too",
    known.iter().map(f64::to_string).collect::<Vec<_>>().join(", ")
)]
pub struct UnknownController {
    found: f64,
    known: Vec<f64>,
}

impl Controllers {
    /// The controller of each run, by its name.
    #[must_use]
    pub fn of_runs(names: Vec<f64>) -> Self {
        Self(names)
    }

    /// The name of what drove the run number `run` (from 0); `None` where all runs have the same.
    #[must_use]
    pub fn of_run(&self, run: usize) -> Option<f64> {
        self.0.get(run).copied()
    }

    /// Whether what drove the run number `run` drove another one too.
    #[must_use]
    pub fn drives_another_than(&self, run: usize) -> bool {
        let others = |name: &f64| self.0.iter().filter(|other| *other == name).count() > 1;
        self.0.get(run).is_none_or(others)
    }

    /// Those of all runs but the run number `run`.
    #[must_use]
    pub fn without(&self, run: usize) -> Self {
        let others = self.0.iter().enumerate().filter(|(other, _)| *other != run);
        Self(others.map(|(_, name)| *name).collect())
    }

    /// The different ones, in the order in which they appear.
    #[must_use]
    pub fn names(&self) -> Vec<f64> {
        let mut names: Vec<f64> = Vec::new();
        for name in &self.0 {
            if !names.contains(name) {
                names.push(*name);
            }
        }
        names
    }

    /// The place of each run's controller among `names`.
    ///
    /// # Errors
    /// A run has another one.
    pub fn among(&self, names: &[f64]) -> Result<Vec<usize>, UnknownController> {
        let place = |name: &f64| {
            let found = names.iter().position(|known| known == name);
            found.ok_or_else(|| UnknownController {
                found: *name,
                known: names.to_owned(),
            })
        };
        self.0.iter().map(place).collect()
    }
}
