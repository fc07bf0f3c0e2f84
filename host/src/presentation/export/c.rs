//! A C99 header.

use super::described_model::Export;
use super::scripts::Language;
use super::text::{Style, identifier, number};

const LANGUAGE: Language = Language {
    style: Style {
        comment: " * ",
        forbidden: &[("*/", "* /"), ("/*", "/ *")],
        between: ", ",
        broken: "",
        row: ("{", "},"),
    },
    file: include_str!("templates/servo.h"),
    low_order: include_str!("templates/low_order.h"),
    bounds_of_parameters: include_str!("templates/bounds_of_parameters.h"),
    bounds_of_step: include_str!("templates/bounds_of_step.h"),
    bounds_of_frequency: "",
    bounds_of_low_order: include_str!("templates/bounds_of_low_order.h"),
};

/// The header.
pub(super) fn write(export: &Export<'_>) -> String {
    let holds = u8::from(export.model.bounds.valid().is_some());
    let values = vec![
        // A question mark could begin a trigraph.
        ("name", export.quoted_name(&['"', '?'])),
        ("bounds_hold", holds.to_string()),
        ("theta_count", export.model.theta.len().to_string()),
    ];
    export.in_language(&LANGUAGE, values, vec![("parameters", parameters(export))])
}

/// The parameters that not every order has.
fn parameters(export: &Export<'_>) -> String {
    let Ok(flight) = &export.low_order else {
        return String::new();
    };
    let transfer = &flight.transfer;
    let oscillator = transfer.oscillator;
    [
        ("OMEGA_RAD_S", oscillator.map(|o| o.omega_rad_s)),
        ("DAMPING", oscillator.map(|o| o.damping)),
        ("LAG_S", transfer.lag_s),
    ]
    .into_iter()
    .filter_map(|(name, value)| Some((name, value?)))
    .map(|(name, value)| {
        let id = identifier(export.name).to_ascii_uppercase();
        format!("#define {id}_{name} {}\n", number(value))
    })
    .collect()
}
