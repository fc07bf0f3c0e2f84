//! The top speeds that a recording determines, and whether the servo reached them.

use crate::data::units::Units;
use crate::presentation::summary::wording::speed_words::reached_speed;
use servoid_identification::servo_model::{Quantity, QuantityKind, ServoModel};

/// The quantity of this kind, where the record determines it.
pub(crate) fn determined(model: &ServoModel, kind: QuantityKind) -> Option<&Quantity> {
    model.quantity(kind).filter(|found| found.determined)
}

/// Upwards and downwards, where the record determines both.
pub(crate) fn top_speeds(model: &ServoModel) -> Option<[&Quantity; 2]> {
    let [up, down] = [
        QuantityKind::TopSpeedUpwards,
        QuantityKind::TopSpeedDownwards,
    ]
    .map(|kind| determined(model, kind));
    Some([up?, down?])
}

/// Whether the servo stayed below its top speeds in all of the recording.
pub(crate) fn is_never_reached(model: &ServoModel, speeds: &[&Quantity; 2]) -> bool {
    speeds.iter().all(|speed| model.stayed_below(speed))
}

/// That one of the top speeds was not reached, where the other was: a sentence.
pub(crate) fn one_unreached(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let reached = model.reached?;
    let of_each = top_speeds(model)?.map(|speed| model.stayed_below(speed));
    let (which, reached) = match of_each {
        [true, false] => ("upwards", reached.upwards),
        [false, true] => ("downwards", reached.downwards),
        _ => return None,
    };
    let moved = (reached > 0.0).then(|| {
        let (figure, unit) = (reached_speed(reached).1, units.output.unwrap_or("units"));
        format!(", in which the servo moved at more than {figure} {unit}/s {which}")
    });
    Some(format!(
        "That the top speed {which} was reached is not shown by this recording{}: it may be extrapolated.",
        moved.unwrap_or_default()
    ))
}

/// Whether the model has top speeds that the servo stayed below in all of the recording, so that they are extrapolated.
pub(crate) fn has_unreached_top_speeds(model: &ServoModel) -> bool {
    top_speeds(model).is_some_and(|speeds| is_never_reached(model, &speeds))
}
