//! Which of two servos is slower.

use crate::presentation::summary::wording::numbers::digits;
use servoid_identification::comparison::ServoModelComparison;
use servoid_identification::servo_model::QuantityKind;

/// Which servo is slower for sure, in both directions, and what makes one so.
pub(super) fn slower(a: &str, b: &str, found: &ServoModelComparison) -> Option<String> {
    let differences = &found.bounds.valid()?.differences;
    let top_speeds = |kind: QuantityKind| {
        let mut pairs = found.quantities.iter().zip(differences);
        let (pair, difference) = pairs.find(|(pair, _)| pair.kind() == Some(kind))?;
        pair.a.zip(pair.b).filter(|_| difference.is_sure())
    };
    let up = top_speeds(QuantityKind::TopSpeedUpwards)?;
    let down = top_speeds(QuantityKind::TopSpeedDownwards)?;
    let (slow, quick) = match (up.1 < up.0, down.1 < down.0) {
        (true, true) => (b, a),
        (false, false) => (a, b),
        // A load does that to one servo.
        _ => return None,
    };
    let [up, down] = [up, down].map(|(of_a, of_b)| {
        let part = of_a.min(of_b) / of_a.max(of_b);
        digits(100.0 * (1.0 - part), 2)
    });
    let by = match up == down {
        true => format!("{up} %"),
        false => format!("{up} % upwards and {down} % downwards"),
    };
    Some(format!(
        "{slow} is slower than {quick} at top speed, by {by}: a lower supply, more load or friction, or a worn motor makes a servo so."
    ))
}
