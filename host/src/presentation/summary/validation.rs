//! How well a model predicts another recording.

use super::wording::numbers::{decimals, number_with_unit};
use servoid_identification::results::Validation;

/// How well a model predicted a recording that it was not identified from; `own_fits` are the fits of the linear and the servo model to
/// the recording that they come from \[%\], which identification prints.
#[must_use]
pub fn of_validation(
    linear: Option<&Validation>,
    servo_model: Option<&Validation>,
    own_fits: (f64, Option<f64>),
    unit: Option<&str>,
) -> String {
    let (own, own_of_servo) = own_fits;
    let line = |found| validation_line(found, unit);
    let own_of_servo = own_of_servo.filter(|_| servo_model.is_some());
    let own = match (linear, own_of_servo) {
        (Some(_), Some(of_servo)) => format!("{of_servo:.2} % (servo model) and {own:.2} %"),
        (None, Some(of_servo)) => format!("{of_servo:.2} %"),
        (_, None) => format!("{own:.2} %"),
    };
    let text = match (linear.map(line), servo_model.map(line)) {
        (Some(linear), None) => linear,
        (linear, servo) => {
            let named = |name: &str, line: String| format!("{name:<13} {line}");
            let servo = servo.map(|line| named("servo model:", line));
            let linear = linear.map(|line| named("linear model:", line));
            servo.into_iter().chain(linear).collect()
        }
    };
    format!("{text}the fit of the recording that the model comes from is {own}\n")
}

fn validation_line(validation: &Validation, unit: Option<&str>) -> String {
    let digits = decimals(validation.rmse, 2);
    let error = number_with_unit(validation.rmse, digits, unit);
    let sign = if validation.bias.is_sign_negative() {
        ""
    } else {
        "+"
    };
    let bias = number_with_unit(validation.bias, digits, unit);
    let from_rest = match validation.runs_from_rest {
        0 => "",
        _ => ", the first ones too, because the runs appear to begin at rest",
    };
    format!(
        "fit {:.2} %, error {error} rms, bias {sign}{bias}, {} samples{from_rest}\n",
        validation.fit_percent, validation.samples_used
    )
}
