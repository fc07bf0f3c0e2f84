//! A Python module.

use super::Export;
use super::text::Style;
use crate::presentation::template::fill;

const STYLE: Style = Style {
    comment: "# ",
    forbidden: &[],
    between: ", ",
    broken: "",
    row: ("[", "],"),
};

/// The module.
pub(super) fn write(export: &Export<'_>) -> String {
    let mut values = export.values(&STYLE);
    let holds = export.model.bounds_hold();
    values.extend([
        ("name", export.quoted_name(&['"'])),
        (
            "bounds_hold",
            if holds { "True" } else { "False" }.to_owned(),
        ),
        (
            "low_order",
            export.low_order_part(include_str!("templates/low_order.py"), &STYLE, Vec::new()),
        ),
    ]);
    fill(include_str!("templates/servo.py"), &values)
}
