//! The rig file of a new rig: the answers of its user, their checks, and the text of the file.

mod range;

pub(super) use range::{RANGE_FORM, Range};

use super::rig_args::AIRCRAFT;
use crate::data::rig_file::{
    LONGEST_DELAY_MS, LimitsSection, PulseTypeName, RigFile, RigFileError, SensorSection,
    ServoSection, USUAL_RATE_HZ,
};
use crate::data::sensor_preset::{SensorKind, SensorPreset};
use crate::instrument::port::{is_simulated, simulated_servo, simulates_narrow_pulses};
use crate::presentation::template;
use servoid_protocol::PulseTrain;
use servoid_protocol::pulse_train::PulseType;
use std::path::Path;

/// The answers about a new rig.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RigAnswers {
    /// Name of the rig.
    pub name: String,
    /// Its port; `None` where every command names it.
    pub port: Option<String>,
    /// Condition of its captures.
    pub condition: String,
    /// Name of the servo.
    pub servo: String,
    /// The kind of pulses that it understands.
    pub pulse_type: PulseTypeName,
    /// Pulses in a second (Hz).
    pub pulse_rate_hz: f64,
    /// The pulse at 0 degrees (µs).
    pub neutral_us: u16,
    /// Change of the pulse for one degree (µs/deg), either sign.
    pub us_per_degree: f64,
    /// The shortest and the longest pulse that the servo takes (µs).
    pub pulses_us: Range,
    /// Travel of the linkage from neutral (deg).
    pub travel_deg: Range,
    /// Kind of the sensor.
    pub sensor_kind: SensorKind,
    /// Name of the sensor.
    pub sensor: String,
    /// Output of the sensor at the ends of its range (V).
    pub sensor_volts: Range,
    /// Angle between these outputs (deg); negative where the output falls as the angle grows.
    pub sensor_degrees: f64,
    /// Time by which the reading lags behind the shaft, and how far the true one may be from it (ms).
    pub sensor_delay_ms: [f64; 2],
}

/// Travel of a linkage of unknown travel (deg): twice the default amplitude of a reference, and little enough for
/// most linkages. Servos of helicopters turn 50 degrees, and many linkages jam long before.
const DEFAULT_TRAVEL_DEG: Range = Range {
    low: -10.0,
    high: 10.0,
};

/// Neutral of most narrow-pulse servos (µs).
const NARROW_NEUTRAL_US: u16 = 760;

impl Default for RigAnswers {
    /// The paper's servo and sensor, as in [`RigFile::default`].
    fn default() -> Self {
        let (servo, limits) = (ServoSection::default(), LimitsSection::default());
        let sensor = SensorKind::default().preset();
        let [low, high] = sensor.volts;
        Self {
            name: "my rig".into(),
            port: None,
            condition: "bench".into(),
            servo: String::new(),
            pulse_type: servo.pulse_type,
            pulse_rate_hz: servo.pulse_rate_hz,
            neutral_us: servo.neutral_us,
            us_per_degree: servo.us_per_degree,
            pulses_us: Range {
                low: limits.shortest_us.into(),
                high: limits.longest_us.into(),
            },
            travel_deg: DEFAULT_TRAVEL_DEG,
            sensor_kind: SensorKind::default(),
            sensor: sensor.name.into(),
            sensor_volts: Range { low, high },
            sensor_degrees: sensor.degrees,
            sensor_delay_ms: sensor.delay_ms,
        }
    }
}

/// Whether an answer is acceptable; the error is a sentence for the user.
pub(super) type Checked = Result<(), String>;

/// A name on one line.
pub(super) fn check_name(name: &str) -> Checked {
    require(
        !name.chars().any(char::is_control) && name.chars().count() <= LONGEST_NAME,
        || format!("a name must be one line of at most {LONGEST_NAME} letters"),
    )
}

/// A longer text is more likely a slip of the clipboard than a name (letters).
const LONGEST_NAME: usize = 80;

/// A name that is not empty.
pub(super) fn check_condition(condition: &str) -> Checked {
    check_name(condition)?;
    require(!condition.trim().is_empty(), || {
        "a condition needs a name: bench, aircraft, or your own words".into()
    })?;
    let begins = ["sim:", "tcp:", "/dev/"].map(|port| condition.trim().starts_with(port));
    require(!begins.contains(&true), || {
        "that is a port, and this is the condition of the measurement: bench, aircraft, or your own words".into()
    })
}

/// A rate of pulses of this type.
pub(super) fn check_pulse_rate(hz: f64, pulse_type: PulseTypeName) -> Checked {
    let pulses = PulseType::from(pulse_type);
    require(PulseTrain::at_rate(pulses, hz).is_some(), || {
        let (name, highest) = (pulse_type.as_str(), pulses.highest_hz());
        let otherwise = match pulse_type {
            PulseTypeName::Wide => {
                "; narrow ones (neutral about 760 µs) at up to 560 Hz: --pulse-type narrow"
            }
            PulseTypeName::Narrow => "",
        };
        format!("{name} pulses come at {USUAL_RATE_HZ} to {highest} Hz{otherwise}")
    })
}

/// The shortest and the longest pulse of a servo of this type.
pub(super) fn check_pulses(pulses: &Range, pulse_type: PulseTypeName) -> Checked {
    let board_us = PulseType::from(pulse_type)
        .board_limits()
        .map(|pulse| pulse.0);
    let [shortest, longest] = board_us.map(f64::from);
    let whole = |us: f64| us.fract() == 0.0;
    require(
        shortest <= pulses.low && pulses.high <= longest && whole(pulses.low) && whole(pulses.high),
        || match pulse_type {
            PulseTypeName::Wide => format!(
                "the board makes pulses of {shortest} to {longest} whole microseconds, and shorter ones for a narrow-pulse servo, with --pulse-type narrow"
            ),
            PulseTypeName::Narrow => format!(
                "the board makes narrow pulses of {shortest} to {longest} whole microseconds"
            ),
        },
    )
}

/// The pulse at 0 degrees, for a servo that takes `pulses`.
pub(super) fn check_neutral(neutral_us: u16, pulses: &Range) -> Checked {
    require(pulses.contains(neutral_us.into()), || {
        let narrow = match neutral_us < PulseType::Wide.board_limits()[0].0 {
            true => "; a narrow-pulse servo (neutral about 760 µs) needs --pulse-type narrow",
            false => "",
        };
        format!("neutral must be a pulse that the servo takes, within {pulses} µs{narrow}")
    })
}

/// Change of the pulse for one degree.
pub(super) fn check_us_per_degree(us: &f64) -> Checked {
    require((0.5..=200.0).contains(&us.abs()), || {
        "it must be a number from 0.5 to 200 µs per degree (R/C servos take about 10 µs), negative where a longer pulse turns the servo towards negative angles".into()
    })
}

/// Travel of the linkage.
pub(super) fn check_travel(travel: &Range) -> Checked {
    require(travel.low < 0.0 && travel.high > 0.0, || {
        "the travel must go from below 0 degrees, which is neutral, to above it, such as -20:20"
            .into()
    })
}

/// Volts at the ends of the range of a sensor of this kind.
pub(super) fn check_volts(volts: &Range, preset: &SensorPreset) -> Checked {
    let full_scale = preset.full_scale_volts;
    require(volts.low >= 0.0 && volts.high <= full_scale, || {
        let [low, high] = preset.volts;
        format!(
            "it must be a range within the 0 to {full_scale} V that the converter reads of this sensor, such as {low}:{high}"
        )
    })
}

/// Delay of the sensor, or how far it is known.
pub(super) fn check_delay(ms: &f64) -> Checked {
    require((0.0..=LONGEST_DELAY_MS).contains(ms), || {
        format!("it must be a number of milliseconds from 0 to {LONGEST_DELAY_MS}")
    })
}

/// Angle between the ends of the sensor's range.
pub(super) fn check_sensor_degrees(degrees: &f64) -> Checked {
    require((1.0..=3600.0).contains(&degrees.abs()), || {
        "the sensor's range must be a number of degrees from 1 to 3600, negative where its output falls as the angle grows".into()
    })
}

fn require(holds: bool, sentence: impl FnOnce() -> String) -> Checked {
    if holds { Ok(()) } else { Err(sentence()) }
}

impl RigAnswers {
    /// Takes what is usual for a type of pulses: narrow ones have half the width, and half the change for a degree.
    pub(super) fn take_pulse_type(&mut self, pulse_type: PulseTypeName) {
        self.pulse_type = pulse_type;
        if pulse_type == PulseTypeName::Narrow {
            self.neutral_us = NARROW_NEUTRAL_US;
            self.us_per_degree /= 2.0;
            self.pulses_us = Range {
                low: self.pulses_us.low / 2.0,
                high: self.pulses_us.high / 2.0,
            };
        }
    }

    /// Takes what is known of a kind of sensor. The one of a simulated rig reads the angle at once.
    pub(super) fn take_sensor(&mut self, kind: SensorKind) {
        let preset = kind.preset();
        let [low, high] = preset.volts;
        self.sensor_kind = kind;
        self.sensor = preset.name.into();
        self.sensor_volts = Range { low, high };
        self.sensor_degrees = preset.degrees;
        self.sensor_delay_ms = match self.is_simulated() {
            true => [0.0, 0.0],
            false => preset.delay_ms,
        };
    }

    /// Takes what is known of the rig at this port: a simulated servo on the aircraft is under load, and one that takes narrow pulses takes no others.
    pub(super) fn take_port(&mut self, port: &str) {
        if simulated_servo(port) == Some(AIRCRAFT) {
            self.condition = AIRCRAFT.into();
        }
        if simulates_narrow_pulses(port) {
            self.pulse_type = PulseTypeName::Narrow;
        }
    }

    fn is_simulated(&self) -> bool {
        self.port.as_deref().is_some_and(is_simulated)
    }

    /// What to write there once the port is that of a board.
    fn delay_note(&self) -> String {
        let SensorPreset {
            name,
            delay_ms: [delay_ms, uncertainty_ms],
            ..
        } = self.sensor_kind.preset();
        match self.is_simulated() && delay_ms > 0.0 {
            true => format!(
                "; 0 is that of the simulated rig alone: with a board, write {delay_ms} here and {uncertainty_ms} below for the {name}"
            ),
            false => String::new(),
        }
    }

    fn sensor_section(&self) -> SensorSection {
        let Range { low, high } = self.sensor_volts;
        let preset = self.sensor_kind.preset();
        let [delay_ms, delay_uncertainty_ms] = self.sensor_delay_ms;
        SensorSection {
            delay_ms,
            delay_uncertainty_ms,
            ..preset.section([low, high], self.sensor_degrees)
        }
    }

    /// Limits within the servo's pulses and the travel of the linkage (µs), rounded inwards to whole
    /// microseconds.
    fn limits_us(&self) -> [u16; 2] {
        let pulse = |angle: f64| f64::from(self.neutral_us) + angle * self.us_per_degree;
        let Range { low, high } = self.travel_deg;
        let ends = [pulse(low), pulse(high)];
        let low = self.pulses_us.low.max(ends[0].min(ends[1]).ceil());
        let high = self.pulses_us.high.min(ends[0].max(ends[1]).floor());
        [low, high].map(|us| us as u16)
    }

    /// The rig file, commented. An error names `path`.
    pub(super) fn to_rig_file(&self, path: &Path) -> Result<(String, RigFile), RigFileError> {
        let quoted = |text: &str| toml_edit::Value::from(text).to_string();
        let number = |number: f64| toml_edit::Value::from(number).to_string();
        let Range { low, high } = self.sensor_volts;
        let sensor = self.sensor_section();
        let [shortest, longest] = self.limits_us();
        let port = self
            .port
            .as_ref()
            .map(|port| format!("port = {}", quoted(port)));
        let values = [
            ("name", quoted(&self.name)),
            (
                "port",
                port.unwrap_or_else(|| "# port = \"/dev/ttyUSB0\"".to_owned()),
            ),
            ("condition", quoted(&self.condition)),
            ("servo", quoted(&self.servo)),
            ("neutral_us", self.neutral_us.to_string()),
            ("us_per_degree", number(self.us_per_degree)),
            ("pulse_rate_hz", number(self.pulse_rate_hz)),
            ("pulse_type", quoted(self.pulse_type.as_str())),
            ("sensor", quoted(&self.sensor)),
            ("volts", format!("{low} to {high} V")),
            ("degrees", self.sensor_degrees.to_string()),
            ("zero_counts", number(sensor.zero_counts)),
            ("degrees_per_count", number(sensor.degrees_per_count)),
            ("zero_sd_deg", number(sensor.zero_sd_deg)),
            ("scale_sd_percent", number(sensor.scale_sd_percent)),
            ("delay_ms", number(sensor.delay_ms)),
            ("delay_note", self.delay_note()),
            ("delay_uncertainty_ms", number(sensor.delay_uncertainty_ms)),
            ("healthy_counts", format!("{:?}", sensor.healthy_counts)),
            ("travel", self.travel_in_words()),
            ("shortest_us", shortest.to_string()),
            ("longest_us", longest.to_string()),
        ];
        let text = template::fill(include_str!("rig.toml"), &values);
        let rig = RigFile::parse(&text, path)?;
        Ok((text, rig))
    }

    /// The limits in degrees, and their reason.
    pub(super) fn travel_in_words(&self) -> String {
        let angle = |us: u16| (f64::from(us) - f64::from(self.neutral_us)) / self.us_per_degree;
        let [a, b] = self.limits_us().map(angle);
        let (low, high) = (a.min(b), a.max(b));
        // Limits are whole microseconds.
        let of_rounding = 1.0 / self.us_per_degree.abs();
        let Range {
            low: from,
            high: to,
        } = self.travel_deg;
        let is_cut = from < low - of_rounding || to > high + of_rounding;
        let because = match (self.travel_deg == DEFAULT_TRAVEL_DEG, is_cut) {
            (true, _) => {
                "a cautious default; widen it once you know that the linkage allows more".to_owned()
            }
            (false, false) => "the travel of the linkage".to_owned(),
            (false, true) => format!(
                "the travel of the linkage, {from} to {to}, cut to the pulses that the servo takes, {} µs (--pulses)",
                self.pulses_us
            ),
        };
        format!("From {low:.1} to {high:.1} degrees: {because}.")
    }
}

#[cfg(test)]
mod tests;
