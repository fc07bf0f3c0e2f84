//! Model files of schema 1, as servoid 0.1 wrote them.
//!
//! They had bounds whether these held or not, and showed only by the names of their advice which of the two
//! it was. This is the one place that reads those names: a model whose bounds did not hold comes out
//! without any.

use serde_json::{Map, Value, json};

/// The schema that is read here.
pub(super) const SCHEMA: u32 = 1;

/// Advice that took the level from all bounds, and the reason by its name of today; the first one counts.
const WITHDRAWING: [(&str, &str); 3] = [
    ("excitation", "input_unexcited"),
    ("model_error", "errors_not_noise"),
    ("rounding", "quantisation_above_noise"),
];

/// Advice with which metrics were left out, and the reason by its name of today.
const WITHHOLDING: [(&str, &str); 2] = [
    ("untold", "input_unexcited"),
    ("metrics", "estimators_disagree"),
];

/// Fields of a step response that are bounds.
const STEP: [&str; 5] = [
    "sd",
    "pointwise",
    "simultaneous",
    "truncation_bias",
    "rounding_bias",
];

/// Fields of a frequency response that are bounds.
const FREQUENCY: [&str; 5] = [
    "magnitude_db_lower",
    "magnitude_db_upper",
    "phase_deg_lower",
    "phase_deg_upper",
    "bias",
];

/// Intervals of a model of low order.
const FLIGHT_MODEL: [&str; 5] = ["gain", "delay_s", "omega_rad_s", "damping", "lag_s"];

/// Makes a document of schema 2 of one of schema 1. One that is neither becomes nothing worse, and is refused
/// when it is read.
pub(super) fn upgrade(document: &mut Value) {
    let Value::Object(model) = document else {
        return;
    };
    let has = |check: &str| {
        let advice = model.get("advice").and_then(Value::as_array);
        advice
            .into_iter()
            .flatten()
            .any(|found| found.get("check").and_then(Value::as_str) == Some(check))
    };
    let first = |names: &[(&str, &str)]| {
        let found = names.iter().find(|(check, _)| has(check));
        found.map_or(Value::Null, |(_, reason)| (*reason).into())
    };
    let (reason, mut withheld) = (first(&WITHDRAWING), first(&WITHHOLDING));
    let linear = !has("linearity") && !has("model_error");
    let level = model
        .get("step")
        .and_then(|step| step.pointer("/pointwise/level"))
        .cloned()
        .unwrap_or_default();
    if withheld.is_null() && gain_may_be_zero(model) {
        withheld = "gain_may_be_zero".into();
    }
    if let Some(Value::Object(step)) = model.get_mut("step") {
        gather(step, &STEP, &level, &reason);
    }
    if let Some(Value::Object(frequency)) = model.get_mut("frequency") {
        gather(frequency, &FREQUENCY, &level, &reason);
    }
    if let Some(Value::Object(metrics)) = model.get_mut("metrics") {
        without_bounds(metrics.values_mut(), &reason);
        gather(metrics, &[], &level, &reason);
        metrics.insert("withheld".to_owned(), withheld);
    }
    if let Some(Value::Object(flight)) = model.get_mut("flight_model") {
        let intervals = flight
            .iter_mut()
            .filter(|(key, _)| FLIGHT_MODEL.contains(&key.as_str()))
            .map(|(_, interval)| interval);
        without_bounds(intervals, &reason);
        let level = flight.get("level").cloned().unwrap_or_default();
        gather(flight, &["covariance"], &level, &reason);
    }
    gather(model, &["covariance"], &level, &reason);
    model.insert("linear".to_owned(), linear.into());
    model.insert("schema".to_owned(), 2.into());
}

/// Whether the interval of the gain contains zero.
fn gain_may_be_zero(model: &Map<String, Value>) -> bool {
    let bound = |key: &str| model.get("metrics")?.get("dc_gain")?.get(key)?.as_f64();
    bound("value").is_some()
        && bound("lower").is_none_or(|lower| lower <= 0.0)
        && bound("upper").is_none_or(|upper| upper >= 0.0)
}

/// Moves the bounds among the fields of an object into one of their own, or takes them away.
fn gather(object: &mut Map<String, Value>, fields: &[&str], level: &Value, reason: &Value) {
    let mut bounds: Map<String, Value> = fields
        .iter()
        .filter_map(|field| object.remove_entry(*field))
        .collect();
    bounds.insert("level".to_owned(), level.clone());
    let (bounds, withdrawn) = match reason {
        Value::Null => (bounds.into(), Value::Null),
        reason => (Value::Null, json!({ "reason": reason })),
    };
    object.insert("bounds".to_owned(), bounds);
    object.insert("withdrawn".to_owned(), withdrawn);
}

/// Takes the bounds from intervals where there is a reason.
fn without_bounds<'a>(intervals: impl Iterator<Item = &'a mut Value>, reason: &Value) {
    for interval in intervals.filter(|_| !reason.is_null()) {
        if let Value::Object(interval) = interval {
            interval.insert("lower".to_owned(), Value::Null);
            interval.insert("upper".to_owned(), Value::Null);
        }
    }
}
