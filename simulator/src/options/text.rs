//! The text of options after `sim:`; the table is in [`SimulationOptions`]'s text.

use super::{
    BAUD, FIRST_SAMPLE, LineSpeed, MILLISECONDS, NOT_NEGATIVE, NUMBER, OptionsError, POSITIVE,
    STOPS, ServoKind, SimulationOptions,
};
use crate::linear::LinearParameters;
use crate::noise::NoiseKind;
use crate::run_to_run::Scatter;
use servoid_protocol::pulse_train::PulseType;
use std::str::FromStr;
use std::time::Duration;

const WHOLE: &str = "a whole number, 0 or above";
const NOISE: &str = "full, white or none";
const SCATTER: &str = "all, or a list of clock, supply, friction, sensor and rotor";
const FAULT: &str = "open, short or frozen, @ and seconds, such as open@3.5, or open@3.5-6 if it is repaired, with a comma between several";

impl FromStr for SimulationOptions {
    type Err = OptionsError;

    /// Reads the text after `sim:`; see [`SimulationOptions`].
    fn from_str(text: &str) -> Result<Self, OptionsError> {
        let (servo, rest) = text.split_once('?').unwrap_or((text, ""));
        let servo = match servo {
            "bench" => ServoKind::Bench,
            "aircraft" => ServoKind::Aircraft,
            "linear" => ServoKind::Linear(LinearParameters::default()),
            other => return Err(OptionsError::UnknownServo(other.into())),
        };
        Self::with_keys(servo, rest)
    }
}

impl SimulationOptions {
    /// The options of `servo` with what the text after `?` sets.
    ///
    /// # Errors
    /// As the text after `sim:`.
    pub fn with_keys(servo: ServoKind, keys: &str) -> Result<Self, OptionsError> {
        let mut options = Self::new(servo);
        let mut seen = Vec::new();
        for part in keys.split('&').filter(|part| !part.is_empty()) {
            let (key, value) = match part.split_once('=') {
                Some((key, value)) => (key, Some(value)),
                None => (part, None),
            };
            if seen.contains(&key) {
                return Err(OptionsError::Twice(key.into()));
            }
            seen.push(key);
            options.set(&Setting { key, value })?;
        }
        options.check()?;
        Ok(options)
    }
}

/// One `key=value`.
struct Setting<'a> {
    key: &'a str,
    value: Option<&'a str>,
}

impl Setting<'_> {
    /// The value by `read`, or an error with the `expected` values.
    fn read<T>(
        &self,
        expected: &'static str,
        read: impl FnOnce(&str) -> Option<T>,
    ) -> Result<T, OptionsError> {
        let value = self.value.unwrap_or_default();
        read(value).ok_or_else(|| OptionsError::BadValue {
            key: self.key.into(),
            value: value.into(),
            expected,
        })
    }

    fn parse<T: FromStr>(&self, expected: &'static str) -> Result<T, OptionsError> {
        self.read(expected, |value| value.parse().ok())
    }

    fn milliseconds(&self) -> Result<Duration, OptionsError> {
        self.read(MILLISECONDS, |value| {
            Duration::try_from_secs_f64(value.parse::<f64>().ok()? / 1e3).ok()
        })
    }
}

impl SimulationOptions {
    fn set(&mut self, setting: &Setting<'_>) -> Result<(), OptionsError> {
        let key = setting.key;
        match (key, &mut self.servo) {
            ("seed", _) => self.seed = setting.parse(WHOLE)?,
            ("realtime", _) => {
                self.realtime = setting.value.is_none() || setting.parse("true or false")?;
            }
            ("noise", _) => self.noise = setting.read(NOISE, noise)?,
            ("scatter", _) => {
                self.scatter = match setting.value {
                    None => Scatter::ALL,
                    Some(_) => setting.read(SCATTER, scatter)?,
                };
            }
            ("baud", _) if setting.value == Some("unlimited") => self.line = LineSpeed::Unlimited,
            ("baud", _) => self.line = LineSpeed::Baud(setting.parse(BAUD)?),
            ("fault", _) => {
                let faults = |text: &str| text.split(',').map(|fault| fault.parse().ok()).collect();
                self.faults = setting.read(FAULT, faults)?;
            }
            ("first-sample-us", _) => self.first_sample_us = setting.parse(FIRST_SAMPLE)?,
            ("pulses", _) => {
                self.pulses = setting.read("wide or narrow", pulse_type)?;
            }
            ("clock-phase-ms", _) => self.conditions.clock_phase = setting.milliseconds()?,
            ("sensor-gain", _) => self.conditions.sensor_gain = setting.parse(POSITIVE)?,
            ("sensor-zero-deg", _) => self.conditions.sensor_zero = setting.parse(NUMBER)?,
            ("stops-deg", ServoKind::Bench | ServoKind::Aircraft) => {
                self.conditions.stops = Some(setting.read(STOPS, stops)?);
            }
            ("play-deg", ServoKind::Bench | ServoKind::Aircraft) => {
                self.conditions.play = Some(setting.parse(NOT_NEGATIVE)?);
            }
            ("supply", ServoKind::Bench | ServoKind::Aircraft) => {
                self.conditions.supply = setting.parse(POSITIVE)?;
            }
            ("friction", ServoKind::Bench | ServoKind::Aircraft) => {
                self.conditions.friction = setting.parse(NOT_NEGATIVE)?;
            }
            ("rotor-phase-deg", ServoKind::Aircraft) => {
                self.conditions.rotor_phase = setting.parse::<f64>(NUMBER)?.to_radians();
            }
            ("gain", ServoKind::Linear(p)) => p.gain = setting.parse(NUMBER)?,
            ("zeta", ServoKind::Linear(p)) => p.damping = setting.parse(POSITIVE)?,
            ("omega", ServoKind::Linear(p)) => p.natural_frequency = setting.parse(POSITIVE)?,
            ("delay-ms", ServoKind::Linear(p)) => p.delay = setting.milliseconds()?,
            (
                "stops-deg" | "play-deg" | "supply" | "friction" | "rotor-phase-deg" | "gain"
                | "zeta" | "omega" | "delay-ms",
                servo,
            ) => {
                return Err(OptionsError::NotForThisServo(key.into(), servo.name()));
            }
            _ => return Err(OptionsError::UnknownKey(key.into())),
        }
        Ok(())
    }
}

fn noise(text: &str) -> Option<NoiseKind> {
    match text {
        "full" => Some(NoiseKind::Full),
        "white" => Some(NoiseKind::White),
        "none" => Some(NoiseKind::None),
        _ => None,
    }
}

fn pulse_type(text: &str) -> Option<PulseType> {
    match text {
        "wide" => Some(PulseType::Wide),
        "narrow" => Some(PulseType::Narrow),
        _ => None,
    }
}

fn scatter(text: &str) -> Option<Scatter> {
    let mut scatter = Scatter::default();
    for part in text.split(',') {
        match part {
            "all" => scatter = Scatter::ALL,
            "clock" => scatter.clock = true,
            "supply" => scatter.supply = true,
            "friction" => scatter.friction = true,
            "sensor" => scatter.sensor = true,
            "rotor" => scatter.rotor = true,
            _ => return None,
        }
    }
    Some(scatter)
}

fn stops(text: &str) -> Option<(f64, f64)> {
    let (low, high) = text.split_once(':')?;
    Some((low.parse().ok()?, high.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run_to_run::Conditions;

    fn parse(text: &str) -> Result<SimulationOptions, OptionsError> {
        text.parse()
    }

    #[test]
    fn every_key_sets_its_own_field() {
        let bench = SimulationOptions::new(ServoKind::Bench);
        let aircraft = SimulationOptions::new(ServoKind::Aircraft);
        assert_eq!(parse("bench"), Ok(bench.clone()));
        assert_eq!(parse("bench?"), Ok(bench));
        let all = "aircraft?seed=18446744073709551615&realtime&noise=white&scatter=clock,rotor\
            &baud=9600&fault=short@3.5,open@4-4.5&first-sample-us=700&pulses=narrow&clock-phase-ms=1.25&sensor-gain=1.01\
            &sensor-zero-deg=-0.5&stops-deg=-30:25&play-deg=0.6\
            &supply=0.9&friction=1.2&rotor-phase-deg=180";
        let expected = SimulationOptions {
            seed: u64::MAX,
            realtime: true,
            noise: NoiseKind::White,
            scatter: Scatter {
                clock: true,
                rotor: true,
                ..Scatter::default()
            },
            line: LineSpeed::Baud(9600),
            faults: vec!["short@3.5".parse().unwrap(), "open@4-4.5".parse().unwrap()],
            first_sample_us: 700,
            pulses: PulseType::Narrow,
            conditions: Conditions {
                supply: 0.9,
                friction: 1.2,
                sensor_gain: 1.01,
                sensor_zero: -0.5,
                stops: Some((-30.0, 25.0)),
                play: Some(0.6),
                clock_phase: Duration::from_micros(1250),
                rotor_phase: std::f64::consts::PI,
            },
            ..aircraft
        };
        assert_eq!(parse(all), Ok(expected));
        let linear = LinearParameters {
            gain: -2.0,
            damping: 0.7,
            natural_frequency: 30.0,
            delay: Duration::from_nanos(25_500_001),
        };
        let text = "linear?gain=-2&zeta=0.7&omega=30&delay-ms=25.500001&baud=unlimited&scatter";
        let expected = SimulationOptions {
            line: LineSpeed::Unlimited,
            scatter: Scatter::ALL,
            ..SimulationOptions::new(ServoKind::Linear(linear))
        };
        assert_eq!(parse(text), Ok(expected));
    }

    #[test]
    fn each_mistake_has_its_sentence() {
        for (text, sentence) in [
            (
                "",
                "there is no simulated servo ``: choose bench, aircraft or linear",
            ),
            (
                "bench?sed=1",
                "the simulated rig has no option `sed`: there are seed, realtime,",
            ),
            ("bench?seed=1&seed=2", "the option `seed` is given twice"),
            (
                "bench?zeta=1",
                "the option `zeta` does not apply to the bench servo",
            ),
            (
                "linear?supply=1",
                "the option `supply` does not apply to the linear servo",
            ),
            (
                "bench?seed=-1",
                "the option `seed` must be a whole number, 0 or above, not `-1`",
            ),
            (
                "bench?seed",
                "the option `seed` must be a whole number, 0 or above, not ``",
            ),
            (
                "bench?noise=loud",
                "the option `noise` must be full, white or none, not `loud`",
            ),
            (
                "bench?scatter=wind",
                "the option `scatter` must be all, or a list of clock",
            ),
            (
                "bench?fault=open@-1",
                "the option `fault` must be open, short or frozen, @ and seconds",
            ),
            (
                "bench?supply=0",
                "the option `supply` must be a number above 0",
            ),
            (
                "bench?sensor-gain=NaN",
                "the option `sensor-gain` must be a number above 0",
            ),
            (
                "linear?omega=inf",
                "the option `omega` must be a number above 0",
            ),
            (
                "linear?delay-ms=-1",
                "the option `delay-ms` must be milliseconds",
            ),
            (
                "linear?delay-ms=2e6",
                "the option `delay-ms` must be milliseconds",
            ),
            (
                "bench?first-sample-us=2000",
                "the option `first-sample-us` must be microseconds",
            ),
            (
                "bench?baud=9",
                "the option `baud` must be bits per second, 10 or more",
            ),
        ] {
            let error = parse(text).expect_err(text).to_string();
            assert!(error.starts_with(sentence), "{text}: {error}");
        }
    }
}
