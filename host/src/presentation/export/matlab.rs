//! A MATLAB script, which Octave runs too.

use super::described_model::Export;
use super::scripts::Language;
use super::text::{Style, plain};
use servoid_identification::results::Bounds;

const LANGUAGE: Language = Language {
    style: Style {
        comment: "% ",
        forbidden: &[],
        between: ", ",
        broken: " ...",
        row: ("", ""),
    },
    file: include_str!("templates/servo.m"),
    low_order: include_str!("templates/low_order.m"),
    bounds_of_parameters: include_str!("templates/bounds_of_parameters.m"),
    bounds_of_step: include_str!("templates/bounds_of_step.m"),
    bounds_of_frequency: include_str!("templates/bounds_of_frequency.m"),
    bounds_of_low_order: include_str!("templates/bounds_of_low_order.m"),
};

/// The script.
pub(super) fn write(export: &Export<'_>) -> String {
    let (holds, warning) = match export.model.bounds {
        Bounds::Valid(_) => ("true", ""),
        Bounds::Withdrawn(_) => (
            "false",
            "warning('servoid:bounds', 'No bounds can be given for this model: see the comments.');\n",
        ),
    };
    let values = vec![
        ("name", plain(export.name).replace('\'', "''")),
        ("bounds_hold", holds.to_owned()),
        ("warning", warning.to_owned()),
    ];
    export.in_language(&LANGUAGE, values, Vec::new())
}
