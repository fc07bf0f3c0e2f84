//! The Hall angle sensor and the ADC behind its divider.
//!
//! ```text
//!  shaft --> 0.5 .. 4.5 V over 120 deg, 2.5 V at 0 --> divider 5 V : 3.3 V --> 12-bit ADC, summed K times
//! ```
//!
//! The divider makes the ADC's full scale 5 V at the sensor, so one step is 5 V / 4096 or
//! 0.0366 deg. Each conversion rounds to the nearest step and stops at both ends; the board sums
//! [`OVERSAMPLING`] of them.

use servoid_protocol::{Counts, SensorScale};
use std::str::FromStr;
use std::time::Duration;

/// Conversions K summed into one sample, as on the board.
pub const OVERSAMPLING: usize = 4;

/// Largest result of one conversion (12 bits).
const LARGEST_CODE: u16 = (1 << 12) - 1;

/// Counts of a sample at the supply rail.
pub const FULL_SCALE: Counts = Counts(OVERSAMPLING as u16 * LARGEST_CODE);

/// ADC codes per volt at the sensor: 4096 steps over 5 V.
const CODES_PER_VOLT: f64 = 4096.0 / 5.0;
/// Sensor output at 0 degrees (V).
const MIDDLE: f64 = 2.5;
/// Lowest and highest output of a healthy sensor (V).
const LIMITS: (f64, f64) = (0.5, 4.5);
/// Volts per degree.
const VOLTS_PER_DEGREE: f64 = 4.0 / 120.0;

/// From counts to degrees for the nominal sensor: 0 degrees are 8192 counts, one count is
/// 0.00916 deg.
///
/// ```
/// use servoid_protocol::{Counts, Degrees};
/// use servoid_simulator::sensor::SENSOR_SCALE;
/// assert_eq!(SENSOR_SCALE.degrees(Counts(8192)), Degrees(0.0));
/// // 4.5 V of 5 V, at 60 degrees:
/// let counts = Counts((4.0 * 4096.0 * 4.5 / 5.0) as u16);
/// assert!((SENSOR_SCALE.degrees(counts).0 - 60.0).abs() < SENSOR_SCALE.degrees_per_count);
/// ```
pub const SENSOR_SCALE: SensorScale = SensorScale {
    zero_counts: OVERSAMPLING as f64 * CODES_PER_VOLT * MIDDLE,
    degrees_per_count: 1.0 / (OVERSAMPLING as f64 * CODES_PER_VOLT * VOLTS_PER_DEGREE),
};

/// One sample: the sum of its conversions.
pub fn sum(conversions: [u16; OVERSAMPLING]) -> Counts {
    Counts(conversions.iter().sum())
}

/// The noise of one sample (deg).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SampleNoise {
    /// The part that is common to all conversions.
    pub shared: f64,
    /// The independent part of each conversion.
    pub conversions: [f64; OVERSAMPLING],
}

/// A fault of the sensor or its wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultKind {
    /// The signal wire is off: the divider pulls the input to 0 V.
    Open,
    /// The signal wire touches the supply: 5 V.
    Short,
    /// The sensor gives the middle of its range for ever, without noise.
    Frozen,
}

/// A fault, and for how long.
///
/// As text, `open@3.5` is a wire that is off from 3.5 s on, and `short@3.5-6` one that touches the
/// supply from 3.5 s to 6 s.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SensorFault {
    /// The fault.
    pub kind: FaultKind,
    /// Its time since the start of the simulation.
    pub from: Duration,
    /// The time of its repair, if any.
    pub until: Option<Duration>,
}

impl SensorFault {
    fn is_there(&self, at: Duration) -> bool {
        at >= self.from && self.until.is_none_or(|until| at < until)
    }
}

/// A text that names no fault of a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "write open, short or frozen, @ and the second from which on, such as open@3.5, or open@3.5-6 if it is repaired at 6 s"
)]
pub struct SensorFaultError;

impl FromStr for SensorFault {
    type Err = SensorFaultError;

    fn from_str(text: &str) -> Result<Self, SensorFaultError> {
        let seconds = |text: &str| {
            let seconds = text.parse().map_err(|_| SensorFaultError)?;
            Duration::try_from_secs_f64(seconds).map_err(|_| SensorFaultError)
        };
        let (kind, when) = text.split_once('@').unwrap_or((text, "0"));
        let kind = match kind {
            "open" => FaultKind::Open,
            "short" => FaultKind::Short,
            "frozen" => FaultKind::Frozen,
            _ => return Err(SensorFaultError),
        };
        let (from, until) = match when.split_once('-') {
            Some((from, until)) => (seconds(from)?, Some(seconds(until)?)),
            None => (seconds(when)?, None),
        };
        if until.is_some_and(|until| until <= from) {
            return Err(SensorFaultError);
        }
        Ok(Self { kind, from, until })
    }
}

/// A sensor, its divider and the ADC.
#[derive(Clone, Debug)]
pub struct HallSensor {
    gain: f64,
    zero: f64,
    faults: Vec<SensorFault>,
}

impl HallSensor {
    /// A sensor with `gain` relative to [`SENSOR_SCALE`] and its zero at `zero` (deg), with these `faults`.
    pub fn new(gain: f64, zero: f64, faults: Vec<SensorFault>) -> Self {
        Self { gain, zero, faults }
    }

    /// The conversions of one sample of `angle` (deg) at `at`.
    pub fn convert(&self, at: Duration, angle: f64, noise: &SampleNoise) -> [u16; OVERSAMPLING] {
        let volts = self.volts(at, angle + noise.shared);
        let own_noise = match self.fault(at) {
            Some(FaultKind::Frozen) => 0.0,
            _ => VOLTS_PER_DEGREE,
        };
        noise.conversions.map(|own| code(volts + own * own_noise))
    }

    fn fault(&self, at: Duration) -> Option<FaultKind> {
        let there = self.faults.iter().find(|fault| fault.is_there(at));
        there.map(|fault| fault.kind)
    }

    /// The voltage on the sensor's wire (V).
    fn volts(&self, at: Duration, angle: f64) -> f64 {
        match self.fault(at) {
            Some(FaultKind::Open) => 0.0,
            Some(FaultKind::Short) => 5.0,
            Some(FaultKind::Frozen) => MIDDLE,
            None => (MIDDLE + self.gain * (angle - self.zero) * VOLTS_PER_DEGREE)
                .clamp(LIMITS.0, LIMITS.1),
        }
    }
}

/// One conversion of the voltage at the sensor.
fn code(volts: f64) -> u16 {
    (volts * CODES_PER_VOLT)
        .round()
        .clamp(0.0, f64::from(LARGEST_CODE)) as u16
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::{Noise, NoiseKind};

    const QUIET: SampleNoise = SampleNoise {
        shared: 0.0,
        conversions: [0.0; OVERSAMPLING],
    };

    fn sample(sensor: &HallSensor, angle: f64, noise: &SampleNoise) -> Counts {
        sum(sensor.convert(Duration::from_secs(2), angle, noise))
    }

    fn degrees(counts: Counts) -> f64 {
        SENSOR_SCALE.degrees(counts).0
    }

    #[test]
    fn without_noise_the_error_is_at_most_half_a_step() {
        let sensor = HallSensor::new(1.0, 0.0, Vec::new());
        let step = 5.0 / 4096.0 / (4.0 / 120.0);
        let mut worst = 0f64;
        for k in -59_000..=59_000 {
            let angle = f64::from(k) * 1e-3;
            let error = degrees(sample(&sensor, angle, &QUIET)) - angle;
            worst = worst.max(error.abs());
        }
        // Half a step, and angles 0.001 deg apart come that close to it; 1e-9 for rounding.
        assert!(
            worst < step / 2.0 + 1e-9 && worst > step / 2.0 - 1e-3,
            "{worst}"
        );
    }

    #[test]
    fn the_noise_of_conversions_dithers_the_adc() {
        let sensor = HallSensor::new(1.0, 0.0, Vec::new());
        let mut noise = Noise::new(NoiseKind::White, 5);
        // Half-way between two steps, where a quiet ADC errs most.
        let angle = 0.5 * 5.0 / 4096.0 / (4.0 / 120.0);
        const N: usize = 100_000;
        let errors: Vec<f64> = (0..N)
            .map(|_| degrees(sample(&sensor, angle, &noise.next_sample())) - angle)
            .collect();
        let mean = errors.iter().sum::<f64>() / N as f64;
        let variance = errors.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / N as f64;
        // The sum's rounding adds LSB²/12 per conversion, a quarter of it in the mean of four:
        // Sheppard's correction, whose remainder at noise of 1.09 LSB is e^(-2π²·1.09²) ~ 1e-10.
        let expected = 0.02f64.powi(2) + 0.0366f64.powi(2) / 12.0 / 4.0;
        // sd of the mean: 0.0207/√N = 7e-5; of the variance: √(2/N) = 0.45 %. Four of each.
        assert!(mean.abs() < 2.6e-4, "{mean}");
        assert!(
            (variance / expected - 1.0).abs() < 0.018,
            "{variance} for {expected}"
        );
    }

    #[test]
    fn it_saturates_and_breaks_where_it_should() {
        let sample = |faults: &[&str], angle| {
            let faults = faults.iter().map(|text| text.parse().unwrap()).collect();
            sample(&HallSensor::new(1.0, 0.0, faults), angle, &QUIET)
        };
        assert!((degrees(sample(&[], 90.0)) - 60.0).abs() < 0.02);
        assert!((degrees(sample(&[], -90.0)) + 60.0).abs() < 0.02);
        // Sampled at 2 s.
        assert_eq!(sample(&["open@2"], 0.0), Counts(0));
        assert_eq!(sample(&["short@2"], 0.0), FULL_SCALE);
        assert_eq!(sample(&["open@3"], 0.0), Counts(8192));
        assert_eq!(sample(&["frozen@2"], 20.0), Counts(8192));
        assert_eq!(sample(&["open@1-2"], 0.0), Counts(8192));
        assert_eq!(sample(&["open@1-2", "short@2-3"], 0.0), FULL_SCALE);
        assert!(FULL_SCALE <= Counts::MAX_TWO_BYTES);
    }

    #[test]
    fn texts_that_name_no_fault() {
        for text in [
            "", "melt@1", "open@", "open@-1", "open@2-", "open@3-2", "open@inf",
        ] {
            assert_eq!(text.parse::<SensorFault>(), Err(SensorFaultError), "{text}");
        }
    }
}
