//! A weight on an arm turns with the output, whatever the commands are.

use super::{PERIOD_S, noisy, point, strokes, value};
use crate::data::Record;
use crate::servo_model::descent::coordinates::{ArmTurn, Coordinate, LoadKind, Terms};
use crate::servo_model::{QuantityKind, ServoModelOptions, fit, quantities};

/// Of a pulse: 10 us turn the servo by a degree.
const US_PER_DEGREE: f64 = 10.0;

#[test]
fn a_weight_is_found_where_commands_are_pulse_widths() {
    let terms = Terms {
        limit: true,
        load: LoadKind::TiltedPendulum,
        ..Terms::default()
    };
    let mut servo = point(terms, |at| match at {
        Coordinate::Gravity => 2.0,
        Coordinate::LnTopSpeed => 500f64.ln(),
        other => value(other),
    });
    servo.arm = ArmTurn::OfOutput(1f64.to_radians());
    let input: Vec<f64> = strokes(3000).iter().map(|level| 8.0 * level).collect();
    let output = noisy(&servo, &input, 5);
    let pulses: Vec<f64> = (input.iter())
        .map(|degrees| 1500.0 + US_PER_DEGREE * degrees)
        .collect();
    let record = Record::of_run(PERIOD_S, &pulses, &output).unwrap();
    let options = ServoModelOptions {
        radians_per_output: Some(1f64.to_radians()),
        ..ServoModelOptions::default()
    };
    let found = fit(&record, &options).unwrap();
    assert_eq!(
        found.terms.load,
        LoadKind::TiltedPendulum,
        "{:?}",
        found.fit
    );
    let mut all = quantities::values(&servo, 0.0).into_iter();
    let kind = QuantityKind::LoadOfLevelArm;
    let (_, truth) = all.find(|(name, _)| *name == kind.name()).unwrap();
    let quantity = found.quantity(kind).unwrap();
    let interval = quantity.interval.valid().unwrap();
    // A load that pulls to one side as an arm to the other one is the same arm, half a turn on.
    let found = interval.value.unwrap().signum();
    assert!(
        interval.contains(found * US_PER_DEGREE * truth),
        "{truth} {quantity:?}"
    );
}
