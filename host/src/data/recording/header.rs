//! The comment lines above the rows: where a recording comes from.

use super::reference_toml::as_toml;
use crate::data::omitted_fields::is_zero;
use crate::data::rig_file::{PulseTypeName, RigFile};
use serde::{Deserialize, Serialize};
use servoid_protocol::hello::ClockSource;
use servoid_protocol::message::Start;
use servoid_protocol::timing::SAMPLES_PER_FRAME;
use servoid_protocol::{Hello, PulseTrain};
use std::ops::Range;
use toml::{Table, Value};

/// Version of the format; a reader refuses a higher one.
///
/// A recording of the usual pulses is written as format 3, since older readers know no other period of
/// samples.
pub const FORMAT: u32 = 4;

/// The format of recordings with pulses at 50 Hz.
const FORMAT_OF_USUAL_PULSES: u32 = 3;

/// How every recording begins.
pub(super) const FIRST_LINE: &str = "# format = ";

/// The key of the header's own CRC-32.
pub(super) const HEADER_CRC: &str = "header_crc32";

/// The provenance and the scales of a recording. One `# key = value` line each, in this order.
///
/// Keys that are missing get their defaults and keys that are not known are passed over, so that
/// recordings of other versions of the same format can be read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Header {
    /// At most [`FORMAT`].
    pub format: u32,
    /// Version of the program that wrote it.
    pub servoid: String,
    /// When the run began, UTC, RFC 3339.
    pub started: String,
    /// Name of the servo.
    pub servo: String,
    /// Under what condition: `bench`, `aircraft`, or the user's word.
    pub condition: String,
    /// Name of the rig.
    pub rig: String,
    /// The user's remarks.
    pub notes: String,
    /// The damage that the recording was recovered from; empty where there was none.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub recovered: String,
    /// Values of a damaged header that nothing proves, by name; empty where the header was sound.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub unproved: String,
    /// Where the rig was.
    pub port: String,
    /// Kind of board, its unique number, and the firmware's version.
    pub board: String,
    /// The board's unique number, hexadecimal.
    pub board_id: String,
    /// The firmware's version.
    pub firmware: String,
    /// Where the board's clock came from.
    pub clock: String,
    /// The reference signal, in microseconds from neutral and frames of 20 ms.
    pub reference: Option<Table>,
    /// Frames at neutral before the reference.
    pub pre_roll_frames: u16,
    /// Frames of the reference; 0 where it is not known.
    pub reference_frames: u32,
    /// Frames at neutral after the reference.
    pub post_roll_frames: u16,
    /// The kind of pulses.
    #[serde(skip_serializing_if = "PulseTypeName::is_wide")]
    pub pulse_type: PulseTypeName,
    /// From one pulse to the next (µs).
    #[serde(skip_serializing_if = "is_usual_period")]
    pub pulse_period_us: u16,
    /// Time between samples (s).
    pub sample_period_s: f64,
    /// From a change of the reference to the moment that the first sample after it stands for (s).
    pub sample_phase_s: f64,
    /// The pulse that commands 0 degrees (µs).
    pub neutral_us: u16,
    /// Change of the pulse for one degree (µs/deg).
    pub us_per_degree: f64,
    /// Name of the sensor.
    pub sensor: String,
    /// Sensor reading at 0 degrees (counts).
    pub zero_counts: f64,
    /// Degrees for one count.
    pub degrees_per_count: f64,
    /// Standard deviation of the sensor's zero (deg).
    pub zero_sd_deg: f64,
    /// Standard deviation of the sensor's scale (percent of it).
    pub scale_sd_percent: f64,
    /// Smallest and largest reading of a healthy sensor (counts), where they were written down.
    pub healthy_counts: Option<[u16; 2]>,
    /// Time by which the sensor's reading lags behind the shaft (s).
    #[serde(skip_serializing_if = "is_zero")]
    pub sensor_delay_s: f64,
    /// The true delay is at most this far from it (s).
    #[serde(skip_serializing_if = "is_zero")]
    pub sensor_delay_uncertainty_s: f64,
    /// Whether each row has a check of its own; the writer sees to it.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub row_checks: bool,
}

impl Default for Header {
    fn default() -> Self {
        let rig = RigFile::default();
        Self {
            format: FORMAT_OF_USUAL_PULSES,
            servoid: String::new(),
            started: String::new(),
            servo: String::new(),
            condition: String::new(),
            rig: String::new(),
            notes: String::new(),
            recovered: String::new(),
            unproved: String::new(),
            port: String::new(),
            board: String::new(),
            board_id: String::new(),
            firmware: String::new(),
            clock: String::new(),
            reference: None,
            pre_roll_frames: 0,
            reference_frames: 0,
            post_roll_frames: 0,
            pulse_type: PulseTypeName::Wide,
            pulse_period_us: PulseTrain::USUAL.period_us,
            sample_period_s: PulseTrain::USUAL.sample_s(),
            sample_phase_s: 0.0,
            neutral_us: rig.servo.neutral_us,
            us_per_degree: rig.servo.us_per_degree,
            sensor: String::new(),
            zero_counts: rig.sensor.zero_counts,
            degrees_per_count: rig.sensor.degrees_per_count,
            zero_sd_deg: rig.sensor.zero_sd_deg,
            scale_sd_percent: rig.sensor.scale_sd_percent,
            healthy_counts: None,
            sensor_delay_s: 0.0,
            sensor_delay_uncertainty_s: 0.0,
            row_checks: false,
        }
    }
}

impl Header {
    /// The samples of the reference, without the rest before and after it; `None` where the header states no reference.
    pub fn reference_samples(&self) -> Option<Range<u64>> {
        let of = |frames: u32| u64::from(frames) * SAMPLES_PER_FRAME as u64;
        let start = of(u32::from(self.pre_roll_frames));
        let length = of(self.reference_frames);
        (length > 0).then(|| start..start + length)
    }

    /// The header of a run that begins now.
    pub fn of_run(hello: &Hello, rig: &RigFile, start: &Start) -> Self {
        let now = std::time::SystemTime::now();
        Self {
            servoid: env!("CARGO_PKG_VERSION").to_owned(),
            started: humantime::format_rfc3339_seconds(now).to_string(),
            servo: rig.servo.name.clone(),
            rig: rig.name.clone(),
            board: hello.board.as_str().to_owned(),
            board_id: hello
                .unique_id
                .iter()
                .map(|byte| format!("{byte:02x}"))
                .collect(),
            firmware: hello.build.as_str().to_owned(),
            clock: format!("{:?}", hello.clock),
            reference: Some(as_toml(&start.reference)),
            pre_roll_frames: start.pre_roll_frames,
            reference_frames: start.reference.frames(),
            post_roll_frames: start.post_roll_frames,
            format: format_of(rig.train()),
            pulse_type: rig.servo.pulse_type,
            pulse_period_us: rig.train().period_us,
            sample_period_s: f64::from(hello.sample_us) / 1e6,
            sample_phase_s: sample_phase_s(hello),
            neutral_us: rig.servo.neutral_us,
            us_per_degree: rig.servo.us_per_degree,
            sensor: rig.sensor.name.clone(),
            zero_counts: rig.sensor.zero_counts,
            degrees_per_count: rig.sensor.degrees_per_count,
            zero_sd_deg: rig.sensor.zero_sd_deg,
            scale_sd_percent: rig.sensor.scale_sd_percent,
            healthy_counts: Some(rig.sensor.healthy_counts),
            sensor_delay_s: 1e-3 * rig.sensor.delay_ms,
            sensor_delay_uncertainty_s: 1e-3 * rig.sensor.delay_uncertainty_ms,
            ..Self::default()
        }
    }

    /// The pulses that the servo got.
    pub fn train(&self) -> PulseTrain {
        PulseTrain {
            pulses: self.pulse_type.into(),
            period_us: self.pulse_period_us,
        }
    }

    /// The train by which the times of the rows are written: that of the header, unless damage has made it one that no board
    /// makes.
    pub(super) fn train_of_rows(&self) -> PulseTrain {
        match self.train() {
            train if train.is_sound() => train,
            _ => PulseTrain::USUAL,
        }
    }

    /// The board's unique number; `None` where it has none.
    pub fn known_board_id(&self) -> Option<String> {
        Some(self.board_id.clone()).filter(|id| !id.is_empty())
    }

    /// Whether the board ran on its internal oscillator.
    pub fn has_inexact_clock(&self) -> bool {
        self.clock == format!("{:?}", ClockSource::InternalRc)
    }

    /// Whether the reference is a staircase, the one of the paper.
    pub fn is_of_staircase(&self) -> bool {
        let kind = self.reference.as_ref().and_then(|table| table.get("kind"));
        kind.and_then(Value::as_str) == Some("staircase")
    }

    /// The keys and values, in the file's order. A header always has a form in TOML.
    fn fields(&self) -> Table {
        Table::try_from(self).unwrap_or_default()
    }

    /// All that is known, in the file's order: name and value, empty values left out.
    pub(crate) fn facts(&self) -> Vec<(String, String)> {
        let text = |value: &Value| match value.as_str() {
            Some(text) => text.to_owned(),
            None => value.to_string(),
        };
        let facts = self.fields().into_iter();
        facts
            .filter(|(key, _)| key != "row_checks")
            .map(|(key, value)| (key.replace('_', " "), text(&value)))
            .filter(|(_, value)| !value.is_empty())
            .collect()
    }

    /// Marks the values of a damaged header that nothing proves. `proved` are the keys of those that the
    /// rows prove.
    pub(super) fn mark_unproved(&mut self, proved: &[&str]) {
        let matters = |key: &str, value: &Value| {
            !value.is_str() || ["condition", "servo", "sensor"].contains(&key)
        };
        let unproved: Vec<String> = self
            .fields()
            .iter()
            .filter(|(key, value)| matters(key, value) && !proved.contains(&key.as_str()))
            .map(|(key, value)| format!("{key} = {}", on_one_line(value)))
            .collect();
        self.unproved = unproved.join(", ");
    }

    /// The comment lines: the format first, a CRC-32 over all of them last; and that CRC, as it is written.
    pub(super) fn to_lines(&self) -> (String, String) {
        let fields = self.fields();
        let lines: String = fields
            .iter()
            .filter(|(key, _)| *key != "format")
            .map(|(key, value)| format!("# {key} = {}\n", on_one_line(value)))
            .collect();
        let lines = format!("{FIRST_LINE}{}\n{lines}", self.format);
        let crc32 = format!("{:08x}", crc32fast::hash(lines.as_bytes()));
        (format!("{lines}# {HEADER_CRC} = \"{crc32}\"\n"), crc32)
    }
}

fn is_usual_period(period_us: &u16) -> bool {
    *period_us == PulseTrain::USUAL.period_us
}

/// The format that a recording with this train needs.
pub(super) fn format_of(train: PulseTrain) -> u32 {
    match train {
        PulseTrain::USUAL => FORMAT_OF_USUAL_PULSES,
        _ => FORMAT,
    }
}

/// From an edge to the moment that a sample stands for (s): the mean of the ends of its conversions.
/// (The converter holds the voltage about a microsecond before each end, which is below what any
/// result resolves.)
fn sample_phase_s(hello: &Hello) -> f64 {
    let conversions = f64::from(hello.oversampling.max(1));
    let mean_end = f64::from(hello.aperture_us) * (conversions + 1.0) / (2.0 * conversions);
    (f64::from(hello.first_sample_us) + mean_end) * 1e-6
}

/// A value in TOML, on one line whatever texts are in it: TOML would write a text with a line end over
/// several lines, which would then be no comments any more.
pub(super) fn on_one_line(value: &Value) -> String {
    let Value::String(text) = value else {
        return value.to_string();
    };
    let escaped = |letter: char| match letter {
        '"' => "\\\"".to_owned(),
        '\\' => "\\\\".to_owned(),
        control if control.is_control() => format!("\\u{:04X}", u32::from(control)),
        other => other.to_string(),
    };
    format!("\"{}\"", text.chars().map(escaped).collect::<String>())
}
