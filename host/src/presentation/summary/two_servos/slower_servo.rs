//! Which of two servos is slower.

use crate::presentation::summary::wording::numbers::digits;
use servoid_identification::comparison::{QuantityPair, ServoModelComparison};
use servoid_identification::servo_model::QuantityKind;

/// Which servo is slower for sure, in one direction or in both, and what makes one so.
pub(super) fn slower(a: &str, b: &str, found: &ServoModelComparison) -> Option<String> {
    let differences = &found.bounds.valid()?.differences;
    let top_speeds = |kind: QuantityKind| {
        let mut pairs = found.quantities.iter().zip(differences);
        let (pair, difference) = pairs.find(|(pair, _)| pair.kind() == Some(kind))?;
        pair.a.zip(pair.b).filter(|_| difference.is_sure())
    };
    let up = top_speeds(QuantityKind::TopSpeedUpwards);
    let down = top_speeds(QuantityKind::TopSpeedDownwards);
    // A load that one has may be what slows it in one direction.
    let is_loaded = |pair: &QuantityPair| {
        pair.kind() == Some(QuantityKind::LoadAtMiddle) && (pair.a.is_some() || pair.b.is_some())
    };
    if (up.is_none() || down.is_none()) && found.quantities.iter().any(is_loaded) {
        return None;
    }
    let is_second = |(of_a, of_b): (f64, f64)| of_b < of_a;
    let (slow, quick) = match (up.map(is_second), down.map(is_second)) {
        // A load does that to one servo.
        (Some(up), Some(down)) if up != down => return None,
        (Some(true), _) | (None, Some(true)) => (b, a),
        (Some(false), _) | (None, Some(false)) => (a, b),
        (None, None) => return None,
    };
    let [up, down] = [up, down].map(|of_both| {
        let (of_a, of_b) = of_both?;
        let part = of_a.min(of_b) / of_a.max(of_b);
        Some(digits(100.0 * (1.0 - part), 2))
    });
    let by = match (up, down) {
        (Some(up), Some(down)) if up == down => format!("{up} %"),
        (Some(up), Some(down)) => format!("{up} % upwards and {down} % downwards"),
        (Some(up), None) => format!("{up} % upwards (no difference downwards is sure)"),
        (None, Some(down)) => format!("{down} % downwards (no difference upwards is sure)"),
        (None, None) => return None,
    };
    Some(format!(
        "{slow} is slower than {quick} at top speed, by {by}: a lower supply, more load or friction, or a worn motor makes a servo so."
    ))
}
