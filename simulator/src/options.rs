//! What is simulated, and how it is written after `sim:` in a port's name.
//!
//! ```text
//!  SERVO[?KEY[=VALUE]&KEY[=VALUE]...]          SERVO is bench, aircraft or linear
//! ```
//!
//! | key                 | value                                             | default | servos          |
//! |---------------------|---------------------------------------------------|---------|-----------------|
//! | `seed`              | whole number: another one, other noise and scatter | 0      | all             |
//! | `realtime`          | none: simulated time follows the clock on the wall | off    | all             |
//! | `noise`             | `full`, `white` or `none`                          | `full` | all             |
//! | `scatter`           | none or `all`, or some of `clock,supply,friction,sensor,rotor`: what differs from seed to seed | off | all, as far as it has the part |
//! | `baud`              | speed of the serial line, or `unlimited`           | 115200 | all             |
//! | `fault`             | `open` or `short`, `@` and seconds: the sensor breaks then | none | all      |
//! | `first-sample-us`   | 0-1999: from a pulse's edge to the first sample    | 500    | all             |
//! | `clock-phase-ms`    | what the servo's own clock adds to its latency     | 0      | all             |
//! | `sensor-gain`       | relative to the calibration                        | 1      | all             |
//! | `supply`            | relative to nominal                                | 1      | bench, aircraft |
//! | `friction`          | relative to nominal                                | 1      | bench, aircraft |
//! | `rotor-phase-deg`   | angle of the propeller at the start                | 0      | aircraft        |
//! | `gain`              | output degrees per commanded degree                | 1      | linear          |
//! | `zeta`              | damping ratio                                      | 0.5    | linear          |
//! | `omega`             | natural frequency (rad/s)                          | 60     | linear          |
//! | `delay-ms`          | delay                                              | 21.5   | linear          |

use crate::conditions::{Conditions, Scatter};
use crate::linear::LinearParameters;
use crate::noise::NoiseKind;
use crate::sensor::{FaultKind, SensorFault};
use servoid_protocol::timing::SAMPLE_US;
use std::str::FromStr;
use std::time::Duration;
use thiserror::Error;

/// Which servo is simulated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ServoKind {
    /// [Free on the bench](crate::bench).
    Bench,
    /// [In the aircraft](crate::aircraft).
    Aircraft,
    /// [Linear](crate::linear), with a known step response.
    Linear(LinearParameters),
}

impl ServoKind {
    /// As it is written after `sim:`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Bench => "bench",
            Self::Aircraft => "aircraft",
            Self::Linear(_) => "linear",
        }
    }
}

/// How fast the serial line is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineSpeed {
    /// A UART: bits per second, ten for each byte.
    Baud(u32),
    /// Bytes arrive as soon as they are sent.
    Unlimited,
}

/// Everything that can be chosen. Equal options give equal bytes.
///
/// ```
/// use servoid_simulator::{ServoKind, SimulationOptions};
/// let options: SimulationOptions = "bench?seed=7&realtime".parse()?;
/// assert_eq!(options.servo, ServoKind::Bench);
/// assert_eq!((options.seed, options.realtime), (7, true));
///
/// let error = "plane".parse::<SimulationOptions>().unwrap_err();
/// assert_eq!(
///     error.to_string(),
///     "there is no simulated servo `plane`: choose bench, aircraft or linear"
/// );
/// # Ok::<(), servoid_simulator::OptionsError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SimulationOptions {
    /// The servo.
    pub servo: ServoKind,
    /// Chooses noise and scatter.
    pub seed: u64,
    /// Whether simulated time follows the clock on the wall.
    pub realtime: bool,
    /// How much noise.
    pub noise: NoiseKind,
    /// The line between rig and host.
    pub line: LineSpeed,
    /// Whether and when the sensor breaks.
    pub fault: Option<SensorFault>,
    /// From a pulse's rising edge to the frame's first sample (µs); less than 2000.
    pub first_sample_us: u16,
    /// The run's conditions.
    pub conditions: Conditions,
    /// What of the conditions is drawn by the seed.
    pub scatter: Scatter,
}

impl SimulationOptions {
    /// `servo` with everything else at its default.
    #[must_use]
    pub fn new(servo: ServoKind) -> Self {
        Self {
            servo,
            seed: 0,
            realtime: false,
            noise: NoiseKind::Full,
            line: LineSpeed::Baud(115_200),
            fault: None,
            first_sample_us: 500,
            conditions: Conditions::default(),
            scatter: Scatter::default(),
        }
    }

    /// Whether every value makes sense.
    pub(crate) fn check(&self) -> Result<(), OptionsError> {
        let require = |holds: bool, key: &'static str, expected: &'static str| {
            if holds {
                Ok(())
            } else {
                Err(OptionsError::OutOfRange { key, expected })
            }
        };
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let c = &self.conditions;
        require(positive(c.supply), "supply", POSITIVE)?;
        require(
            c.friction >= 0.0 && c.friction.is_finite(),
            "friction",
            "a number, 0 or above",
        )?;
        require(positive(c.sensor_gain), "sensor-gain", POSITIVE)?;
        require(c.rotor_phase.is_finite(), "rotor-phase-deg", NUMBER)?;
        require(c.clock_phase <= LONGEST, "clock-phase-ms", MILLISECONDS)?;
        require(
            u32::from(self.first_sample_us) < SAMPLE_US,
            "first-sample-us",
            FIRST_SAMPLE,
        )?;
        // Ten bits a byte; below a byte a second nothing would ever arrive.
        require(!matches!(self.line, LineSpeed::Baud(0..10)), "baud", BAUD)?;
        if let ServoKind::Linear(p) = &self.servo {
            require(p.gain.is_finite(), "gain", NUMBER)?;
            require(positive(p.damping), "zeta", POSITIVE)?;
            require(positive(p.natural_frequency), "omega", POSITIVE)?;
            require(p.delay <= LONGEST, "delay-ms", MILLISECONDS)?;
        }
        Ok(())
    }
}

/// The longest delay that can be asked for: beyond it, times would overflow in the end.
const LONGEST: Duration = Duration::from_secs(1000);
const NUMBER: &str = "a number";
const POSITIVE: &str = "a number above 0";
const WHOLE: &str = "a whole number, 0 or above";
const MILLISECONDS: &str = "milliseconds, from 0 to a million";
const FIRST_SAMPLE: &str = "microseconds, from 0 to 1999";
const BAUD: &str = "bits per second, 10 or more, or unlimited";
const NOISE: &str = "full, white or none";
const SCATTER: &str = "all, or a list of clock, supply, friction, sensor and rotor";
const FAULT: &str = "open or short, @ and seconds, such as open@3.5";

/// The keys, for the message about an unknown one.
const KEYS: &str = "seed, realtime, noise, scatter, baud, fault, first-sample-us, clock-phase-ms, \
    sensor-gain, supply, friction, rotor-phase-deg, gain, zeta, omega and delay-ms";

/// Why options make no sense.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum OptionsError {
    /// No such servo.
    #[error("there is no simulated servo `{0}`: choose bench, aircraft or linear")]
    UnknownServo(String),
    /// No such key.
    #[error("the simulated rig has no option `{0}`: there are {KEYS}")]
    UnknownKey(String),
    /// The key is there twice.
    #[error("the option `{0}` is given twice")]
    Twice(String),
    /// The key means nothing for this servo.
    #[error("the option `{key}` means nothing to the {servo} servo")]
    NotForThisServo {
        /// The key.
        key: String,
        /// The servo.
        servo: &'static str,
    },
    /// The text after the key cannot be read.
    #[error("the option `{key}` must be {expected}, not `{value}`")]
    BadValue {
        /// The key.
        key: String,
        /// What it was given.
        value: String,
        /// What it takes.
        expected: &'static str,
    },
    /// A value beyond what can be simulated.
    #[error("the option `{key}` must be {expected}")]
    OutOfRange {
        /// The key.
        key: &'static str,
        /// What it takes.
        expected: &'static str,
    },
}

impl FromStr for SimulationOptions {
    type Err = OptionsError;

    /// Reads what is written after `sim:`; see the [module](self).
    fn from_str(text: &str) -> Result<Self, OptionsError> {
        let (servo, rest) = text.split_once('?').unwrap_or((text, ""));
        let servo = match servo {
            "bench" => ServoKind::Bench,
            "aircraft" => ServoKind::Aircraft,
            "linear" => ServoKind::Linear(LinearParameters::default()),
            other => return Err(OptionsError::UnknownServo(other.into())),
        };
        let mut options = Self::new(servo);
        let mut seen = Vec::new();
        for part in rest.split('&').filter(|part| !part.is_empty()) {
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
    /// The value through `read`, or the sentence that says what is expected.
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
            ("baud", _) => self.line = setting.read(BAUD, line_speed)?,
            ("fault", _) => self.fault = Some(setting.read(FAULT, fault)?),
            ("first-sample-us", _) => self.first_sample_us = setting.parse(FIRST_SAMPLE)?,
            ("clock-phase-ms", _) => self.conditions.clock_phase = setting.milliseconds()?,
            ("sensor-gain", _) => self.conditions.sensor_gain = setting.parse(POSITIVE)?,
            ("supply", ServoKind::Bench | ServoKind::Aircraft) => {
                self.conditions.supply = setting.parse(POSITIVE)?;
            }
            ("friction", ServoKind::Bench | ServoKind::Aircraft) => {
                self.conditions.friction = setting.parse(POSITIVE)?;
            }
            ("rotor-phase-deg", ServoKind::Aircraft) => {
                self.conditions.rotor_phase = setting.parse::<f64>(NUMBER)?.to_radians();
            }
            ("gain", ServoKind::Linear(p)) => p.gain = setting.parse(NUMBER)?,
            ("zeta", ServoKind::Linear(p)) => p.damping = setting.parse(POSITIVE)?,
            ("omega", ServoKind::Linear(p)) => p.natural_frequency = setting.parse(POSITIVE)?,
            ("delay-ms", ServoKind::Linear(p)) => p.delay = setting.milliseconds()?,
            (
                "supply" | "friction" | "rotor-phase-deg" | "gain" | "zeta" | "omega" | "delay-ms",
                servo,
            ) => {
                return Err(OptionsError::NotForThisServo {
                    key: key.into(),
                    servo: servo.name(),
                });
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

fn line_speed(text: &str) -> Option<LineSpeed> {
    match text {
        "unlimited" => Some(LineSpeed::Unlimited),
        _ => text.parse().ok().map(LineSpeed::Baud),
    }
}

fn fault(text: &str) -> Option<SensorFault> {
    let (kind, from) = text.split_once('@').unwrap_or((text, "0"));
    let kind = match kind {
        "open" => FaultKind::Open,
        "short" => FaultKind::Short,
        _ => return None,
    };
    let from = Duration::try_from_secs_f64(from.parse().ok()?).ok()?;
    Some(SensorFault { kind, from })
}

#[cfg(test)]
mod tests {
    use super::*;

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
            &baud=9600&fault=short@3.5&first-sample-us=700&clock-phase-ms=1.25&sensor-gain=1.01\
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
            fault: Some(SensorFault {
                kind: FaultKind::Short,
                from: Duration::from_millis(3500),
            }),
            first_sample_us: 700,
            conditions: Conditions {
                supply: 0.9,
                friction: 1.2,
                sensor_gain: 1.01,
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
                "the option `zeta` means nothing to the bench servo",
            ),
            (
                "linear?supply=1",
                "the option `supply` means nothing to the linear servo",
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
                "the option `fault` must be open or short, @ and seconds",
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
