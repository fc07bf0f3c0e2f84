//! A Julia module.

use super::described_model::Export;
use super::scripts::Language;
use super::text::Style;

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

const LANGUAGE: Language = Language {
    style: STYLE,
    file: include_str!("templates/servo.jl"),
    low_order: include_str!("templates/low_order.jl"),
    bounds_of_parameters: include_str!("templates/bounds_of_parameters.jl"),
    bounds_of_step: include_str!("templates/bounds_of_step.jl"),
    bounds_of_frequency: include_str!("templates/bounds_of_frequency.jl"),
    bounds_of_low_order: include_str!("templates/bounds_of_low_order.jl"),
};

/// The module.
pub(super) fn write(export: &Export<'_>) -> String {
    let holds = export.model.bounds.valid().is_some();
    let values = vec![
        // A dollar would put the value of an expression in.
        ("name", export.quoted_name(&['"', '$'])),
        ("bounds_hold", holds.to_string()),
    ];
    let literals = match &export.low_order {
        Ok(flight) => {
            let discrete = flight.transfer.discrete(export.model.timing());
            vec![
                ("denominator", LITERAL.short(&flight.transfer.denominator())),
                ("b", LITERAL.short(&discrete.b)),
                ("c", LITERAL.short(&discrete.c)),
                ("rest", LITERAL.short(&discrete.rest)),
            ]
        }
        Err(_) => Vec::new(),
    };
    export.in_language(&LANGUAGE, values, literals)
}
