//! Whether bounds hold: they are valid at their level, or withdrawn for a reason.
//!
//! Bounds of this crate are those of noise. They hold if the input excites all of the response, the
//! frequencies kept describe it, the errors are noise, and the steps of the sensor are smaller than that noise.
//! Identification decides that once; bounds that do not hold are not there at all, neither here nor in any document.

use serde::de::DeserializeOwned;
use serde::ser::SerializeStruct;
use serde::{Deserialize, Serialize, Serializer};

/// Why no bounds can be given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// The servo stops following the input within a run.
    ServoStopped,
    /// The servo moves before its command changes, as where commands were written late.
    EarlyMotion,
    /// The output is refreshed less often than samples are taken.
    HeldOutput,
    /// The lag of the output changes along the record, as where two clocks differ.
    LagDrift,
    /// Commands take effect between the samples, as where a logger polled them.
    CommandsBetweenRows,
    /// Each command waits for a moment of its own, as for a pulse: a model of low order has no such wait.
    CommandsWait,
    /// The output stops at an angle within the range of the commands, as at a mechanical stop, or under a load that holds the drive.
    TravelEnd,
    /// The output falls short of its outermost commands, and they do not show whether a stop, a load or friction does that.
    TravelEndOpen,
    /// As [`TravelEnd`](Self::TravelEnd), where a servo model explains it by a load that holds the drive, and has no stop.
    LoadHoldsDrive,
    /// The gain changes along the record, as under a supply that sags.
    GainDrift,
    /// The input lacks the frequencies that part of the response consists of.
    InputUnexcited,
    /// Of a servo model: the command goes to fewer levels than distinguish gain and offset from friction, a dead band and a load.
    FewLevels,
    /// Of a servo model: it has friction, and the record does not show how much.
    FrictionUnseen,
    /// Of a servo model: the motion is lost in the noise.
    MotionInNoise,
    /// The number of frequencies that was asked for leaves out more than can be bounded, though the input has it.
    FrequenciesLeftOut,
    /// The errors follow the motion, or generalised least squares fits worse for taking them for noise.
    ErrorsNotNoise,
    /// The servo is hardly ever at rest, so that nothing shows whether its errors in motion are noise.
    NeverAtRest,
    /// The steps of the sensor are larger than the noise, and the input does not average them out.
    QuantisationAboveNoise,
    /// The command runs further ahead of the servo than in the recording that the model comes from.
    BeyondRecord,
    /// Of a sine: the record leaves its response open by more than a turn.
    SineOpen,
    /// The response goes on beyond the longest time that can be judged, or the settling time that was given.
    ResponseNotOver,
    /// The input does not show whether the response is over after the settling time: it repeats itself too soon.
    EndUnseen,
    /// The input was computed from the output, as a controller does.
    InputFollowsOutput,
    /// No model of low order fits, so that what its parameters would be of is not there.
    OrderRejected,
}

impl Reason {
    /// Whether a record without bounds for this reason still has the motion of a servo under its command: not that of a loop, nor of one
    /// that stops, nor one whose times are not what they seem. Elsewhere no model of it describes a servo.
    #[must_use]
    pub fn leaves_a_servo(self) -> bool {
        !matches!(
            self,
            Self::CommandsBetweenRows
                | Self::ServoStopped
                | Self::InputFollowsOutput
                | Self::EarlyMotion
                | Self::HeldOutput
                | Self::LagDrift
        )
    }

    /// Whether part of the response itself is not known: a model of low order would take what is shown of it for the servo.
    #[must_use]
    pub fn leaves_response_open(self) -> bool {
        matches!(self, Self::InputUnexcited | Self::ResponseNotOver)
    }

    /// Whether the rests of a record without bounds for this reason are those of one servo: one that meets a stop has all others as ever, and when commands change is
    /// nothing to where it rests.
    #[must_use]
    pub fn leaves_rests(self) -> bool {
        matches!(
            self,
            Self::CommandsBetweenRows
                | Self::TravelEnd
                | Self::TravelEndOpen
                | Self::LoadHoldsDrive
        )
    }

    /// Whether it speaks against the record, and so against the bounds of any model of it, and not of a linear one alone.
    #[must_use]
    pub fn is_of_the_record(self) -> bool {
        !self.leaves_a_servo()
            || matches!(
                self,
                Self::TravelEnd | Self::TravelEndOpen | Self::LoadHoldsDrive | Self::GainDrift
            )
    }

    /// The reason in a few words, for beside a number.
    #[must_use]
    pub fn because(self) -> &'static str {
        match self {
            Self::ServoStopped => "the servo stops following the command within the recording",
            Self::EarlyMotion => "the servo moves before its command",
            Self::HeldOutput => "the position is refreshed less often than it is written",
            Self::LagDrift => "the servo's lag changes along the recording",
            Self::CommandsBetweenRows => "commands seem to change between the rows",
            Self::CommandsWait => "each command waits for a moment of its own, as for a pulse",
            Self::TravelEnd => {
                "the servo does not go as far as its outermost commands, as at a stop or under a load that holds it"
            }
            Self::TravelEndOpen => {
                "the servo falls short of its outermost commands, and they do not show why"
            }
            Self::LoadHoldsDrive => "a load, or a stop, holds the servo short of some commands",
            Self::GainDrift => "the servo's gain changes along the recording",
            Self::InputUnexcited => "the reference does not excite all of the response",
            Self::FewLevels => {
                "the command goes to fewer than three levels, which leaves open what is friction, a dead band or a load, and what is gain"
            }
            Self::FrictionUnseen => "the recording does not show how much friction the servo has",
            Self::MotionInNoise => "the motion is lost in the noise",
            Self::FrequenciesLeftOut => {
                "part of the response lies at frequencies that were left out"
            }
            Self::ErrorsNotNoise => "the errors are not noise",
            Self::NeverAtRest => "the servo is hardly ever at rest, so nothing shows what is noise",
            Self::QuantisationAboveNoise => "the steps of the sensor are larger than the noise",
            Self::BeyondRecord => {
                "the command is farther ahead of the servo than in the recording, by larger or quicker strokes"
            }
            Self::SineOpen => "the recording does not determine the response to such a sine",
            Self::ResponseNotOver => "the response is not seen to end within the settling time",
            Self::EndUnseen => "the reference does not show whether the response is over",
            Self::InputFollowsOutput => "the input follows the output, as in a closed loop",
            Self::OrderRejected => "no servo of up to three poles answers like this one (p < 0.01)",
        }
    }
}

/// Bounds, if they hold.
///
/// In a document these are two fields: `"bounds"`, which is `null` unless they hold, and
/// `"withdrawn"`, which is `null` if they do and else has the `reason` and a few words, `because`.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(try_from = "Document")]
#[serde(bound(deserialize = "T: DeserializeOwned"))]
pub enum Bounds<T> {
    /// They hold at the level that is stated in them.
    Valid(T),
    /// There are none.
    Withdrawn(Reason),
}

impl Bounds<f64> {
    /// The level of bounds that evidence has still to test, if nothing is known to speak `against` them.
    pub(crate) fn of_level(level: f64, against: Option<Reason>) -> Self {
        against.map_or(Self::Valid(level), Self::Withdrawn)
    }
}

impl<T> Bounds<T> {
    /// The bounds; `None` where they are withdrawn.
    pub fn valid(&self) -> Option<&T> {
        self.as_ref().into_valid()
    }

    /// The bounds themselves; `None` where they are withdrawn.
    pub fn into_valid(self) -> Option<T> {
        match self {
            Self::Valid(bounds) => Some(bounds),
            Self::Withdrawn(_) => None,
        }
    }

    /// Why there are none; `None` where they hold.
    pub fn withdrawn(&self) -> Option<Reason> {
        match self {
            Self::Valid(_) => None,
            Self::Withdrawn(reason) => Some(*reason),
        }
    }

    /// The same by reference.
    pub fn as_ref(&self) -> Bounds<&T> {
        match self {
            Self::Valid(bounds) => Bounds::Valid(bounds),
            Self::Withdrawn(reason) => Bounds::Withdrawn(*reason),
        }
    }

    /// What follows from the bounds holds if they do.
    pub fn map<U>(self, of: impl FnOnce(T) -> U) -> Bounds<U> {
        match self {
            Self::Valid(bounds) => Bounds::Valid(of(bounds)),
            Self::Withdrawn(reason) => Bounds::Withdrawn(reason),
        }
    }

    /// The same, withdrawn where something more speaks against them.
    #[must_use]
    pub fn unless(self, against: Option<Reason>) -> Self {
        match (self, against) {
            (Self::Valid(_), Some(reason)) => Self::Withdrawn(reason),
            (own, _) => own,
        }
    }

    /// What follows from both holds if both do. The first reason is the one that is kept.
    pub fn zip<U>(self, other: Bounds<U>) -> Bounds<(T, U)> {
        match (self, other) {
            (Self::Valid(mine), Bounds::Valid(theirs)) => Bounds::Valid((mine, theirs)),
            (Self::Withdrawn(reason), _) | (_, Bounds::Withdrawn(reason)) => {
                Bounds::Withdrawn(reason)
            }
        }
    }
}

/// A reason as documents have it: the words go with it wherever it is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Withdrawn(pub Reason);

impl Serialize for Withdrawn {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut object = serializer.serialize_struct("Withdrawn", 2)?;
        object.serialize_field("reason", &self.0)?;
        object.serialize_field("because", self.0.because())?;
        object.end()
    }
}

impl<T: Serialize> Serialize for Bounds<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut object = serializer.serialize_struct("Bounds", 2)?;
        object.serialize_field("bounds", &self.valid())?;
        object.serialize_field("withdrawn", &self.withdrawn().map(Withdrawn))?;
        object.end()
    }
}

/// The two fields as they are read. The words are passed over.
///
/// The bounds wait as a JSON value: serde buffers flattened fields, and where any crate of a program turns on
/// `arbitrary_precision` of `serde_json`, buffered numbers are numbers to nothing else.
#[derive(Deserialize)]
struct Document {
    bounds: Option<serde_json::Value>,
    withdrawn: Option<WithdrawnDocument>,
}

#[derive(Deserialize)]
struct WithdrawnDocument {
    reason: Reason,
}

impl<T: DeserializeOwned> TryFrom<Document> for Bounds<T> {
    type Error = String;

    fn try_from(found: Document) -> Result<Self, Self::Error> {
        match (found.bounds, found.withdrawn) {
            (Some(bounds), None) => serde_json::from_value(bounds)
                .map(Self::Valid)
                .map_err(|error| error.to_string()),
            (None, Some(withdrawn)) => Ok(Self::Withdrawn(withdrawn.reason)),
            _ => Err("bounds must be either there or withdrawn with a reason".to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
    struct Curve {
        value: f64,
        #[serde(flatten)]
        bounds: Bounds<f64>,
    }

    #[test]
    fn withdrawn_bounds_are_null_beside_their_reason() {
        let valid = Curve {
            value: 1.0,
            bounds: Bounds::Valid(0.5),
        };
        let withdrawn = Curve {
            bounds: Bounds::Withdrawn(Reason::ErrorsNotNoise),
            ..valid
        };
        for (curve, text) in [
            (valid, r#"{"value":1.0,"bounds":0.5,"withdrawn":null}"#),
            (
                withdrawn,
                r#"{"value":1.0,"bounds":null,"withdrawn":{"reason":"errors_not_noise","because":"the errors are not noise"}}"#,
            ),
        ] {
            assert_eq!(serde_json::to_string(&curve).unwrap(), text);
            assert_eq!(serde_json::from_str::<Curve>(text).unwrap(), curve);
        }
        for neither_nor in [
            r#"{"value":1.0}"#,
            r#"{"value":1.0,"bounds":1.0,"withdrawn":{"reason":"errors_not_noise"}}"#,
        ] {
            assert!(serde_json::from_str::<Curve>(neither_nor).is_err());
        }
    }
}
