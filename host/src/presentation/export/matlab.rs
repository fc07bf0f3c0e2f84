//! A MATLAB script, which Octave runs too.

use super::Export;
use super::text::{Style, plain};
use crate::presentation::template::fill;

const STYLE: Style = Style {
    comment: "% ",
    forbidden: &[],
    between: ", ",
    broken: " ...",
    row: ("", ""),
};

/// The script.
pub(super) fn write(export: &Export<'_>) -> String {
    let mut values = export.values(&STYLE);
    let holds = export.model.bounds_hold();
    let warning = if holds {
        ""
    } else {
        "warning('servoid:bounds', 'No bounds can be given for this model: see the comments.');\n"
    };
    values.extend([
        ("name", plain(export.name).replace('\'', "''")),
        ("bounds_hold", holds.to_string()),
        ("warning", warning.to_owned()),
        (
            "low_order",
            export.low_order_part(include_str!("templates/low_order.m"), &STYLE, Vec::new()),
        ),
    ]);
    fill(include_str!("templates/servo.m"), &values)
}
