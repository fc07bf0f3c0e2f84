//! A Julia module.

use super::Export;
use super::text::Style;
use crate::presentation::template::fill;

const STYLE: Style = Style {
    comment: "# ",
    forbidden: &[],
    between: " ",
    broken: "",
    row: ("", ""),
};

/// Short vectors are literals.
const LITERAL: Style = Style {
    between: ", ",
    ..STYLE
};

/// The module.
pub(super) fn write(export: &Export<'_>) -> String {
    let mut values = export.values(&STYLE);
    values.extend([
        // A dollar would put the value of an expression in.
        ("name", export.quoted_name(&['"', '$'])),
        ("bounds_hold", export.model.bounds_hold().to_string()),
    ]);
    if let Ok(flight) = &export.low_order {
        let discrete = flight.transfer.discrete(export.model.timing());
        let literals = vec![
            ("denominator", LITERAL.short(&flight.transfer.denominator())),
            ("b", LITERAL.short(&discrete.b)),
            ("c", LITERAL.short(&discrete.c)),
            ("rest", LITERAL.short(&discrete.rest)),
        ];
        values.push((
            "low_order",
            export.low_order_part(include_str!("templates/low_order.jl"), &STYLE, literals),
        ));
    }
    fill(include_str!("templates/servo.jl"), &values)
}
