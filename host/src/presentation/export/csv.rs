//! A table for anything that reads one: step and frequency response side by side, with bounds, and the
//! parameters with their covariance.

use super::model::Export;
use super::statement::{InFile, low_order_covariance};
use super::text::{Style, number};
use servoid_identification::results::{Bounds, FrequencyResponse, Model};

const STYLE: Style = Style {
    comment: "# ",
    forbidden: &[],
    between: ", ",
    broken: "",
    row: ("[", "]"),
};

/// A column of the table: its name, and its cells from the top.
type Column = (String, Vec<f64>);

/// The table. Lines that begin with # describe it; a column that is shorter than others ends in
/// empty cells.
pub(super) fn write(export: &Export<'_>) -> String {
    let mut paragraphs = export.statement(InFile::default());
    paragraphs.extend(export.model.bounds.valid().map(|_| {
        "The columns theta_covariance_1, theta_covariance_2, ... are those of the covariance of theta, and theta_sd is the root of its diagonal."
            .to_owned()
    }));
    if let Ok(flight) = &export.low_order {
        paragraphs.extend(low_order_covariance(flight, &STYLE));
    }
    let columns = columns(export.model, &export.servo_frequency());
    let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
    let mut text = format!("{}\n{}\n", STYLE.comment(&paragraphs), names.join(","));
    let rows = columns.iter().map(|(_, column)| column.len()).max();
    for k in 0..rows.unwrap_or(0) {
        let cell = |(_, column): &Column| column.get(k).copied().map(number).unwrap_or_default();
        let cells: Vec<String> = columns.iter().map(cell).collect();
        text += &format!("{}\n", cells.join(","));
    }
    text
}

fn columns(model: &Model, of_servo: &FrequencyResponse) -> Vec<Column> {
    let (step, frequency) = (&model.step, &model.frequency);
    let times = (0..step.value.len()).map(|m| model.timing().seconds(m as f64));
    let mut columns = named([
        ("time_s", times.collect()),
        ("step", step.value.clone()),
        ("impulse", model.impulse_response()),
        ("omega_rad_s", frequency.omega_rad_s.clone()),
        ("re", frequency.re.clone()),
        ("im", frequency.im.clone()),
        ("magnitude_db", frequency.magnitude_db.clone()),
        ("phase_deg", frequency.phase_deg.clone()),
        ("servo_phase_deg", of_servo.phase_deg.clone()),
        ("noise_ar", model.noise.ar.clone()),
        ("theta", model.theta.clone()),
    ]);
    if let Bounds::Valid(bounds) = &step.bounds {
        let (each, whole) = (&bounds.pointwise, &bounds.simultaneous);
        columns.extend(named([
            ("step_sd", bounds.sd.clone()),
            ("step_lower", each.lower.clone()),
            ("step_upper", each.upper.clone()),
            ("step_lower_simultaneous", whole.lower.clone()),
            ("step_upper_simultaneous", whole.upper.clone()),
        ]));
    }
    if let Bounds::Valid(bounds) = &frequency.bounds {
        columns.extend(named([
            ("magnitude_db_lower", bounds.magnitude_db_lower.clone()),
            ("magnitude_db_upper", bounds.magnitude_db_upper.clone()),
            ("phase_deg_lower", bounds.phase_deg_lower.clone()),
            ("phase_deg_upper", bounds.phase_deg_upper.clone()),
        ]));
    }
    if let Bounds::Valid(bounds) = &of_servo.bounds {
        columns.extend(named([
            ("servo_phase_deg_lower", bounds.phase_deg_lower.clone()),
            ("servo_phase_deg_upper", bounds.phase_deg_upper.clone()),
        ]));
    }
    if let Bounds::Valid(bounds) = &model.bounds {
        columns.extend(of_covariance(&bounds.covariance));
    }
    columns
}

fn named<const COUNT: usize>(columns: [(&str, Vec<f64>); COUNT]) -> Vec<Column> {
    columns.map(|(name, cells)| (name.to_owned(), cells)).into()
}

/// Standard deviations and covariance of the parameters.
fn of_covariance(covariance: &[Vec<f64>]) -> Vec<Column> {
    let cell = |row: &Vec<f64>, column: usize| row.get(column).copied().unwrap_or(f64::NAN);
    let diagonal = covariance.iter().zip(0..).map(|(row, k)| cell(row, k));
    let sd = diagonal.map(|variance| variance.max(0.0).sqrt()).collect();
    let mut columns = named([("theta_sd", sd)]);
    columns.extend((0..covariance.len()).map(|column| {
        let cells = covariance.iter().map(|row| cell(row, column));
        (format!("theta_covariance_{}", column + 1), cells.collect())
    }));
    columns
}
