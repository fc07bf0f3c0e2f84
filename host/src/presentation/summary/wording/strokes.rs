//! The strokes that times hold for, where a recording has strokes of one size.

use crate::data::model_metadata::ModelMetadata;
use servoid_identification::results::{Model, six_digits};

/// " of 10 deg, the size that was recorded,": a servo that is limited in speed or torque answers steps of other sizes differently, and nothing
/// in such a recording shows whether this one is.
pub(crate) fn which_step(of: &ModelMetadata) -> String {
    stroke_in_words(of).map_or_else(String::new, |stroke| {
        format!(" of {stroke}, the size that was recorded,")
    })
}

/// That bounds are those of strokes of one size, where nothing else is found: a limit of the speed makes such strokes slower, and these alone pass
/// for those of a linear servo.
pub(crate) fn of_one_size(model: &Model, of: &ModelMetadata) -> Option<String> {
    let stroke = stroke_in_words(of)?;
    (model.linear && model.bounds.valid().is_some()).then(|| {
        format!(
            "of {stroke}, for which the bounds hold, those of bandwidth and phase among them: whether the servo is linear, and follows sines so, steps of several sizes show, such as random levels"
        )
    })
}

/// "10 deg", the size of all strokes, where they have one.
pub(crate) fn stroke_in_words(of: &ModelMetadata) -> Option<String> {
    let size = of.only_stroke?;
    let unit = of.units().input.map(|unit| format!(" {unit}"));
    Some(format!(
        "{}{}",
        rounded_to_three(size),
        unit.unwrap_or_default()
    ))
}

/// 10 rather than 10.00.
fn rounded_to_three(size: f64) -> f64 {
    let power = 10f64.powf(2.0 - size.log10().floor());
    six_digits((size * power).round() / power)
}
