//! The speeds that no larger stroke of a recording exceeded, beside the top speeds of a model whose figures may be off.
//!
//! A model that lacks something of the servo has it in other terms, and its top speeds may be off by a tenth. What the strokes show by
//! themselves is the limit of the servo, whatever it comes from.

use super::numbers::digits;
use super::sixty_degrees::seconds_per_60_degrees;
use crate::data::units::Units;
use servoid_identification::servo_model::{QuantityKind, ServoModel};

/// The limit that the strokes of the recording show for this top speed, where the model has no interval of it.
pub(super) fn measured_limit(model: &ServoModel, kind: Option<QuantityKind>) -> Option<f64> {
    let limits = model.speed_limits;
    let found = match kind? {
        QuantityKind::TopSpeedUpwards => limits.upwards,
        QuantityKind::TopSpeedDownwards => limits.downwards,
        _ => None,
    };
    found.filter(|_| model.covariance.valid().is_none())
}

/// Both of them, upwards first.
pub(super) fn measured_limits(model: &ServoModel) -> [Option<f64>; 2] {
    [
        QuantityKind::TopSpeedUpwards,
        QuantityKind::TopSpeedDownwards,
    ]
    .map(|kind| measured_limit(model, Some(kind)))
}

/// "498 deg/s (0.120 s/60°) upwards and 501 deg/s (0.120 s/60°) downwards", of the limits that the recording shows.
pub(super) fn limits_in_words(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let unit = units.output.unwrap_or("units");
    let of = |limit: f64| {
        let seconds = seconds_per_60_degrees(limit, units);
        let seconds = seconds.map_or_else(String::new, |seconds| format!(" ({seconds})"));
        format!("{} {unit}/s{seconds}", digits(limit, 3))
    };
    match measured_limits(model).map(|limit| limit.map(of)) {
        [Some(up), Some(down)] if up == down => Some(up),
        [Some(up), Some(down)] => Some(format!("{up} upwards and {down} downwards")),
        [Some(up), None] => Some(format!("{up} upwards")),
        [None, Some(down)] => Some(format!("{down} downwards")),
        [None, None] => None,
    }
}

/// What a data sheet is held against where the model has top speeds beside the limits that the recording shows: a sentence.
pub(super) fn against_the_model(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let limits = limits_in_words(model, units)?;
    model.terms.limit.then(|| {
        format!(
            "Larger strokes were no faster than {limits} in this recording: that is the limit of this servo, and what a data sheet is held against. The \
             top speed of the model has no interval, and stands for what the model lacks, too."
        )
    })
}
