//! Results as text for a terminal.

mod advice;
mod beyond;
mod comparison;
mod lines;
mod metrics;
mod numbers;

pub use beyond::{of_flight_model, of_limits};
pub use comparison::{
    NOT_COMPARED, facts_of_comparison, how_compared, of_comparison, table_of_comparison,
};
pub use metrics::{MetricRow, difference_rows, metric_rows, rows_of_metrics};

pub(crate) use lines::wrapped;
pub(crate) use numbers::{decimals, percent, probability};

use crate::data::units::Units;
use advice::write_advice;
use numbers::rounded;
use servoid_identification::results::{Advice, Bounds, Model, SelectedBy, Validation};
use std::fmt::Write;

/// The level of a model's bounds, as text: none where no bounds can be given.
#[must_use]
pub fn level_text(model: &Model) -> String {
    match model.level() {
        Bounds::Valid(level) => format!("{} %", percent(level)),
        Bounds::Withdrawn(_) => "no bounds".to_owned(),
    }
}

/// What was found by one identification.
#[must_use]
pub fn of_model(source: &str, model: &Model, units: Units<'_>) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _infallible = write_model(&mut text, source, model, units);
    text
}

fn write_model(
    text: &mut String,
    source: &str,
    model: &Model,
    units: Units<'_>,
) -> std::fmt::Result {
    let unit = units.output.map(|u| format!(" {u}")).unwrap_or_default();
    let (structure, fit, period) = (&model.structure, &model.fit, model.sample_period_s);
    let error_digits = decimals(fit.rmse, 2);
    writeln!(text, "{source}")?;
    match model.level() {
        Bounds::Withdrawn(reason) => writeln!(
            text,
            "  ! NO BOUNDS CAN BE GIVEN: {} (see the advice)",
            reason.because()
        )?,
        Bounds::Valid(_) if !model.linear => writeln!(
            text,
            "  ! NOT LINEAR: the bounds are those of the linear description that fits this reference best (see the advice)"
        )?,
        Bounds::Valid(_) => {}
    }
    writeln!(
        text,
        "  samples     {} used, {} missing, every {} ms",
        fit.samples_used,
        fit.samples_missing,
        rounded(period * 1e3)
    )?;
    let chosen = match structure.selected_by {
        SelectedBy::Auto => "chosen from the data",
        SelectedBy::Narrow => {
            "narrow: smoother, holds only if the response falls steeply above its highest frequency"
        }
        SelectedBy::User => "as asked for, and what was left open from the data",
    };
    writeln!(
        text,
        "  structure   settling N = {} samples ({:.0} ms), n = {} frequencies, noise order d = {} ({chosen})",
        structure.settling_samples,
        structure.settling_samples as f64 * period * 1e3,
        structure.frequencies,
        structure.noise_order
    )?;
    writeln!(
        text,
        "  fit         {:.2} % simulated, {:.2} % one step ahead, error {:.error_digits$}{unit} rms",
        fit.simulation_percent, fit.one_step_percent, fit.rmse
    )?;
    writeln!(text, "  step band   {}", step_band(model))?;
    // A minus in front of nothing but zeros is none.
    let offset = format!("{:.error_digits$}", model.offset);
    let offset = match offset.trim_start_matches(['-', '0', '.']) {
        "" => offset.trim_start_matches('-'),
        _ => &offset,
    };
    writeln!(
        text,
        "  offset      {offset}{unit}, the output with the input at 0"
    )?;
    writeln!(
        text,
        "  residuals   white: {}, independent of the input: {}, linear: {}",
        probability(model.residuals.whiteness_p),
        probability(model.residuals.input_correlation_p),
        probability(model.residuals.linearity_p)
    )?;
    metrics::write_table(text, model, units)?;
    write_advice(text, &model.advice)
}

/// How wide the bounds of the step response are.
fn step_band(model: &Model) -> String {
    let Bounds::Valid(bounds) = &model.step.bounds else {
        return "none, as no bounds can be given".to_owned();
    };
    let (each, whole) = bounds.mean_half_widths();
    let digits = decimals(each, 2);
    format!(
        "+-{each:.digits$} each point, +-{whole:.digits$} whole curve ({} %, of a unit step, mean)",
        percent(bounds.level)
    )
}

/// How well a model predicted a recording that it had not seen.
#[must_use]
pub fn of_validation(validation: &Validation, unit: Option<&str>, advice: &[Advice]) -> String {
    let unit = unit.map(|u| format!(" {u}")).unwrap_or_default();
    let digits = decimals(validation.rmse, 2);
    let mut text = format!(
        "fit {:.2} %, error {:.digits$}{unit} rms, bias {:+.digits$}{unit}, {} samples{}\n",
        validation.fit_percent,
        validation.rmse,
        validation.bias,
        validation.samples_used,
        match validation.runs_from_rest {
            0 => "",
            _ => ", the first ones too, as the runs begin at rest by the look of them",
        }
    );
    // Writing to a String cannot fail.
    let _infallible = write_advice(&mut text, advice);
    text
}

/// Samples, structure and fit in one sentence.
#[must_use]
pub fn one_line(model: &Model, unit: Option<&str>) -> String {
    let unit = unit.map(|u| format!(" {u}")).unwrap_or_default();
    let (structure, fit) = (&model.structure, &model.fit);
    let digits = decimals(fit.rmse, 2);
    format!(
        "{} samples used, {} missing, every {} ms; settling N = {} samples, n = {} frequencies, noise order d = {}; fit {:.2} % simulated, error {:.digits$}{unit} rms; residuals white: {}, independent of the input: {}, linear: {}",
        fit.samples_used,
        fit.samples_missing,
        rounded(model.sample_period_s * 1e3),
        structure.settling_samples,
        structure.frequencies,
        structure.noise_order,
        fit.simulation_percent,
        fit.rmse,
        probability(model.residuals.whiteness_p),
        probability(model.residuals.input_correlation_p),
        probability(model.residuals.linearity_p)
    )
}
