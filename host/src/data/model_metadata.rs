//! Facts about a model that its numbers do not show: units, and the frame that held the command.

use crate::data::omitted_fields::is_zero;
use crate::data::rig_file::LONGEST_DELAY_MS;
use crate::data::table;
use crate::data::units::Units;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use servoid_identification::servo_model::{RecordedMotion, WaitsForPulses};

/// Pulse frames that a servo may have \[s\]; beyond a second it is a slip.
pub const PULSE_FRAMES_S: std::ops::RangeInclusive<f64> = 0.0..=1.0;

/// The shortest that users state \[s\]: narrow pulses come in 1.8 ms, and 0.02 is a frame in seconds.
pub(crate) const SHORTEST_FRAME_S: f64 = 1e-3;

/// Names of the units of a model's command and position.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct UnitNames {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    input: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    output: Option<String>,
}

impl UnitNames {
    fn are_unknown(&self) -> bool {
        *self == Self::default()
    }
}

/// Where a model comes from, as far as its user has to know; unknown facts are left out.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ModelMetadata {
    #[serde(default, skip_serializing_if = "UnitNames::are_unknown")]
    units: UnitNames,
    /// The time for which a pulse frame holds a command \[s\], 0 where commands take effect at once.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pulse_frame_s: Option<f64>,
    /// Whether that frame was stated by hand where the model does not say that its commands were written at their pulses.
    #[serde(skip)]
    pub frame_is_stated: bool,
    /// The delay of the sensor that was taken out, where all recordings state one and agree \[s\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensor_delay_s: Option<f64>,
    /// The number of the board that recorded, where all recordings state one and agree.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub board_id: Option<String>,
    /// That delay is at most this far from the true one \[s\].
    #[serde(default, skip_serializing_if = "is_zero")]
    pub sensor_delay_uncertainty_s: f64,
    /// Whether the command moves on between the rows of a file of another program: the uncertainty of the delay is then that of how it was sent.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub moving_command: bool,
    /// Whether a logger is stated to have polled the commands of a file of another program.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub polled: bool,
    /// Whether it is stated of such a file that the servo was sent each command as it is written, with its row.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub exact_command: bool,
    /// By how much the wait for pulses on a clock of their own may differ from that of another recording in all times alike \[s\].
    #[serde(default, skip_serializing_if = "is_zero")]
    pub common_wait_s: f64,
    /// Degrees for one count of the sensor, where all recordings state one and agree.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub degrees_per_count: Option<f64>,
    /// Standard deviation of that scale (percent of it): the largest of those of the recordings.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub scale_sd_percent: f64,
    /// The size of the strokes in the recording, where all have one (unit of the command).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub only_stroke: Option<f64>,
    /// The range of the commands of the recording, and how fast the servo moved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recorded: Option<RecordedMotion>,
}

impl ModelMetadata {
    /// Units where they are named, and the pulse frame where it is known.
    pub fn new(input: Option<String>, output: Option<String>, pulse_frame_s: Option<f64>) -> Self {
        Self {
            units: UnitNames { input, output },
            pulse_frame_s,
            frame_is_stated: false,
            sensor_delay_s: None,
            board_id: None,
            sensor_delay_uncertainty_s: 0.0,
            moving_command: false,
            polled: false,
            exact_command: false,
            common_wait_s: 0.0,
            degrees_per_count: None,
            scale_sd_percent: 0.0,
            only_stroke: None,
            recorded: None,
        }
    }

    /// With the pulse frame that somebody states, if anybody does.
    #[must_use]
    pub fn with_stated_frame(self, frame_s: Option<f64>) -> Self {
        Self {
            pulse_frame_s: frame_s.or(self.pulse_frame_s),
            frame_is_stated: frame_s.is_some() && self.pulse_frame_s.is_none(),
            ..self
        }
    }

    /// With the pulses that a servo model has the commands at, where its recording did not.
    #[must_use]
    pub fn behind_pulses(self, found: Option<WaitsForPulses>) -> Self {
        match found {
            Some(waits) => Self {
                pulse_frame_s: self.pulse_frame_s.or(Some(waits.nominal_frame_s())),
                frame_is_stated: false,
                ..self
            },
            None => self,
        }
    }

    /// Those of a model's document; one without these fields, as older ones are, has none.
    ///
    /// ```
    /// use servoid::data::ModelMetadata;
    /// let document = serde_json::json!({"units": {"input": "us"}, "pulse_frame_s": 0.02});
    /// let metadata = ModelMetadata::in_document(&document);
    /// assert_eq!((metadata.units().input, metadata.pulse_frame_s), (Some("us"), Some(0.02)));
    /// assert_eq!(ModelMetadata::in_document(&serde_json::json!({})), ModelMetadata::default());
    /// ```
    pub fn in_document(document: &Value) -> Self {
        let found = Self::deserialize(document).unwrap_or_default();
        // What is no time of a sensor is passed over, as other fields are.
        let of_sensor = |delay_s: &f64| (0.0..=1e-3 * LONGEST_DELAY_MS).contains(delay_s);
        let uncertainty_s = Some(found.sensor_delay_uncertainty_s).filter(of_sensor);
        Self {
            sensor_delay_s: found.sensor_delay_s.filter(of_sensor),
            sensor_delay_uncertainty_s: uncertainty_s.unwrap_or_default(),
            common_wait_s: Some(found.common_wait_s)
                .filter(|wait| PULSE_FRAMES_S.contains(wait))
                .unwrap_or_default(),
            degrees_per_count: found.degrees_per_count.filter(|scale| scale.is_finite()),
            scale_sd_percent: Some(found.scale_sd_percent)
                .filter(|sd| (0.0..=100.0).contains(sd))
                .unwrap_or_default(),
            only_stroke: found.only_stroke.filter(|size| *size > 0.0),
            pulse_frame_s: found
                .pulse_frame_s
                .filter(|frame| PULSE_FRAMES_S.contains(frame)),
            ..found
        }
    }

    /// The units of command and position.
    pub fn units(&self) -> Units<'_> {
        Units {
            input: self.units.input.as_deref(),
            output: self.units.output.as_deref(),
        }
    }

    /// Refuses to compare two whose units are known and differ; `name` and
    /// `other_name` are what they are called.
    pub fn same_units(
        &self,
        name: &str,
        other: &Self,
        other_name: &str,
    ) -> Result<(), UnitsDiffer> {
        let (mine, theirs) = (self.units(), other.units());
        let both = [
            ("command", mine.input, theirs.input),
            ("position", mine.output, theirs.output),
        ];
        let differ = both.into_iter().find_map(|(what, unit, other_unit)| {
            let (unit, other_unit) = different(unit, other_unit)?;
            Some(UnitsDiffer {
                what,
                name: name.to_owned(),
                unit: unit.to_owned(),
                other: other_name.to_owned(),
                other_unit: other_unit.to_owned(),
            })
        });
        differ.map_or(Ok(()), Err)
    }

    /// The units of the commands of both, where these differ and those of the positions do not.
    pub fn other_command<'u>(&'u self, other: &'u Self) -> Option<(&'u str, &'u str)> {
        let (mine, theirs) = (self.units(), other.units());
        different(mine.input, theirs.input)
            .filter(|_| different(mine.output, theirs.output).is_none())
    }
}

/// Both units, where they are known and mean different things.
fn different<'u>(one: Option<&'u str>, other: Option<&'u str>) -> Option<(&'u str, &'u str)> {
    let (one, other) = (one?, other?);
    (unit_meant(one)? != unit_meant(other)?).then_some((one, other))
}

/// Two that cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{}: only data in the same units can be put together or compared, so convert one of the recordings",
    self.in_words()
)]
pub struct UnitsDiffer {
    what: &'static str,
    name: String,
    unit: String,
    other: String,
    other_unit: String,
}

impl UnitsDiffer {
    /// "the command of a.json is in us, that of b.json in deg"
    pub fn in_words(&self) -> String {
        let Self {
            what,
            name,
            unit,
            other,
            other_unit,
        } = self;
        format!("the {what} of {name} is in {unit}, that of {other} in {other_unit}")
    }
}

/// One spelling for all of a unit; `None` for what may be no unit at all, such as the "bench" of
/// "angle (bench)", and for "grad", which is a degree in German and 0.9 degrees elsewhere.
pub(crate) fn unit_meant(unit: &str) -> Option<String> {
    let unit = unit.to_lowercase();
    Some(match unit.as_str() {
        "grad" | "-" => return None,
        "°" | "degree" | "degrees" => "deg".to_owned(),
        "°/s" => "deg/s".to_owned(),
        "µs" | "μs" | "usec" => "us".to_owned(),
        "msec" => "ms".to_owned(),
        "sec" | "second" | "seconds" => "s".to_owned(),
        "volt" | "volts" => "v".to_owned(),
        "percent" => "%".to_owned(),
        "count" | "ticks" | "steps" | "lsb" | "adc" | "bit" => "counts".to_owned(),
        known if table::is_unit(known) => unit,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(input: &str, output: &str) -> ModelMetadata {
        ModelMetadata::new(Some(input.to_owned()), Some(output.to_owned()), Some(0.02))
    }

    #[test]
    fn units_differ_where_both_are_known_and_mean_different_things() {
        let degrees = of("deg", "deg");
        for (input, output, differs) in [
            ("°", "degrees", false),
            ("bench", "deg", false),
            ("grad", "deg", false),
            ("µs", "deg", true),
            ("deg", "counts", true),
        ] {
            let other = of(input, output);
            for (a, b) in [(&degrees, &other), (&other, &degrees)] {
                assert_eq!(
                    a.same_units("a", b, "b").is_err(),
                    differs,
                    "{input} {output}"
                );
            }
        }
        assert_eq!(
            degrees.same_units("a", &ModelMetadata::default(), "b"),
            Ok(())
        );
        assert_eq!(
            of("µs", "deg").same_units("a", &of("usec", "°"), "b"),
            Ok(())
        );
        let commands = |other: &ModelMetadata| degrees.other_command(other).is_some();
        assert!(commands(&of("µs", "deg")) && !commands(&of("µs", "counts")));
        assert!(!commands(&of("deg", "deg")));
        let sentence = degrees.same_units("a", &of("µs", "deg"), "b").unwrap_err();
        assert!(
            sentence
                .to_string()
                .starts_with("the command of a is in deg, that of b in µs:"),
            "{sentence}"
        );
    }

    #[test]
    fn what_is_written_is_read_again_and_what_is_not_known_is_not_written() {
        let ours = of("deg", "deg");
        let document = serde_json::to_value(&ours).unwrap();
        assert_eq!(ModelMetadata::in_document(&document), ours);
        assert_eq!(
            serde_json::to_string(&ModelMetadata::default()).unwrap(),
            "{}"
        );
        for wrong in ["-0.02", "1e300", "\"x\""] {
            let document = format!("{{\"pulse_frame_s\": {wrong}}}").parse().unwrap();
            let found = ModelMetadata::in_document(&document);
            assert_eq!(found.pulse_frame_s, None, "{wrong}");
        }
    }
}
