//! The delay of a sensor, taken out of a recording.

use super::error::DatasetFault;
use crate::data::recording::{Header, ReadFault};
use crate::data::rig_file::LONGEST_DELAY_MS;

/// The moments that the samples of a recording stand for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SensorDelay {
    /// The delay, and how far the true one may be from it (s).
    pub(super) delay_s: f64,
    pub(super) uncertainty_s: f64,
    /// A sample belongs to the input so many samples before the one that was recorded with it.
    pub(super) samples: usize,
    /// From a change of the input to the sample that belongs to it (s): less than a period.
    pub(super) phase_s: f64,
}

impl SensorDelay {
    /// That of a recording.
    pub(super) fn of(header: &Header) -> Result<Self, DatasetFault> {
        let fault = |reason: &str| {
            let damaged = ReadFault::DamagedHeader {
                line: 1,
                reason: reason.to_owned(),
                sound_rows: true,
            };
            Err(damaged.into())
        };
        let phase_s = header.sample_phase_s;
        if !(phase_s >= 0.0 && phase_s.is_finite()) {
            return fault("sample_phase_s is no time after an edge");
        }
        let (delay_s, uncertainty_s) = (header.sensor_delay_s, header.sensor_delay_uncertainty_s);
        let possible = 0.0..=1e-3 * LONGEST_DELAY_MS;
        if !possible.contains(&delay_s) || !possible.contains(&uncertainty_s) {
            return fault("sensor_delay_s and its uncertainty are no delays of a sensor");
        }
        let before_edge = (delay_s - phase_s).max(0.0);
        let samples = (before_edge / header.sample_period_s).ceil();
        Ok(Self {
            delay_s,
            uncertainty_s,
            samples: samples as usize,
            phase_s: (phase_s - delay_s + samples * header.sample_period_s).max(0.0),
        })
    }

    /// The output that belongs to the first `length` inputs.
    pub(super) fn taken_out(self, output: &[f64], length: usize) -> Vec<f64> {
        let later = output.iter().skip(self.samples).copied();
        // Past the end nothing was recorded.
        later
            .chain(std::iter::repeat(f64::NAN))
            .take(length)
            .collect()
    }
}

/// A time for a sentence, without the digits that its arithmetic has added (ms).
pub(crate) fn in_ms(seconds: f64) -> f64 {
    (1e6 * seconds).round() / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;

    fn delay(delay_s: f64) -> SensorDelay {
        let header = Header {
            sample_period_s: 0.002,
            sample_phase_s: 0.000_55,
            sensor_delay_s: delay_s,
            ..Header::default()
        };
        SensorDelay::of(&header).unwrap()
    }

    #[test]
    fn a_delay_is_whole_samples_and_an_earlier_phase() {
        for (delay_s, samples, phase_s) in [
            (0.0, 0, 0.000_55),
            (0.000_3, 0, 0.000_25),
            (0.001_1, 1, 0.001_45),
            (0.004, 2, 0.000_55),
        ] {
            let found = delay(delay_s);
            assert_eq!(found.samples, samples, "{delay_s}");
            assert!(
                (found.phase_s - phase_s).abs() < 1e-12,
                "{delay_s}: {found:?}"
            );
        }
        let output = [1.0, 2.0, 3.0];
        assert_eq!(delay(0.004).taken_out(&output, 1), [3.0]);
        assert!(delay(0.004).taken_out(&output, 2)[1].is_nan());
    }

    #[test]
    fn milliseconds_are_as_they_were_stated() {
        for ms in [1.1, 0.7, 0.15, 4.0, 0.0] {
            assert_eq!(in_ms(1e-3 * ms), ms);
        }
    }

    #[test]
    fn a_header_with_an_impossible_delay_is_damaged() {
        for delay_s in [-0.001, f64::NAN, 1.0] {
            let header = Header {
                sensor_delay_s: delay_s,
                ..Header::default()
            };
            assert!(SensorDelay::of(&header).is_err(), "{delay_s}");
        }
    }
}
