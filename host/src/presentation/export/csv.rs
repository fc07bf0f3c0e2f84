//! A table for anything that reads one: step and frequency response side by side, with bounds, and the
//! parameters with their covariance.

use super::Export;
use super::statement::low_order_covariance;
use super::text::{Style, number};
use servoid_identification::Model;

const STYLE: Style = Style {
    comment: "# ",
    forbidden: &[],
    between: ", ",
    broken: "",
    row: ("[", "]"),
};

/// A column of the table: its name, and its cells from the top.
type Column = (String, Vec<f64>);

/// The table. Lines that begin with # tell about it; a column that is shorter than others ends in
/// empty cells.
pub(super) fn write(export: &Export<'_>) -> String {
    let mut paragraphs = export.statement(false);
    paragraphs.push(
        "The columns theta_covariance_1, theta_covariance_2, ... are those of the covariance of theta, and theta_sd is the root of its diagonal."
            .to_owned(),
    );
    if let Ok(flight) = &export.low_order {
        paragraphs.push(low_order_covariance(flight, &STYLE));
    }
    let columns = columns(export.model);
    let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
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

fn columns(model: &Model) -> Vec<Column> {
    let (step, frequency) = (&model.step, &model.frequency);
    let times = (0..step.value.len()).map(|m| model.timing().seconds(m as f64));
    let cell = |row: usize, column: usize| model.covariance.get(row)?.get(column).copied();
    let of_covariance = |of: &dyn Fn(usize) -> Option<f64>| -> Vec<f64> {
        (0..model.covariance.len()).filter_map(of).collect()
    };
    let theta_sd = of_covariance(&|k| Some(cell(k, k)?.max(0.0).sqrt()));
    let mut columns: Vec<Column> = [
        ("time_s", times.collect()),
        ("step", step.value.clone()),
        ("step_sd", step.sd.clone()),
        ("step_lower", step.pointwise.lower.clone()),
        ("step_upper", step.pointwise.upper.clone()),
        ("step_lower_simultaneous", step.simultaneous.lower.clone()),
        ("step_upper_simultaneous", step.simultaneous.upper.clone()),
        ("impulse", model.impulse_response()),
        ("omega_rad_s", frequency.omega_rad_s.clone()),
        ("re", frequency.re.clone()),
        ("im", frequency.im.clone()),
        ("magnitude_db", frequency.magnitude_db.clone()),
        ("magnitude_db_lower", frequency.magnitude_db_lower.clone()),
        ("magnitude_db_upper", frequency.magnitude_db_upper.clone()),
        ("phase_deg", frequency.phase_deg.clone()),
        ("phase_deg_lower", frequency.phase_deg_lower.clone()),
        ("phase_deg_upper", frequency.phase_deg_upper.clone()),
        ("noise_ar", model.noise.ar.clone()),
        ("theta", model.theta.clone()),
        ("theta_sd", theta_sd),
    ]
    .map(|(name, cells)| (name.to_owned(), cells))
    .into();
    columns.extend((0..model.covariance.len()).map(|column| {
        let name = format!("theta_covariance_{}", column + 1);
        (name, of_covariance(&|row| cell(row, column)))
    }));
    columns
}
