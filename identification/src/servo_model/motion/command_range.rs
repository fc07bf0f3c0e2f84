//! The range of the commands of a record: where it shows the servo, and where not.

use serde::{Deserialize, Serialize};

/// The least and the largest command of a record \[command\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CommandRange {
    /// The least.
    pub least: f64,
    /// The largest.
    pub largest: f64,
}

impl CommandRange {
    /// Half way between its ends.
    #[must_use]
    pub fn middle(&self) -> f64 {
        0.5 * (self.least + self.largest)
    }

    /// Whether `command` is among them.
    #[must_use]
    pub fn contains(&self, command: f64) -> bool {
        (self.least..=self.largest).contains(&command)
    }

    /// Half of the distance between its ends.
    #[must_use]
    pub fn amplitude(&self) -> f64 {
        0.5 * (self.largest - self.least)
    }
}
