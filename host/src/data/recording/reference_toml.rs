//! A reference in a recording's header.

use servoid_protocol::Reference;
use toml::{Table, Value};

/// A reference as a flat table: its kind, then its numbers by the names of their fields. Of a table of
/// steps only those that are held, each as `[offset_us, hold_frames]`.
pub fn as_toml(reference: &Reference) -> Table {
    let mut table = Table::new();
    table.insert("kind".into(), reference.name().into());
    let numbers = match reference {
        Reference::Staircase(staircase) => Value::try_from(staircase),
        Reference::Stairs(stairs) => Value::try_from(stairs),
        Reference::Prbs(prbs) => Value::try_from(prbs),
        Reference::Sweep(sweep) => Value::try_from(sweep),
        Reference::Multisine(multisine) => Value::try_from(multisine),
        Reference::Steps(steps) => {
            let held = steps.held().map(|step| {
                let numbers = [i64::from(step.offset_us), i64::from(step.hold_frames)];
                Value::Array(numbers.map(Value::Integer).to_vec())
            });
            let mut numbers = Table::new();
            numbers.insert("repeats".into(), i64::from(steps.repeats).into());
            numbers.insert("steps".into(), Value::Array(held.collect()));
            Ok(Value::Table(numbers))
        }
    };
    // Structs of whole numbers always have a form in TOML.
    if let Ok(Value::Table(numbers)) = numbers {
        table.extend(numbers);
    }
    table
}
