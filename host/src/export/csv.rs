//! A table for anything that reads one: step and frequency response side by side, with bounds.

use super::Export;
use super::statement::parameters_of;
use super::text::{Style, number};

const STYLE: Style = Style {
    comment: "# ",
    forbidden: &[],
    between: ", ",
    broken: "",
    row: ("[", "]"),
};

/// The table. Lines that begin with # tell about it; a column that is shorter than others ends in
/// empty cells.
pub(super) fn write(export: &Export<'_>) -> String {
    let (step, frequency) = (&export.model.step, &export.model.frequency);
    let model = export.model;
    let times: Vec<f64> = (0..step.value.len())
        .map(|m| model.timing().seconds(m as f64))
        .collect();
    let impulse = model.impulse_response();
    let variances = model
        .covariance
        .iter()
        .zip(0..)
        .filter_map(|(row, k): (_, usize)| row.get(k));
    let theta_sd: Vec<f64> = variances.map(|v| v.max(0.0).sqrt()).collect();
    let columns: [(&str, &[f64]); 20] = [
        ("time_s", &times),
        ("step", &step.value),
        ("step_sd", &step.sd),
        ("step_lower", &step.pointwise.lower),
        ("step_upper", &step.pointwise.upper),
        ("step_lower_simultaneous", &step.simultaneous.lower),
        ("step_upper_simultaneous", &step.simultaneous.upper),
        ("impulse", &impulse),
        ("omega_rad_s", &frequency.omega_rad_s),
        ("re", &frequency.re),
        ("im", &frequency.im),
        ("magnitude_db", &frequency.magnitude_db),
        ("magnitude_db_lower", &frequency.magnitude_db_lower),
        ("magnitude_db_upper", &frequency.magnitude_db_upper),
        ("phase_deg", &frequency.phase_deg),
        ("phase_deg_lower", &frequency.phase_deg_lower),
        ("phase_deg_upper", &frequency.phase_deg_upper),
        ("theta", &model.theta),
        ("theta_sd", &theta_sd),
        ("noise_ar", &model.noise.ar),
    ];
    let mut paragraphs = export.statement(false);
    paragraphs.push(
        "The covariance of theta is in the model file; here are its standard deviations, theta_sd."
            .to_owned(),
    );
    if let Ok(flight) = &export.low_order {
        let rows: Vec<String> = flight
            .covariance
            .iter()
            .map(|row| format!("[{}]", STYLE.short(row)))
            .collect();
        paragraphs.push(format!(
            "Covariance of {}: [{}]",
            parameters_of(flight),
            rows.join(", ")
        ));
    }
    let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
    let mut text = format!("{}\n{}\n", STYLE.comment(&paragraphs), names.join(","));
    let rows = columns.iter().map(|(_, column)| column.len()).max();
    for k in 0..rows.unwrap_or(0) {
        let cells = columns
            .iter()
            .map(|(_, column)| column.get(k).copied().map_or(String::new(), number));
        text += &cells.collect::<Vec<_>>().join(",");
        text.push('\n');
    }
    text
}
