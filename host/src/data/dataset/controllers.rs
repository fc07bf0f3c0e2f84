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
