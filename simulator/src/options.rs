//! The options of a simulation.

mod text;

use crate::identified_servo::MachineParameters;
use crate::linear::LinearParameters;
use crate::noise::NoiseKind;
use crate::run_to_run::{Conditions, Scatter};
use crate::sensor::SensorFault;
use servoid_protocol::PulseTrain;
use servoid_protocol::pulse_train::PulseType;
use servoid_protocol::timing::SAMPLE_US;
use std::time::Duration;
use thiserror::Error;

/// Which servo is simulated.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "a program has one or two of them"
)]
pub enum ServoKind {
    /// Free on the bench.
    Bench,
    /// In the aircraft: loaded, with a lower supply.
    Aircraft,
    /// [Linear](crate::linear), with a known step response.
    Linear(LinearParameters),
    /// Of parameters that were identified. It has no name after `sim:`.
    Machine(MachineParameters),
}

impl ServoKind {
    /// Its name.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Bench => "bench",
            Self::Aircraft => "aircraft",
            Self::Linear(_) => "linear",
            Self::Machine(_) => "model",
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

/// All options. Equal options give equal bytes.
///
/// As text, after `sim:` in a port's name:
///
/// ```text
///  SERVO[?KEY[=VALUE]&KEY[=VALUE]...]          SERVO is bench, aircraft or linear
/// ```
///
/// | key                 | value                                             | default | servos          |
/// |---------------------|---------------------------------------------------|---------|-----------------|
/// | `seed`              | whole number; chooses noise and scatter            | 0      | all             |
/// | `realtime`          | none: simulated time follows the clock on the wall | off    | all             |
/// | `noise`             | `full`, `white` or `none`                          | `full` | all             |
/// | `scatter`           | none or `all`, or some of `clock,supply,friction,sensor,rotor`: the parts that differ from seed to seed | off | all, as far as it has the part |
/// | `baud`              | speed of the serial line, or `unlimited`           | 115200 | all             |
/// | `fault`             | `open`, `short` or `frozen`, `@` and seconds: the sensor breaks then; `open@3-5`: it is repaired at 5 s; a comma between several | none | all |
/// | `first-sample-us`   | 0-1999: from a pulse's edge to the first sample, with pulses at 50 Hz | 500    | all             |
/// | `pulses`            | `wide` or `narrow`: a narrow-pulse servo takes pulses of half the width | wide | all |
/// | `clock-phase-ms`    | latency that the servo's own clock adds            | 0      | all             |
/// | `sensor-gain`       | relative to the calibration                        | 1      | all             |
/// | `sensor-zero-deg`   | angle at which the sensor reads its counts for 0 deg | 0     | all             |
/// | `stops-deg`         | `LOW:HIGH`, angles below and above 0 at which the shaft meets its stops | none | bench, aircraft |
/// | `play-deg`          | full width of the play between gears and output    | 0.04   | bench, aircraft |
/// | `supply`            | relative to nominal                                | 1      | bench, aircraft |
/// | `friction`          | relative to nominal                                | 1      | bench, aircraft |
/// | `rotor-phase-deg`   | angle of the propeller at the start                | 0      | aircraft        |
/// | `gain`              | output degrees per commanded degree                | 1      | linear          |
/// | `zeta`              | damping ratio                                      | 0.5    | linear          |
/// | `omega`             | natural frequency (rad/s)                          | 60     | linear          |
/// | `delay-ms`          | delay                                              | 21.5   | linear          |
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
    pub faults: Vec<SensorFault>,
    /// From a pulse's rising edge to the frame's first sample (µs); less than 2000.
    pub first_sample_us: u16,
    /// The pulses that the servo understands.
    pub pulses: PulseType,
    /// The run's conditions.
    pub conditions: Conditions,
    /// The conditions that the seed draws.
    pub scatter: Scatter,
}

impl SimulationOptions {
    /// `servo` with everything else at its default.
    pub fn new(servo: ServoKind) -> Self {
        Self {
            servo,
            seed: 0,
            realtime: false,
            noise: NoiseKind::Full,
            line: LineSpeed::Baud(115_200),
            faults: Vec::new(),
            first_sample_us: 500,
            pulses: PulseType::Wide,
            conditions: Conditions::default(),
            scatter: Scatter::default(),
        }
    }

    /// From the edge of a pulse to the first sample after it, with pulses of this train (s).
    #[must_use]
    pub fn sample_phase_s(&self, train: PulseTrain) -> f64 {
        f64::from(first_sample_us(self.first_sample_us, train)) * 1e-6
    }

    /// Checks every value.
    pub(crate) fn check(&self) -> Result<(), OptionsError> {
        let require = |holds: bool, key: &'static str, expected: &'static str| {
            if holds {
                Ok(())
            } else {
                Err(OptionsError::OutOfRange(key, expected))
            }
        };
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let c = &self.conditions;
        require(positive(c.supply), "supply", POSITIVE)?;
        let not_negative = c.friction >= 0.0 && c.friction.is_finite();
        require(not_negative, "friction", NOT_NEGATIVE)?;
        require(positive(c.sensor_gain), "sensor-gain", POSITIVE)?;
        require(c.sensor_zero.is_finite(), "sensor-zero-deg", NUMBER)?;
        let are_stops = |(low, high): (f64, f64)| low < 0.0 && high > 0.0;
        require(c.stops.is_none_or(are_stops), "stops-deg", STOPS)?;
        let play = c.play.unwrap_or(0.0);
        require(play >= 0.0 && play.is_finite(), "play-deg", NOT_NEGATIVE)?;
        require(c.rotor_phase.is_finite(), "rotor-phase-deg", NUMBER)?;
        require(c.clock_phase <= LONGEST, "clock-phase-ms", MILLISECONDS)?;
        let in_time = u32::from(self.first_sample_us) < SAMPLE_US;
        require(in_time, "first-sample-us", FIRST_SAMPLE)?;
        // Ten bits a byte: at least one byte a second.
        require(!matches!(self.line, LineSpeed::Baud(0..10)), "baud", BAUD)?;
        if let ServoKind::Linear(p) = &self.servo {
            require(p.gain.is_finite(), "gain", NUMBER)?;
            require(positive(p.damping), "zeta", POSITIVE)?;
            require(positive(p.natural_frequency), "omega", POSITIVE)?;
            require(p.delay <= LONGEST, "delay-ms", MILLISECONDS)?;
        }
        if let ServoKind::Machine(p) = &self.servo {
            let servo = &p.servo;
            require(positive(servo.stiffness), "stiffness", POSITIVE)?;
            require(positive(servo.damping), "damping", POSITIVE)?;
            let delays = 0.0..=LONGEST.as_secs_f64();
            require(delays.contains(&servo.delay_s), "delay", MILLISECONDS)?;
            let seen = p.rest_deg().abs() <= RANGE_DEG;
            require(seen, "position of rest at neutral", SEEN)?;
        }
        Ok(())
    }
}

/// The longest delay: beyond it, times could overflow.
const LONGEST: Duration = Duration::from_secs(1000);
/// Angles to each side of 0 that the sensor shows.
pub const RANGE_DEG: f64 = 60.0;
const SEEN: &str = "within the 60 degrees to each side of 0 that the sensor shows";
const NUMBER: &str = "a number";
const POSITIVE: &str = "a number above 0";
const NOT_NEGATIVE: &str = "a number, 0 or above";
const MILLISECONDS: &str = "milliseconds, from 0 to a million";
/// From the edge of a pulse to the first sample of its frame, where that is `usual` with the usual train (µs).
pub(crate) fn first_sample_us(usual: u16, train: PulseTrain) -> u16 {
    match train {
        PulseTrain::USUAL => usual,
        _ => train.first_sample_us(),
    }
}

const FIRST_SAMPLE: &str = "microseconds, from 0 to 1999";
const STOPS: &str = "two angles with a colon between them, below and above 0, such as -30:25";
const BAUD: &str = "bits per second, 10 or more, or unlimited";

/// The keys, for the message about an unknown one.
const KEYS: &str = "seed, realtime, noise, scatter, baud, fault, first-sample-us, pulses, clock-phase-ms, \
    sensor-gain, sensor-zero-deg, stops-deg, play-deg, supply, friction, rotor-phase-deg, gain, zeta, omega and delay-ms";

/// An invalid option.
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
    /// The key does not apply to this servo.
    #[error("the option `{0}` does not apply to the {1} servo")]
    NotForThisServo(String, &'static str),
    /// The text after the key cannot be read.
    #[error("the option `{key}` must be {expected}, not `{value}`")]
    BadValue {
        /// The key.
        key: String,
        /// The text.
        value: String,
        /// The values that it takes.
        expected: &'static str,
    },
    /// A value that cannot be simulated.
    #[error("the option `{0}` must be {1}")]
    OutOfRange(&'static str, &'static str),
}
