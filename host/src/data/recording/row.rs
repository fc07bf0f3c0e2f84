//! One row: written, read, and held against itself.

use super::Header;
use super::scan::SAMPLE_PERIOD_S;
use servoid_protocol::timing::{SAMPLE_US, SAMPLES_PER_FRAME};
use servoid_protocol::{Counts, Degrees, PulseWidth, SensorScale, ServoScale};
use std::fmt::Write as _;

/// The longest run that the wire can number: 65 536 frames of 10 samples. A sample number beyond
/// it is damage, and must not decide how much memory is taken.
pub(super) const MOST_SAMPLES: u64 = 65_536 * SAMPLES_PER_FRAME as u64;

/// How numbers become a row.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowFormat {
    servo: ServoScale,
    sensor: SensorScale,
}

/// One row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    pub(super) sample: u64,
    pub(super) reference_deg: f64,
    pub(super) position_deg: f64,
    pub(super) counts: Counts,
    /// The pulse that commands the reference, to the nearest microsecond.
    pub(super) pulse: Option<PulseWidth>,
}

impl RowFormat {
    pub(super) fn new(header: &Header) -> Self {
        Self {
            servo: header.servo_scale(),
            sensor: header.sensor_scale(),
        }
    }

    /// Appends a row and its line end.
    pub(super) fn write(&self, text: &mut String, sample: u64, pulse: PulseWidth, counts: Counts) {
        // Whole microseconds, so that no row's time carries a rounding of its own.
        let time_us = sample.saturating_mul(SAMPLE_US.into());
        let _infallible = writeln!(
            text,
            "{sample},{}.{:03},{},{:.4},{}",
            time_us / 1_000_000,
            time_us % 1_000_000 / 1000,
            self.servo.degrees(pulse).0,
            self.sensor.degrees(counts).0,
            counts.0
        );
    }

    /// Reads a row, without its line end.
    pub(super) fn read(&self, line: &[u8]) -> Result<Row, &'static str> {
        let line = std::str::from_utf8(line).map_err(|_| "it is not text")?;
        let mut fields = line.split(',');
        let mut next = || fields.next().ok_or("it has too few fields");
        let (sample, time) = (next()?, next()?);
        let (reference, position) = (next()?, next()?);
        let counts = next()?;
        if fields.next().is_some() {
            return Err("it has too many fields");
        }
        let sample: u64 = sample
            .parse()
            .map_err(|_| "the sample number is no whole number")?;
        if sample >= MOST_SAMPLES {
            return Err("the sample number is beyond any run");
        }
        // Half a period is beyond any rounding, and less than the next sample.
        if (finite(time)? - sample as f64 * SAMPLE_PERIOD_S).abs() > 0.5 * SAMPLE_PERIOD_S {
            return Err("its time is not that of its sample number");
        }
        let reference_deg = finite(reference)?;
        Ok(Row {
            sample,
            reference_deg,
            position_deg: finite(position)?,
            counts: Counts(
                counts
                    .parse()
                    .map_err(|_| "the counts are no whole number")?,
            ),
            pulse: self.servo.pulse(Degrees(reference_deg)),
        })
    }

    /// Reads a row that a [`RowFormat`] has written: the time must be that of the sample, the
    /// position that of the counts, and the reference a whole number of microseconds.
    pub(super) fn read_exactly(&self, line: &[u8]) -> Result<Row, &'static str> {
        let row = self.read(line)?;
        let pulse = row.pulse.ok_or("there is no pulse for its reference")?;
        let mut written = String::new();
        self.write(&mut written, row.sample, pulse, row.counts);
        if written.trim_end().as_bytes() == line {
            return Ok(row);
        }
        let differs = |field| {
            let as_written = written.trim_end().split(',').nth(field).map(str::as_bytes);
            line.split(|&b| b == b',').nth(field) != as_written
        };
        Err(match [1, 2, 3].map(differs) {
            [true, ..] => "its time is not that of its sample number",
            [_, true, _] => "its reference is not that of a whole microsecond",
            [_, _, true] => "its position is not that of its counts",
            _ => "a number is not written as servoid writes it",
        })
    }
}

fn finite(text: &str) -> Result<f64, &'static str> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err("a field is no number"),
    }
}
