//! Pulse widths and counts become degrees.
//!
//! Rigs and recordings have microseconds and counts. The two columns that are identified are made of them
//! here, the same ones of a run under way as of its recording later.

use crate::data::recording::{Header, Row};
use crate::data::rig_file::RigFile;
use crate::data::sensor_health::HealthyCounts;
use servoid_protocol::{Counts, PulseWidth, SensorScale, ServoScale};

/// The scales of a servo and its sensor.
#[derive(Clone, Copy, Debug)]
pub struct DegreeScale {
    servo: ServoScale,
    sensor: SensorScale,
    healthy: HealthyCounts,
}

impl DegreeScale {
    /// Of a rig.
    #[must_use]
    pub fn of_rig(rig: &RigFile) -> Self {
        Self {
            servo: rig.servo_scale(),
            sensor: rig.sensor_scale(),
            healthy: rig.healthy_counts(),
        }
    }

    /// Of the rig that made a recording.
    #[must_use]
    pub fn of_recording(header: &Header) -> Self {
        Self {
            servo: header.servo_scale(),
            sensor: header.sensor_scale(),
            healthy: HealthyCounts::new(header.healthy_counts),
        }
    }

    /// The angle that a pulse commands (deg).
    #[must_use]
    pub fn reference(&self, pulse: PulseWidth) -> f64 {
        self.servo.degrees(pulse).0
    }

    /// The angle that counts stand for (deg), NaN where no healthy sensor gives them.
    ///
    /// It is rounded as in the recording's column, to four decimals, so that a program which reads that
    /// column computes with the same numbers.
    #[must_use]
    pub fn position(&self, counts: Counts) -> f64 {
        if self.healthy.contains(counts) {
            (self.sensor.degrees(counts).0 * 1e4).round() / 1e4
        } else {
            f64::NAN
        }
    }

    /// Samples of these rows that no healthy sensor gives.
    #[must_use]
    pub fn unhealthy(&self, rows: &[Row]) -> usize {
        let unhealthy = |row: &&Row| !self.healthy.contains(row.counts);
        rows.iter().filter(unhealthy).count()
    }

    /// Reference and position (deg) of rows whose sample numbers rise: one place per sample from the first
    /// to the last, NaN where one is lost in between.
    #[must_use]
    pub fn columns(&self, rows: &[Row]) -> (Vec<f64>, Vec<f64>) {
        let (Some(first), Some(last)) = (rows.first(), rows.last()) else {
            return (Vec::new(), Vec::new());
        };
        // A file cannot make this allocate more than a long run takes: sample numbers are bounded.
        let mut reference = vec![f64::NAN; (last.sample - first.sample) as usize + 1];
        let mut position = reference.clone();
        for row in rows {
            let place = (row.sample - first.sample) as usize;
            if let (Some(reference), Some(position)) =
                (reference.get_mut(place), position.get_mut(place))
            {
                *reference = self.reference(row.pulse);
                *position = self.position(row.counts);
            }
        }
        (reference, position)
    }
}
