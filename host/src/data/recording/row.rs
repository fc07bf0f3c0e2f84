//! One row, and the columns of its text.

use servoid_protocol::timing::SAMPLES_PER_FRAME;
use servoid_protocol::{Counts, PulseWidth};

/// The names of the columns. The degrees follow from the pulse and the counts, which are the data.
pub const COLUMNS: &str = "sample,time_s,reference_deg,position_deg,pulse_us,counts,check";

/// The columns of the rows below a header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Columns {
    /// As they are written today.
    Checked,
    /// As in early files of format 3, in which no row has a check of its own.
    Unchecked,
    /// As in formats 1 and 2.
    WithoutPulse,
}

impl Columns {
    /// Of the line with their names; `None` for any other line.
    pub(super) fn named(line: &[u8]) -> Option<Self> {
        let names = line.trim_ascii_end();
        let known = [Self::Checked, Self::Unchecked, Self::WithoutPulse];
        known
            .into_iter()
            .find(|columns| names == columns.names().as_bytes())
    }

    fn names(self) -> &'static str {
        match self {
            Self::Checked => COLUMNS,
            Self::Unchecked => "sample,time_s,reference_deg,position_deg,pulse_us,counts",
            Self::WithoutPulse => "sample,time_s,reference_deg,position_deg,counts",
        }
    }

    /// Whether the pulse has a column.
    pub(super) fn has_pulse(self) -> bool {
        self != Self::WithoutPulse
    }
}

/// The longest run that the wire can number: 65 536 frames of 10 samples. A sample number beyond
/// it is damage, and must not decide how much memory is taken.
pub(super) const MOST_SAMPLES: u64 = 65_536 * SAMPLES_PER_FRAME as u64;

/// The data of one row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    /// Number of the sample, from the first one of the run.
    pub sample: u64,
    /// The pulse that was applied.
    pub pulse: PulseWidth,
    /// The raw reading of the sensor.
    pub counts: Counts,
}
