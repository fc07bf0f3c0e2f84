//! One row, and how it is written.

use super::header::Header;
use servoid_protocol::timing::{SAMPLE_US, SAMPLES_PER_FRAME};
use servoid_protocol::{Counts, PulseWidth, SensorScale, ServoScale};
use std::fmt::Write as _;

/// The names of the columns. The degrees follow from the pulse and the counts, which are the data.
pub const COLUMNS: &str = "sample,time_s,reference_deg,position_deg,pulse_us,counts";

/// The names of the columns in formats 1 and 2.
pub(super) const COLUMNS_WITHOUT_PULSE: &str = "sample,time_s,reference_deg,position_deg,counts";

/// Time between rows (s).
pub(super) const SAMPLE_PERIOD_S: f64 = SAMPLE_US as f64 * 1e-6;

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

/// The scales by which rows are written.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowFormat {
    pub(super) servo: ServoScale,
    pub(super) sensor: SensorScale,
}

impl RowFormat {
    pub(super) fn new(header: &Header) -> Self {
        Self {
            servo: header.servo_scale(),
            sensor: header.sensor_scale(),
        }
    }

    /// Appends a row and its line end.
    pub(super) fn write(&self, text: &mut String, row: Row) {
        // Whole microseconds, so that no row's time carries a rounding of its own.
        let time_us = row.sample.saturating_mul(SAMPLE_US.into());
        let _infallible = writeln!(
            text,
            "{},{}.{:03},{},{},{},{}",
            row.sample,
            time_us / 1_000_000,
            time_us % 1_000_000 / 1000,
            self.reference_text(row.pulse),
            self.position_text(row.counts),
            row.pulse.0,
            row.counts.0,
        );
    }

    /// The angle that a pulse commands, as it is written.
    pub(super) fn reference_text(&self, pulse: PulseWidth) -> String {
        self.servo.degrees(pulse).0.to_string()
    }

    /// The angle that counts stand for, as it is written.
    pub(super) fn position_text(&self, counts: Counts) -> String {
        format!("{:.4}", self.sensor.degrees(counts).0)
    }
}
