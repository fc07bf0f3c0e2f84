//! A servo whose recording shows no limit of its speed: a file of it has none.

use crate::data::units::Units;
use crate::presentation::summary::recorded;
use servoid_identification::servo_model::{CommandRange, ReachedSpeeds};

/// That a file has no limit of the speed, a sentence without its stop.
pub(super) fn no_limit(
    commands: Option<CommandRange>,
    reached: Option<ReachedSpeeds>,
    units: Units<'_>,
) -> String {
    let unit = units.output.unwrap_or("units of the position");
    let up_to = (reached.and_then(|reached| recorded::speeds_in_words(reached, 1.0, unit)))
        .map(|speeds| format!(" up to {speeds}"));
    let under =
        commands.map(|range| format!(" (commands {})", recorded::range_in_words(range, units)));
    format!(
        "no limit of the speed was seen{}{} (strokes of one size, and those that end before the servo reaches it, show none): this file has none, and a servo has one",
        up_to.unwrap_or_default(),
        under.unwrap_or_default()
    )
}
