//! A servo model for tests of its words.

use servoid_identification::Record;
use servoid_identification::servo_model::{ServoModel, ServoModelOptions, fit};

/// Of a servo of 30 a second at the most.
pub(crate) fn limited_record() -> Record<'static> {
    let levels = [0.0, 5.0, -3.0, 1.0];
    let input: Vec<f64> = (0..900).map(|k| levels[k / 60 % 4]).collect();
    let follow = |y: &mut f64, u: &f64| {
        *y += (0.2 * (u - *y)).clamp(-0.3, 0.3);
        Some(*y)
    };
    let output: Vec<f64> = input.iter().scan(0.0, follow).collect();
    Record::of_run(0.01, input, output).unwrap()
}

/// That of this servo.
pub(crate) fn limited_servo() -> ServoModel {
    fit(&limited_record(), &ServoModelOptions::default()).unwrap()
}
