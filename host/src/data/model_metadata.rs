//! What the files behind a model say of it, which its numbers do not: units, and what held the command.

use crate::data::dataset::About;
use crate::data::table;
use crate::presentation::summary::Units;
use serde::{Deserialize, Serialize};
use servoid_protocol::timing::FRAME_US;

/// The pulse frame of servoid's rig \[s\].
const RIG_FRAME_S: f64 = FRAME_US as f64 * 1e-6;

/// Pulse frames that a servo may have \[s\]; beyond a second it is a slip.
pub const PULSE_FRAMES_S: std::ops::RangeInclusive<f64> = 0.0..=1.0;

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

/// Where a model comes from, as far as its user has to know; what is not known is left out.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ModelMetadata {
    #[serde(default, skip_serializing_if = "UnitNames::are_unknown")]
    units: UnitNames,
    /// The time for which a pulse frame holds a command \[s\], 0 where commands take effect at once.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pulse_frame_s: Option<f64>,
}

impl ModelMetadata {
    /// What a model file says; one without these fields, as older ones are, says nothing.
    ///
    /// ```
    /// use servoid::model_metadata::ModelMetadata;
    /// let origin = ModelMetadata::in_model_file(r#"{"units": {"input": "us"}, "pulse_frame_s": 0.02}"#);
    /// assert_eq!((origin.units().input, origin.pulse_frame_s), (Some("us"), Some(0.02)));
    /// assert_eq!(ModelMetadata::in_model_file("{}"), ModelMetadata::default());
    /// ```
    #[must_use]
    pub fn in_model_file(text: &str) -> Self {
        let found: Self = serde_json::from_str(text).unwrap_or_default();
        Self {
            pulse_frame_s: found
                .pulse_frame_s
                .filter(|frame| PULSE_FRAMES_S.contains(frame)),
            ..found
        }
    }

    /// The units of command and position.
    #[must_use]
    pub fn units(&self) -> Units<'_> {
        Units {
            input: self.units.input.as_deref(),
            output: self.units.output.as_deref(),
        }
    }

    /// Refuses to hold two against each other whose units are known and differ; `name` and
    /// `other_name` are what they are called.
    ///
    /// # Errors
    /// [`UnitsDiffer`].
    pub fn same_units(
        &self,
        name: &str,
        other: &Self,
        other_name: &str,
    ) -> Result<(), UnitsDiffer> {
        let (mine, theirs) = (self.units(), other.units());
        for (what, unit, other_unit) in [
            ("command", mine.input, theirs.input),
            ("position", mine.output, theirs.output),
        ] {
            if let (Some(unit), Some(other_unit)) = (unit, other_unit)
                && let (Some(one), Some(another)) = (unit_meant(unit), unit_meant(other_unit))
                && one != another
            {
                return Err(UnitsDiffer {
                    what,
                    name: name.to_owned(),
                    unit: unit.to_owned(),
                    other: other_name.to_owned(),
                    other_unit: other_unit.to_owned(),
                });
            }
        }
        Ok(())
    }
}

impl From<&About> for ModelMetadata {
    fn from(about: &About) -> Self {
        Self {
            units: UnitNames {
                input: about.input_unit.clone(),
                output: about.output_unit.clone(),
            },
            // A recording of servoid was commanded by pulses, which change with the frame only.
            pulse_frame_s: about.by_servoid.then_some(RIG_FRAME_S),
        }
    }
}

/// Two that cannot be held against each other.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the {what} of {name} is in {unit}, that of {other} in {other_unit}: only what is in the same units can be put together or held against each other, so convert one of the recordings"
)]
pub struct UnitsDiffer {
    what: &'static str,
    name: String,
    unit: String,
    other: String,
    other_unit: String,
}

/// One spelling for all of a unit; `None` for what may be no unit at all, such as the "bench" of
/// "angle (bench)", and for "grad", which is a degree in German and 0.9 degrees elsewhere.
fn unit_meant(unit: &str) -> Option<String> {
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

    fn origin(input: &str, output: &str) -> ModelMetadata {
        ModelMetadata::from(&About {
            input_unit: Some(input.to_owned()),
            output_unit: Some(output.to_owned()),
            ..About::default()
        })
    }

    #[test]
    fn units_differ_where_both_are_known_and_mean_different_things() {
        let degrees = origin("deg", "deg");
        for (input, output, differs) in [
            ("°", "degrees", false),
            ("bench", "deg", false),
            ("grad", "deg", false),
            ("µs", "deg", true),
            ("deg", "counts", true),
        ] {
            let other = origin(input, output);
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
            origin("µs", "deg").same_units("a", &origin("usec", "°"), "b"),
            Ok(())
        );
        let sentence = degrees
            .same_units("a", &origin("µs", "deg"), "b")
            .unwrap_err();
        assert!(
            sentence
                .to_string()
                .starts_with("the command of a is in deg, that of b in µs:"),
            "{sentence}"
        );
    }

    #[test]
    fn what_is_written_is_read_again_and_what_is_not_known_is_not_written() {
        let ours = ModelMetadata {
            pulse_frame_s: Some(RIG_FRAME_S),
            ..origin("deg", "deg")
        };
        let text = serde_json::to_string(&ours).unwrap();
        assert_eq!(ModelMetadata::in_model_file(&text), ours);
        assert_eq!(
            serde_json::to_string(&ModelMetadata::default()).unwrap(),
            "{}"
        );
        for wrong in ["-0.02", "1e300", "\"x\""] {
            let text = format!("{{\"pulse_frame_s\": {wrong}}}");
            assert_eq!(
                ModelMetadata::in_model_file(&text).pulse_frame_s,
                None,
                "{wrong}"
            );
        }
    }
}
