//! The rig file: servo, sensor and limits, as the user knows them.
//!
//! ```toml
//! name = "bench 1"
//! port = "/dev/ttyUSB0"
//! condition = "bench"         # noted in captures unless another is given
//!
//! [servo]
//! name = "ALIGN DS610"
//! neutral_us = 1500
//! us_per_degree = 10.0        # negative when a longer pulse turns it the other way
//! pulse_rate_hz = 50          # 50 to 333, or to 560 with narrow pulses
//! pulse_type = "wide"         # "narrow": neutral at about 760 µs
//!
//! [sensor]
//! name = "Honeywell RTY120"
//! zero_counts = 8192.0        # reading at 0 degrees
//! degrees_per_count = 0.0091552734375   # negative when it is mounted the other way round
//! zero_sd_deg = 0.1           # how well the zero is known (standard deviation)
//! scale_sd_percent = 0.5      # how well the scale is known (standard deviation)
//! healthy_counts = [1000, 15380]
//! delay_ms = 4.0              # by which the reading lags behind the shaft
//! delay_uncertainty_ms = 2.0  # the true delay is at most this far from it
//!
//! [limits]
//! shortest_us = 1400          # the board will not leave these, whatever it is asked for
//! longest_us = 1600
//! ```
//!
//! Everything may be left out: [`RigFile::default`] has the values that are used then.

use serde::{Deserialize, Serialize};
use servoid_protocol::pulse_train::PulseType;
use servoid_protocol::{PulseTrain, PulseWidth, Reference, SensorScale, ServoScale};
use std::path::{Path, PathBuf};

/// A rig, as its user knows it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RigFile {
    /// Name of this rig.
    pub name: String,
    /// The port to use when none is named on the command line.
    pub port: Option<String>,
    /// The condition that captures note when none is named on the command line.
    pub condition: Option<String>,
    /// The servo.
    pub servo: ServoSection,
    /// The angle sensor.
    pub sensor: SensorSection,
    /// Travel limits.
    pub limits: LimitsSection,
}

/// The rate that every servo takes (Hz).
pub const USUAL_RATE_HZ: f64 = 50.0;

/// `[servo]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ServoSection {
    /// Name of the servo.
    pub name: String,
    /// The pulse that commands 0 degrees (µs).
    pub neutral_us: u16,
    /// Change of the pulse for one degree (µs/deg).
    pub us_per_degree: f64,
    /// Pulses in a second (Hz).
    #[serde(skip_serializing_if = "is_usual_rate")]
    pub pulse_rate_hz: f64,
    /// The pulses that it understands.
    #[serde(skip_serializing_if = "PulseTypeName::is_wide")]
    pub pulse_type: PulseTypeName,
}

/// A [`PulseType`] as it is written in files and options.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PulseTypeName {
    /// Neutral at about 1500 or 1520 µs.
    #[default]
    Wide,
    /// Neutral at about 760 µs.
    Narrow,
}

impl PulseTypeName {
    /// What to answer instead of another word.
    pub const CHOICES: &'static str = "choose wide or narrow";

    /// Whether it is that of nearly all servos, which files need not state.
    pub fn is_wide(&self) -> bool {
        *self == Self::Wide
    }

    /// As it is written.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Wide => "wide",
            Self::Narrow => "narrow",
        }
    }
}

impl std::fmt::Display for PulseTypeName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.as_str())
    }
}

impl std::str::FromStr for PulseTypeName {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let all = [Self::Wide, Self::Narrow];
        let named = all.into_iter().find(|name| name.as_str() == text);
        named.ok_or(Self::CHOICES)
    }
}

impl From<PulseTypeName> for PulseType {
    fn from(name: PulseTypeName) -> Self {
        match name {
            PulseTypeName::Wide => Self::Wide,
            PulseTypeName::Narrow => Self::Narrow,
        }
    }
}

fn is_usual_rate(hz: &f64) -> bool {
    *hz == USUAL_RATE_HZ
}

impl Default for ServoSection {
    /// 1500 µs and 10 µs per degree: 100 degrees of travel on 1-2 ms, as the paper's servo.
    fn default() -> Self {
        Self {
            name: String::new(),
            neutral_us: PulseWidth::NEUTRAL.0,
            us_per_degree: 10.0,
            pulse_rate_hz: USUAL_RATE_HZ,
            pulse_type: PulseTypeName::Wide,
        }
    }
}

/// `[sensor]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SensorSection {
    /// Name of the sensor.
    pub name: String,
    /// Reading at 0 degrees (counts).
    pub zero_counts: f64,
    /// Degrees for one count.
    pub degrees_per_count: f64,
    /// Standard deviation of the zero (deg).
    pub zero_sd_deg: f64,
    /// Standard deviation of the scale (percent of it).
    pub scale_sd_percent: f64,
    /// Smallest and largest reading of a healthy sensor (counts).
    pub healthy_counts: [u16; 2],
    /// Time by which the reading lags behind the shaft (ms).
    pub delay_ms: f64,
    /// The true delay is at most this far from it (ms).
    pub delay_uncertainty_ms: f64,
}

/// Volts of the sensor at the ends of its range, and the range (deg): Honeywell RTY, 120 degrees, 0.5 to
/// 4.5 V on a 5 V supply (paper §4).
pub const RTY_VOLTS: [f64; 2] = [0.5, 4.5];
/// The range that goes with [`RTY_VOLTS`].
pub const RTY_DEGREES: f64 = 120.0;
/// Volts at the sensor that the divider brings to the ADC's full scale, its 3.3 V reference (paper §4).
pub const FULL_SCALE_VOLTS: f64 = 5.0;
/// Standard deviations of zero and scale before a calibration; see [`SensorSection::from_data_sheet`].
pub(crate) const UNCALIBRATED_ZERO_SD_DEG: f64 = 4.0;
pub(crate) const UNCALIBRATED_SCALE_SD_PERCENT: f64 = 5.0;
/// A sensor that lags by more shows no servo (ms).
pub(crate) const LONGEST_DELAY_MS: f64 = 100.0;
/// Four conversions of 12 bits, summed: 4096 steps each, of which the last reads 4095.
const FULL_SCALE_COUNTS: f64 = 4.0 * 4096.0;

impl Default for SensorSection {
    /// The paper's sensor behind the divider of the wiring guide.
    fn default() -> Self {
        Self::from_data_sheet(RTY_VOLTS, RTY_DEGREES, FULL_SCALE_VOLTS)
    }
}

impl SensorSection {
    /// A linear sensor whose `full_scale_volts` are the converter's full scale, as 5 V are behind the divider of the wiring guide, with `volts` at the low and the high end of
    /// a range of `degrees`, negative where the volts fall as the angle grows; 0 degrees are in its
    /// middle.
    ///
    /// Nothing is measured on this rig yet. The sensor's output is proportional to its supply, and USB may have 4.75 to
    /// 5.25 V: 5 % of the scale, and with it 3.75 degrees of the paper's sensor at its middle, to which the mounting of
    /// the sensor comes. No delay is known.
    pub fn from_data_sheet(volts: [f64; 2], degrees: f64, full_scale_volts: f64) -> Self {
        let counts_per_volt = FULL_SCALE_COUNTS / full_scale_volts;
        let [low, high] = volts.map(|volts| volts * counts_per_volt);
        Self {
            name: String::new(),
            zero_counts: (low + high) / 2.0,
            degrees_per_count: degrees / (high - low),
            zero_sd_deg: UNCALIBRATED_ZERO_SD_DEG,
            scale_sd_percent: UNCALIBRATED_SCALE_SD_PERCENT,
            // Half way from the range's ends to the rails, where an open or shorted wire reads.
            healthy_counts: [
                (low / 2.0) as u16,
                ((high + FULL_SCALE_COUNTS) / 2.0) as u16,
            ],
            delay_ms: 0.0,
            delay_uncertainty_ms: 0.0,
        }
    }
}

/// `[limits]`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LimitsSection {
    /// The shortest pulse that this servo may be given (µs).
    pub shortest_us: u16,
    /// The longest pulse that this servo may be given (µs).
    pub longest_us: u16,
}

impl Default for LimitsSection {
    /// The full range of an R/C servo, 1-2 ms (paper §4).
    fn default() -> Self {
        Self {
            shortest_us: 1000,
            longest_us: 2000,
        }
    }
}

/// Why a rig file cannot be used. The text names the remedy.
#[derive(Debug, thiserror::Error)]
pub enum RigFileError {
    /// The error of the system.
    #[error("the rig file {0:?} cannot be read: {1}")]
    Unreadable(PathBuf, std::io::Error),
    /// The file is no rig file: what is wrong, and where.
    #[error("the rig file {0:?} does not make sense: {1}")]
    Malformed(PathBuf, String),
}

/// A reference that the rig must not follow.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "the reference is refused: it goes from {lowest} to {highest} µs, beyond the rig's limits of {shortest} to {longest} µs; {}, or widen the limits in the rig file if the linkage allows it",
    remedy(*.largest_deg)
)]
pub struct BeyondLimits {
    lowest: i32,
    highest: i32,
    shortest: u16,
    longest: u16,
    largest_deg: f64,
}

/// What fits: `largest_deg` to both sides of neutral.
fn remedy(largest_deg: f64) -> String {
    match largest_deg > 0.0 {
        true => format!(
            "the largest reference about neutral that fits has --amplitude {largest_deg}; the positions of a table must lie within that, too"
        ),
        false => "neutral is at a limit, so that no reference about it fits".to_owned(),
    }
}

impl RigFile {
    /// Refuses a reference beyond the limits.
    ///
    /// # Errors
    /// It goes beyond them.
    pub fn require_within_limits(&self, reference: &Reference) -> Result<(), BeyondLimits> {
        let (low, high) = reference.extremes_us();
        let neutral = i32::from(self.servo.neutral_us);
        let [lowest, highest] = [low, high].map(|offset| neutral + i32::from(offset));
        let [shortest, longest] = [self.limits.shortest_us, self.limits.longest_us];
        match lowest < i32::from(shortest) || highest > i32::from(longest) {
            true => Err(BeyondLimits {
                lowest,
                highest,
                shortest,
                longest,
                largest_deg: self.largest_amplitude_deg(),
            }),
            false => Ok(()),
        }
    }

    /// The largest amplitude to both sides of neutral within the limits (deg), in whole tenths; 0 where neutral is at a limit.
    #[must_use]
    pub fn largest_amplitude_deg(&self) -> f64 {
        let neutral = self.servo.neutral_us;
        let below = neutral.saturating_sub(self.limits.shortest_us);
        let above = self.limits.longest_us.saturating_sub(neutral);
        let degrees = f64::from(below.min(above)) / self.servo.us_per_degree.abs();
        (10.0 * degrees + 1e-9).floor() / 10.0
    }

    /// Reads and checks a rig file; the error names the key that is wrong.
    pub fn read(path: &Path) -> Result<Self, RigFileError> {
        Self::parse(&Self::text(path)?, path)
    }

    /// The text of a rig file.
    pub fn text(path: &Path) -> Result<String, RigFileError> {
        std::fs::read_to_string(path)
            .map_err(|reason| RigFileError::Unreadable(path.to_owned(), reason))
    }

    /// Reads and checks the text of a rig file; `path` is what error texts call it.
    pub fn parse(text: &str, path: &Path) -> Result<Self, RigFileError> {
        let file: Result<Self, String> = toml::from_str(text).map_err(|e| in_one_line(text, &e));
        let checked = file.and_then(|file| file.check().map(|()| file));
        checked.map_err(|reason| RigFileError::Malformed(path.to_owned(), reason))
    }

    fn check(&self) -> Result<(), String> {
        self.check_numbers()?;
        let ServoSection {
            pulse_rate_hz,
            pulse_type,
            ..
        } = self.servo;
        let pulses = PulseType::from(pulse_type);
        let [shortest, longest] = pulses.board_limits().map(|pulse| pulse.0);
        let name = pulse_type.as_str();
        if PulseTrain::at_rate(pulses, pulse_rate_hz).is_none() {
            return Err(format!(
                "servo.pulse_rate_hz must be 50 to {} Hz where servo.pulse_type is \"{name}\"",
                pulses.highest_hz()
            ));
        }
        let limits = [self.limits.shortest_us, self.limits.longest_us];
        if limits.iter().any(|us| !(shortest..=longest).contains(us)) {
            return Err(format!(
                "limits.shortest_us and limits.longest_us must be within {shortest} to {longest} µs, which the board keeps where servo.pulse_type is \"{name}\""
            ));
        }
        Ok(())
    }

    fn check_numbers(&self) -> Result<(), &'static str> {
        let spread = |sd: f64| sd.is_finite() && sd >= 0.0;
        let (servo, sensor, limits) = (&self.servo, &self.sensor, &self.limits);
        if !is_usable_scale(servo.us_per_degree) {
            return Err("servo.us_per_degree must be a number other than 0, at most a million");
        }
        if !is_usable_scale(sensor.degrees_per_count) {
            return Err("sensor.degrees_per_count must be a number other than 0");
        }
        if !(0.0..=f64::from(u16::MAX)).contains(&sensor.zero_counts) {
            return Err("sensor.zero_counts must be a reading of the sensor, 0 to 65535");
        }
        if !spread(sensor.zero_sd_deg) || !spread(sensor.scale_sd_percent) {
            return Err("sensor.zero_sd_deg and sensor.scale_sd_percent must be 0 or more");
        }
        let delays = [sensor.delay_ms, sensor.delay_uncertainty_ms];
        if !delays
            .iter()
            .all(|ms| (0.0..=LONGEST_DELAY_MS).contains(ms))
        {
            return Err(
                "sensor.delay_ms and sensor.delay_uncertainty_ms must be milliseconds, 0 to 100",
            );
        }
        if sensor.healthy_counts[0] >= sensor.healthy_counts[1] {
            return Err("sensor.healthy_counts must be [smallest, largest]");
        }
        if limits.shortest_us >= limits.longest_us
            || !(limits.shortest_us..=limits.longest_us).contains(&servo.neutral_us)
        {
            return Err(
                "limits.shortest_us, servo.neutral_us and limits.longest_us must be in this order",
            );
        }
        Ok(())
    }

    /// The pulses that the servo takes.
    pub fn train(&self) -> PulseTrain {
        // A rate that no servo takes is refused where the file is read.
        PulseTrain::at_rate(self.servo.pulse_type.into(), self.servo.pulse_rate_hz)
            .unwrap_or_default()
    }

    /// How pulses become degrees.
    pub fn servo_scale(&self) -> ServoScale {
        ServoScale {
            neutral: PulseWidth(self.servo.neutral_us),
            us_per_degree: self.servo.us_per_degree,
        }
    }

    /// How counts become degrees.
    pub fn sensor_scale(&self) -> SensorScale {
        SensorScale {
            zero_counts: self.sensor.zero_counts,
            degrees_per_count: self.sensor.degrees_per_count,
        }
    }
}

/// What is wrong, and in which line, without the parser's drawing of it.
fn in_one_line(text: &str, error: &toml::de::Error) -> String {
    let what = error.message().lines().next().unwrap_or_default();
    let Some(before) = error.span().and_then(|span| text.get(..span.start)) else {
        return what.to_owned();
    };
    let number = before.matches('\n').count();
    let line = text.lines().nth(number).unwrap_or_default().trim();
    format!("line {} ({line:?}): {what}", number + 1)
}

/// Whether a number can be a scale, of a servo or of a sensor: not 0, and of a size that is met.
pub(crate) fn is_usable_scale(scale: f64) -> bool {
    (1e-6..1e6).contains(&scale.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_protocol::{Counts, Degrees};

    fn read(text: &str) -> Result<RigFile, RigFileError> {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("rig.toml");
        std::fs::write(&path, text).unwrap();
        RigFile::read(&path)
    }

    #[test]
    fn an_empty_file_is_the_papers_rig() {
        let rig = read("").unwrap();
        assert_eq!(rig, RigFile::default());
        assert_eq!(
            rig.servo_scale().pulse(Degrees(5.0)),
            Some(PulseWidth(1550))
        );
        // 0.5 V of 5 V at -60 degrees: the data sheet's lower end.
        let low = Counts((0.5 / 5.0 * 4.0 * 4096.0) as u16);
        // Whole counts: to within one of them.
        let one_count = rig.sensor.degrees_per_count;
        assert!((rig.sensor_scale().degrees(low).0 + 60.0).abs() < one_count);
    }

    #[test]
    fn each_mistake_is_named() {
        for (text, word) in [
            ("[servo]\nus_per_degree = 0", "us_per_degree"),
            ("[servo]\nus_per_degree = nan", "us_per_degree"),
            ("[servo]\nneutral_us = 2500", "neutral_us"),
            ("[sensor]\nhealthy_counts = [9, 3]", "healthy_counts"),
            ("[sensor]\nzero_counts = 1e308", "zero_counts"),
            ("[sensor]\nzero_counts = -1", "zero_counts"),
            ("[sensor]\nzero_sd_deg = -1", "zero_sd_deg"),
            ("[sensor]\ndelay_ms = -1", "delay_ms"),
            (
                "[sensor]\ndelay_uncertainty_ms = nan",
                "delay_uncertainty_ms",
            ),
            ("[servo]\nneutral = 1500", "neutral"),
            ("[limits]\nshortest_us = 99999", "shortest_us"),
            ("servo = 3", "servo"),
            ("[servo]\npulse_rate_hz = 400", "50 to 333 Hz"),
            ("[servo]\npulse_rate_hz = nan", "pulse_rate_hz"),
            ("[servo]\npulse_type = \"thin\"", "narrow"),
            ("[servo]\npulse_type = \"narrow\"", "400 to 1100 µs"),
            ("[limits]\nshortest_us = 700", "800 to 2200 µs"),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(word), "{text:?}: {error}");
        }
    }
}
