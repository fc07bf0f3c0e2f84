//! Whether the sensor can be believed: judged here, in counts, of recordings and of runs under way alike.

use servoid_protocol::Counts;

/// The readings that a healthy sensor gives. A shorted, open or loose wire reads outside them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HealthyCounts {
    /// The smallest one.
    pub lowest: Counts,
    /// The largest one.
    pub highest: Counts,
}

impl HealthyCounts {
    /// From the smallest reading to the largest; every reading where they were not written down.
    #[must_use]
    pub fn new(range: Option<[u16; 2]>) -> Self {
        let [lowest, highest] = range.unwrap_or([0, u16::MAX]).map(Counts);
        Self { lowest, highest }
    }

    /// Whether a healthy sensor gives this reading.
    #[must_use]
    pub fn contains(&self, counts: Counts) -> bool {
        (self.lowest..=self.highest).contains(&counts)
    }
}
