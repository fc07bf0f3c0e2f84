//! What a linear model of the same recording makes of a servo model.

use super::kind_of_servo::{KindOfServo, is_nearly_linear, linear_is_as_good};
use super::measured_limits::measured_limits;
use super::top_speeds::{is_never_reached, top_speeds};
use servoid_identification::results::{Advice, Model, Reason};
use servoid_identification::servo_model::ServoModel;

/// What a linear model beside a servo model that has more than a linear servo, and no intervals, makes of what that one says.
pub(super) enum LinearBeside {
    /// The errors of the linear model are noise, and those of the servo model are not.
    Alone,
    /// The errors of the linear model are noise, and it predicts as well.
    AsGood,
    /// Nothing speaks against the linear model, which has no bounds but predicts as well.
    WithoutBounds,
    /// The same of strokes between two levels, whose answers a linear model learns by heart, whatever the servo does in others.
    HiddenByLevels,
    /// The command has noise that the servo may not have been sent: errors of any model follow the motion then.
    HiddenByCommand,
}

impl LinearBeside {
    /// `None` where the servo model is the one to speak of. Of a response in a band the linear model is a picture, which predicts little; the errors
    /// are those of the band.
    pub(super) fn of(model: &ServoModel, linear: &Model) -> Option<Self> {
        let is_settled = model.is_linear() || model.covariance.valid().is_some();
        let is_limited = measured_limits(model).iter().any(Option::is_some);
        if is_settled || is_limited {
            return None;
        }
        let has_noise = linear.advice.iter().any(Advice::is_of_command_noise);
        if has_noise && lacks_something(model) {
            return Some(Self::HiddenByCommand);
        }
        if !linear.linear {
            return None;
        }
        let (lacks, as_good) = (lacks_something(model), linear_is_as_good(model));
        if as_good && model.covariance.withdrawn() == Some(Reason::FewLevels) {
            return Some(Self::HiddenByLevels);
        }
        match linear.bounds.valid() {
            Some(_) if as_good && lacks => Some(Self::Alone),
            Some(_) if as_good => Some(Self::AsGood),
            None if linear.band().is_some() && lacks => Some(Self::Alone),
            None if as_good => Some(Self::WithoutBounds),
            _ => None,
        }
    }

    /// A sentence.
    pub(super) fn in_words(&self) -> &'static str {
        match self {
            Self::Alone => {
                "A linear servo describes this recording down to its noise, and a model of it as a machine does not."
            }
            Self::AsGood => {
                "A linear servo describes this recording down to its noise, as well as a model of it as a machine."
            }
            Self::WithoutBounds => {
                "A linear servo describes this recording as well as a model of it as a machine."
            }
            Self::HiddenByLevels => {
                "Strokes between two levels do not show whether this servo is linear: a linear one describes this recording as well as a model of it as a machine."
            }
            Self::HiddenByCommand => {
                "What looks like noise in the column of the command hides whether this servo is linear."
            }
        }
    }
}

/// Whether the servo is called linear: by its linear model, and by what is said of it as a machine where that is to be relied on.
#[must_use]
pub fn is_called_linear(linear: &Model, servo: Option<&ServoModel>) -> bool {
    let speaks =
        servo.filter(|servo| servo.predicts() && LinearBeside::of(servo, linear).is_none());
    linear.linear && speaks.is_none_or(|servo| is_said_linear(servo, linear))
}

/// Whether the sentence on the servo as a machine calls it linear, or much like that. Of a top speed that was never reached the recording has nothing.
fn is_said_linear(model: &ServoModel, linear: &Model) -> bool {
    let is_limited = measured_limits(model).iter().any(Option::is_some);
    let lacks_a_stop = model.covariance.valid().is_none() && may_lack_a_stop(model);
    match top_speeds(model) {
        _ if is_limited || lacks_a_stop => false,
        Some(speeds) => is_never_reached(model, &speeds) && linear_is_as_good(model),
        None => KindOfServo::of(model, linear).is_linear(),
    }
}

/// Whether its errors show that the model lacks something of the servo, or would if the steps of the sensor were smaller.
fn lacks_something(model: &ServoModel) -> bool {
    matches!(
        model.covariance.withdrawn(),
        Some(Reason::ErrorsNotNoise | Reason::QuantisationAboveNoise)
    )
}

pub(super) fn may_lack_a_stop(model: &ServoModel) -> bool {
    lacks_something(model) && model.terms.is_limited() && !is_nearly_linear(model)
}
