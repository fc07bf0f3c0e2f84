//! What kind of servo it is: linear, limited, or neither.

use servoid_identification::results::{Advice, Bounds, Model, Reason};
use servoid_identification::servo_model::{LinearKind, Quantity, QuantityKind, ServoModel};
use servoid_identification::thresholds::SERVO_MATERIAL_ADVANTAGE;

/// What kind of servo it is, without figures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum KindOfServo {
    Linear,
    MuchLikeLinear,
    /// To the model as a machine alone.
    LinearAsMachine,
    /// But for a stop.
    LinearToStop,
    /// By so little that nobody need care.
    NotQuiteLinear,
    /// Without a term that shows how.
    NotLinearUnshown,
    NotLinear,
    LimitedInSpeed,
    LimitedInDrive,
}

impl KindOfServo {
    /// One that the `linear` model shows not to be linear is not called so for want of a term.
    pub(super) fn of(model: &ServoModel, linear: &Model) -> Self {
        let is_said = linear.advice.iter().any(Advice::is_of_linearity);
        let shown_not_linear = !linear.linear || is_said;
        // Errors under a reference that does not excite all of the response may be those of what was left out.
        let is_open = !is_said && linear.bounds.withdrawn() == Some(Reason::InputUnexcited);
        let nearly = is_nearly_linear(model);
        match model.covariance {
            Bounds::Withdrawn(_) if nearly && shown_not_linear => Self::NotQuiteLinear,
            Bounds::Withdrawn(_) if nearly => Self::MuchLikeLinear,
            _ if model.terms.speed_limit && shows_limit(model) => Self::LimitedInSpeed,
            _ if model.terms.limit && shows_limit(model) => Self::LimitedInDrive,
            Bounds::Withdrawn(_) if model.is_linear() && !model.stops.are_none() => {
                Self::LinearToStop
            }
            Bounds::Withdrawn(_) if is_open && model.is_linear() => Self::LinearAsMachine,
            Bounds::Withdrawn(_) if shown_not_linear && model.is_linear() => Self::NotLinearUnshown,
            Bounds::Withdrawn(_) if shown_not_linear => Self::NotLinear,
            // Terms of the drive stand for what a linear servo of higher order has, too.
            _ if model.terms.is_limited() && !shown_not_linear && linear_is_as_good(model) => {
                Self::MuchLikeLinear
            }
            // Friction comes with a limit that the record may not reach.
            _ if model.terms.is_limited() => Self::NotLinear,
            Bounds::Valid(_) if shown_not_linear => Self::LinearAsMachine,
            Bounds::Valid(_) => Self::Linear,
            Bounds::Withdrawn(_) => Self::MuchLikeLinear,
        }
    }

    pub(super) fn is_linear(self) -> bool {
        matches!(
            self,
            Self::Linear | Self::MuchLikeLinear | Self::LinearAsMachine
        )
    }

    /// What the servo does.
    pub(super) fn in_words(self) -> &'static str {
        match self {
            Self::Linear => "is linear",
            Self::MuchLikeLinear => "is much like a linear one",
            Self::LinearAsMachine => "is as a linear one to a model of it as a machine",
            Self::LinearToStop => "is much like a linear one until it is stopped",
            Self::NotQuiteLinear => "is not quite linear",
            Self::NotLinearUnshown => {
                "is not linear, in a way that no term of a model of it as a machine shows,"
            }
            Self::NotLinear => "is not linear",
            Self::LimitedInSpeed => "is limited in its speed",
            Self::LimitedInDrive => "is limited in its drive",
        }
    }
}

/// Whether the linear model beside it predicts unseen parts as well, by what terms must take away to be taken.
pub(super) fn linear_is_as_good(model: &ServoModel) -> bool {
    let left = |percent: f64| (100.0 - percent).powi(2);
    let linear = model.linear_models.as_ref();
    let percents = linear.and_then(|found| {
        Some((
            found.percent_of(LinearKind::Linear)?,
            found.servo_model_percent,
        ))
    });
    percents.is_some_and(|(linear, servo)| {
        left(servo) >= (1.0 - SERVO_MATERIAL_ADVANTAGE) * left(linear)
    })
}

/// Whether a linear servo of second order predicts all but a thousandth of parts not seen. Where the noise is as small, what terms take away beyond chance
/// is of no use to anybody, and may be that of a program that made the recording.
pub(super) fn is_nearly_linear(model: &ServoModel) -> bool {
    model.fit.linear_held_out_percent > NEARLY_ALL_PERCENT
}

const NEARLY_ALL_PERCENT: f64 = 99.9;

/// Whether the record determines anything that a limit of the drive brings about; without intervals, a top speed: what a drive does at the beginning of a stroke, other terms do as well.
pub(crate) fn shows_limit(model: &ServoModel) -> bool {
    let shown_by: &[QuantityKind] = match model.covariance {
        Bounds::Withdrawn(_) => &[
            QuantityKind::TopSpeedUpwards,
            QuantityKind::TopSpeedDownwards,
        ],
        Bounds::Valid(_) => QuantityKind::OF_LIMIT,
    };
    let determined = model.quantities.iter().filter(|found| found.determined);
    let mut kinds = determined.filter_map(Quantity::kind);
    kinds.any(|kind| shown_by.contains(&kind))
}
