//! A Python module.

use super::described_model::Export;
use super::scripts::Language;
use super::text::Style;
use servoid_identification::results::Bounds;

const LANGUAGE: Language = Language {
    style: Style {
        comment: "# ",
        forbidden: &[],
        between: ", ",
        broken: "",
        row: ("[", "],"),
    },
    file: include_str!("templates/servo.py"),
    low_order: include_str!("templates/low_order.py"),
    bounds_of_parameters: include_str!("templates/bounds_of_parameters.py"),
    bounds_of_step: include_str!("templates/bounds_of_step.py"),
    bounds_of_frequency: include_str!("templates/bounds_of_frequency.py"),
    bounds_of_low_order: include_str!("templates/bounds_of_low_order.py"),
};

/// The module.
pub(super) fn write(export: &Export<'_>) -> String {
    let holds = match export.model.bounds {
        Bounds::Valid(_) => "True",
        Bounds::Withdrawn(_) => "False",
    };
    let values = vec![
        ("name", export.quoted_name(&['"'])),
        ("bounds_hold", holds.to_owned()),
    ];
    export.in_language(&LANGUAGE, values, Vec::new())
}
