//! The scales of the sensors of two sides: how far they may be off from each other.

use crate::data::model_metadata::ModelMetadata;
use crate::presentation::summary::percent;
use servoid_identification::results::{Advice, Check, pointwise_critical};

/// Standard deviation of the ratio of both scales, 0.05 for 5 %. Zero where one sensor recorded both, whose error is the same in both.
pub fn ratio_sd(sides: [&ModelMetadata; 2]) -> f64 {
    let [a, b] = sides.map(|side| side.scale_sd_percent / 100.0);
    match of_one_sensor(sides) {
        true => 0.0,
        false => a.hypot(b),
    }
}

/// Whether both were recorded by one board with one calibration. A sensor that was changed without a word in the rig file is not seen.
fn of_one_sensor([a, b]: [&ModelMetadata; 2]) -> bool {
    a.board_id.is_some()
        && a.board_id == b.board_id
        && a.degrees_per_count.is_some()
        && a.degrees_per_count == b.degrees_per_count
        && a.scale_sd_percent == b.scale_sd_percent
}

/// That the outputs of the sides are known to each other within the errors of their scales only, at this level.
pub(crate) fn advice(sides: [&ModelMetadata; 2], level: f64) -> Option<Advice> {
    let apart_percent = 100.0 * pointwise_critical(level) * ratio_sd(sides);
    if apart_percent == 0.0 {
        return None;
    }
    let [a, b] = sides;
    let reason = match a.board_id.as_ref().zip(b.board_id.as_ref()) {
        Some((a, b)) if a == b => "each side has a calibration of its own",
        _ => "they were recorded by different boards, or by some that do not state their number",
    };
    Some(Advice::new(
        Check::Calibration,
        format!(
            "The scales of the two sides may be off from each other by ±{apart_percent:.1} % ({} % confidence), because {reason}. Bounds of the differences of step responses, gains and speeds contain that; the test of chance by the scatter of runs does not.",
            percent(level)
        ),
        apart_percent,
        0.0,
        "One board, sensor and rig file for both sides err alike, and need no such bound; else calibrate with more angles, and wider ones.",
    ))
}
