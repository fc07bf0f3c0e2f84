//! Pulse widths and counts of a rig become degrees here.
//!
//! Rigs and recordings have microseconds and counts. The two columns that are identified, the columns that
//! people read in a recording, and the live view are all made of them here. A calibration has no such scales yet: it finds them, and has
//! the degrees of its readings by the sensor's section alone.

use crate::data::recording::{Header, Row};
use crate::data::rig_file::RigFile;
use servoid_protocol::{Counts, Degrees, PulseWidth, SensorScale, ServoScale};
use std::ops::RangeInclusive;

/// The scales of a servo and its sensor.
#[derive(Clone, Debug)]
pub struct DegreeScale {
    servo: ServoScale,
    sensor: SensorScale,
    /// What a healthy sensor reads. A shorted, open or loose wire reads outside.
    healthy: RangeInclusive<u16>,
}

impl DegreeScale {
    /// Of a rig.
    pub fn of_rig(rig: &RigFile) -> Self {
        let [lowest, highest] = rig.sensor.healthy_counts;
        Self {
            servo: rig.servo_scale(),
            sensor: rig.sensor_scale(),
            healthy: lowest..=highest,
        }
    }

    /// Of the rig that made a recording.
    pub fn of_recording(header: &Header) -> Self {
        let [lowest, highest] = header.healthy_counts.unwrap_or([0, u16::MAX]);
        Self {
            servo: ServoScale {
                neutral: PulseWidth(header.neutral_us),
                us_per_degree: header.us_per_degree,
            },
            sensor: SensorScale {
                zero_counts: header.zero_counts,
                degrees_per_count: header.degrees_per_count,
            },
            healthy: lowest..=highest,
        }
    }

    /// The angle that a pulse commands (deg).
    pub fn reference(&self, pulse: PulseWidth) -> f64 {
        self.servo.degrees(pulse).0
    }

    /// The pulse that commands an angle (deg), where there is one.
    pub(crate) fn pulse(&self, reference: f64) -> Option<PulseWidth> {
        self.servo.pulse(Degrees(reference))
    }

    /// The angle that counts stand for (deg), whether or not a healthy sensor gives them.
    ///
    /// It has four decimals, as it is written: a program that reads the column of a recording computes with the
    /// same numbers.
    pub fn angle(&self, counts: Counts) -> f64 {
        let degrees = self.sensor.degrees(counts).0;
        let rounded = (degrees * 1e4).round();
        if (degrees * 1e4 - rounded).abs() < 0.499 {
            return rounded / 1e4;
        }
        // The product is rounded itself. Where that could turn the last digit, the text decides.
        format!("{degrees:.4}").parse().unwrap_or(degrees)
    }

    /// The angle that counts stand for (deg), NaN where no healthy sensor gives them.
    pub fn position(&self, counts: Counts) -> f64 {
        match self.healthy.contains(&counts.0) {
            true => self.angle(counts),
            false => f64::NAN,
        }
    }

    /// Samples of these rows that no healthy sensor gives.
    pub(crate) fn unhealthy(&self, rows: &[Row]) -> usize {
        let unhealthy = |row: &&Row| !self.healthy.contains(&row.counts.0);
        rows.iter().filter(unhealthy).count()
    }

    /// Reference and position (deg) of rows whose sample numbers rise: one place per sample from the first
    /// to the last, NaN where one is lost in between.
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
