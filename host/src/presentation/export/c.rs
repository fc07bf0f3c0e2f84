//! A C99 header.

use super::Export;
use super::text::{Style, number};
use crate::presentation::template::fill;

const STYLE: Style = Style {
    comment: " * ",
    forbidden: &[("*/", "* /"), ("/*", "/ *")],
    between: ", ",
    broken: "",
    row: ("{", "},"),
};

/// The header.
pub(super) fn write(export: &Export<'_>) -> String {
    let mut values = export.values(&STYLE);
    let count = export.model.theta.len();
    values.extend([
        // A question mark could begin a trigraph.
        ("name", export.quoted_name(&['"', '?'])),
        (
            "bounds_hold",
            u8::from(export.model.bounds_hold()).to_string(),
        ),
        ("theta_count", count.to_string()),
        (
            "theta_bytes",
            (size_of::<f64>() * count * (count + 1)).to_string(),
        ),
    ]);
    let parameters = vec![("parameters", parameters(export))];
    values.push((
        "low_order",
        export.low_order_part(include_str!("templates/low_order.h"), &STYLE, parameters),
    ));
    fill(include_str!("templates/servo.h"), &values)
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
        let id = super::identifier(export.name).to_ascii_uppercase();
        format!("#define {id}_{name} {}\n", number(value))
    })
    .collect()
}
