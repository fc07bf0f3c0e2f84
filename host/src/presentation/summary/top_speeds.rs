//! The top speeds that a recording determines, and whether the servo reached them.

use servoid_identification::servo_model::{Quantity, QuantityKind, ServoModel};

/// The quantity of this kind, where the record determines it.
pub(super) fn determined(model: &ServoModel, kind: QuantityKind) -> Option<&Quantity> {
    model.quantity(kind).filter(|found| found.determined)
}

/// Upwards and downwards, where the record determines both.
pub(super) fn top_speeds(model: &ServoModel) -> Option<[&Quantity; 2]> {
    let [up, down] = [
        QuantityKind::TopSpeedUpwards,
        QuantityKind::TopSpeedDownwards,
    ]
    .map(|kind| determined(model, kind));
    Some([up?, down?])
}

/// A servo above this part of its top speed is at it: it comes near without end, and means over 20 ms are some percent below their peak.
const AT_TOP_SPEED: f64 = 0.9;

/// Whether the servo stayed below its top speeds in all of the recording.
pub(super) fn is_never_reached(model: &ServoModel, speeds: &[&Quantity; 2]) -> bool {
    let below = |reached: f64, top: &Quantity| reached < AT_TOP_SPEED * top.value;
    let [up, down] = speeds;
    (model.reached)
        .is_some_and(|reached| below(reached.upwards, up) && below(reached.downwards, down))
}

/// Whether the model has top speeds that the servo stayed below in all of the recording, so that they are extrapolated.
pub(super) fn has_unreached_top_speeds(model: &ServoModel) -> bool {
    top_speeds(model).is_some_and(|speeds| is_never_reached(model, &speeds))
}
