//! Where data come from, as far as the files state it.

use crate::data::model_metadata::ModelMetadata;
use crate::data::recording::Header;
use crate::data::units::Units;
use servoid_identification::results::{Advice, Check};
use servoid_identification::servo_model::RecordedMotion;

/// Where data come from, as far as the files state it.
#[derive(Clone, Debug, Default)]
pub struct About {
    /// Time between two pulses of the servo (s), where all files are recordings of servoid and agree.
    pub pulse_frame_s: Option<f64>,
    /// Whether all files are recordings of servoid's staircase, the reference of the paper.
    pub staircase: bool,
    /// The unit of what was commanded, where the files state it and agree.
    pub input_unit: Option<String>,
    /// The unit of what was measured, where the files state it and agree.
    pub output_unit: Option<String>,
    /// The size of all strokes of the command, where they have one.
    pub only_stroke: Option<f64>,
    /// The range of the commands, and the speeds that were measured, of all files together.
    pub recorded: Option<RecordedMotion>,
    /// Under what condition it was recorded, where the files state it and agree.
    pub condition: Option<String>,
    /// Where the data come from, file by file: name and value of each thing that is known.
    pub provenance: Vec<Vec<(String, String)>>,
    /// What a user should know about the files: partial recordings, guessed periods.
    pub remarks: Vec<String>,
    /// What every result from these files has to carry: that a recording is partial, or values of
    /// its header unproved.
    pub advice: Vec<Advice>,
    /// Change of the pulse for one degree of the command (µs/deg), where all files are recordings of servoid and agree.
    pub us_per_degree: Option<f64>,
    /// The calibration of the sensor in each recording of servoid.
    pub calibrations: Vec<SensorCalibration>,
    /// Whether the clock of a recording was the internal oscillator of its board.
    pub inexact_clock: bool,
    /// The sensor's true delay is at most this far from the one that was taken out (s).
    pub sensor_delay_uncertainty_s: f64,
    /// Whether commands of a file of another program are taken to change at their rows.
    pub commands_at_rows: bool,
    /// Another column of a file that is called like one of commands, beside the one that was taken.
    pub other_input: Option<String>,
    /// Whether a logger is stated to have polled the commands.
    pub polled: bool,
    /// Whether it is stated that the servo was sent each command as it is written, with its row.
    pub exact_command: bool,
    /// Whether the command moves on between the rows of a file of another program: whether the servo was held at each is not in it.
    pub moving_command: bool,
    /// By how much the wait for pulses on a clock of their own may differ from that of another recording in all times alike (s); 0 where none does.
    pub common_wait_s: f64,
    /// The delay that was taken out of the recordings (s), where all state one and agree.
    pub sensor_delay_s: Option<f64>,
    /// The number of the board that recorded them, where all state one and agree.
    pub board_id: Option<String>,
}

/// Where counts are degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorCalibration {
    /// Degrees for one count.
    pub degrees_per_count: f64,
    /// Reading at 0 degrees (counts).
    pub zero_counts: f64,
    /// Standard deviation of the scale (percent of it).
    pub scale_sd_percent: f64,
}

impl SensorCalibration {
    /// That of a recording.
    pub(super) fn of(header: &Header) -> Self {
        Self {
            degrees_per_count: header.degrees_per_count,
            zero_counts: header.zero_counts,
            scale_sd_percent: header.scale_sd_percent,
        }
    }
}

impl About {
    /// That the files of two sides state different conditions.
    pub(crate) fn other_condition(&self, other: &Self) -> Option<Advice> {
        let both = self.condition.as_ref().zip(other.condition.as_ref());
        let (a, b) = both.filter(|(a, b)| a != b)?;
        Some(Advice::new(
            Check::Conditions,
            format!(
                "The files state different conditions: the first is \"{a}\", the second \"{b}\". What differs is then that of load and supply as well \
                 as that of the servos."
            ),
            1.0,
            0.0,
            "Nothing needs to be done where the conditions are what is compared; for a verdict on two servos, record both under one condition.",
        ))
    }

    /// What to do about a second side that rests apart from the first, where conditions are not the same.
    pub(crate) fn load_of_condition(&self) -> Option<String> {
        self.condition.as_ref().map(|condition| {
            format!(
                "Where there is a load under the condition \"{condition}\", it holds a servo there; where there is none, calibrate the sensor of both sides with the same zero."
            )
        })
    }

    /// That the recordings of two sides were made with different calibrations of the sensor.
    pub(crate) fn other_calibration(&self, other: &Self) -> Option<Advice> {
        let with_others = |a| other.calibrations.iter().map(move |b| (a, b));
        let mut pairs = self.calibrations.iter().flat_map(with_others);
        let (a, b) = pairs.find(|(a, b)| a != b)?;
        let percent = 100.0 * (b.degrees_per_count / a.degrees_per_count - 1.0);
        let zero = (b.zero_counts - a.zero_counts) * a.degrees_per_count;
        let scale = match percent < -100.0 {
            true => "the second turns the other way (its scale has the other sign)".to_owned(),
            false => format!("the scale of the second is {percent:+.2} % from that of the first"),
        };
        Some(Advice::new(
            Check::Calibration,
            format!(
                "The sides have different calibrations of the sensor: {scale}, and its zero is \
                 {zero:+.2} degrees. Where the sensor is the same, gains and levels differ by that much for this reason alone."
            ),
            percent,
            0.0,
            "Calibrate once ('servoid calibrate'), and capture both sides with the same rig file ('servoid capture --rig rig.toml'), unless the sensors differ.",
        ))
    }

    /// The unit of the input of both, empty where they do not have one in common.
    pub(crate) fn input_unit_with(&self, other: &Self) -> String {
        in_common(&self.input_unit, &other.input_unit)
    }

    /// The unit of the output of both, empty where they do not have one in common.
    pub(crate) fn output_unit_with(&self, other: &Self) -> String {
        in_common(&self.output_unit, &other.output_unit)
    }

    /// Whether a file of another program has the commands, in rows that may be beside the pulses.
    pub(crate) fn is_of_rows(&self) -> bool {
        self.commands_at_rows || self.polled
    }

    /// Whether these commands may wait for pulses: nothing states that each was sent with its row.
    pub(crate) fn commands_may_wait(&self) -> bool {
        self.is_of_rows() && !self.exact_command
    }

    /// The units of the two columns.
    pub(crate) fn units(&self) -> Units<'_> {
        Units {
            input: self.input_unit.as_deref(),
            output: self.output_unit.as_deref(),
        }
    }

    pub(super) fn merge(&mut self, other: Self) {
        agree(&mut self.pulse_frame_s, &other.pulse_frame_s);
        self.staircase &= other.staircase;
        self.commands_at_rows |= other.commands_at_rows;
        self.polled |= other.polled;
        self.exact_command |= other.exact_command;
        self.moving_command |= other.moving_command;
        self.inexact_clock |= other.inexact_clock;
        self.common_wait_s = self.common_wait_s.max(other.common_wait_s);
        let (mine, theirs) = (
            self.sensor_delay_uncertainty_s,
            other.sensor_delay_uncertainty_s,
        );
        self.sensor_delay_uncertainty_s = mine.max(theirs);
        agree(&mut self.us_per_degree, &other.us_per_degree);
        agree(&mut self.input_unit, &other.input_unit);
        agree(&mut self.output_unit, &other.output_unit);
        agree(&mut self.condition, &other.condition);
        agree(&mut self.board_id, &other.board_id);
        agree(&mut self.other_input, &other.other_input);
        agree(&mut self.sensor_delay_s, &other.sensor_delay_s);
        self.calibrations.extend(other.calibrations);
        self.provenance.extend(other.provenance);
        self.remarks.extend(other.remarks);
        self.advice.extend(other.advice);
    }

    /// Adds that data are used otherwise than they were written, in so many `rows`. Results rest on it, so that every one carries it.
    pub(super) fn add_change(&mut self, finding: String, rows: usize) {
        let remedy = "Where that is wrong, change the file: the result rests on it.";
        let advice = Advice::new(Check::ChangedData, finding, rows as f64, 0.0, remedy);
        self.remarks.push(advice.finding.clone());
        self.advice.push(advice);
    }

    /// Adds a remark that every result carries too, as advice that `value` is there where `threshold` was meant.
    pub(super) fn add(
        &mut self,
        check: Check,
        remark: String,
        [value, threshold]: [f64; 2],
        remedy: &str,
    ) {
        let finding = format!("{remark}.");
        self.advice
            .push(Advice::new(check, finding, value, threshold, remedy));
        self.remarks.push(remark);
    }
}

/// What is not the same in another file is not known of both.
fn agree<T: PartialEq>(mine: &mut Option<T>, theirs: &Option<T>) {
    if mine != theirs {
        *mine = None;
    }
}

fn in_common(a: &Option<String>, b: &Option<String>) -> String {
    a.clone().filter(|_| a == b).unwrap_or_default()
}

impl From<&About> for ModelMetadata {
    fn from(about: &About) -> Self {
        let (input, output) = (about.input_unit.clone(), about.output_unit.clone());
        let mut metadata = Self::new(input, output, about.pulse_frame_s);
        metadata.sensor_delay_s = about.sensor_delay_s;
        metadata.board_id.clone_from(&about.board_id);
        metadata.sensor_delay_uncertainty_s = about.sensor_delay_uncertainty_s;
        metadata.moving_command = about.moving_command;
        metadata.common_wait_s = about.common_wait_s;
        metadata.polled = about.polled;
        metadata.exact_command = about.exact_command;
        let scales = || about.calibrations.iter();
        let first = scales().next().map(|first| first.degrees_per_count);
        metadata.degrees_per_count =
            first.filter(|first| scales().all(|of| of.degrees_per_count == *first));
        metadata.scale_sd_percent = scales().map(|of| of.scale_sd_percent).fold(0.0, f64::max);
        metadata.only_stroke = about.only_stroke;
        metadata.recorded = about.recorded;
        metadata
    }
}
