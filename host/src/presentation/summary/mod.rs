//! Results as text for a terminal.

mod beyond;
mod comparison;
mod metrics;

pub use beyond::{of_flight_model, of_limits};
pub use comparison::{
    NOT_COMPARED, facts_of_comparison, how_compared, of_comparison, table_of_comparison,
};
pub use metrics::{MetricRow, difference_rows, metric_rows, rows_of_metrics};

use crate::data::units::Units;
use servoid_identification::model::SelectedBy;
use servoid_identification::validity::Bounds;
use servoid_identification::{Advice, Model, Validation};
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

fn write_advice(text: &mut String, advice: &[Advice]) -> std::fmt::Result {
    for item in advice {
        let [finding, remedy] = [&item.finding, &item.remedy].map(|text| wrapped(text, 4));
        writeln!(text, "\n  ! {finding}\n    {remedy}")?;
    }
    Ok(())
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

/// "p = 0.021"; a test that could not be made has none.
pub(crate) fn probability(p: Option<f64>) -> String {
    match p {
        None => "p = -".to_owned(),
        Some(p) if p < 0.001 => "p < 0.001".to_owned(),
        Some(p) => format!("p = {p:.3}"),
    }
}

/// Letters of a line.
const LINE: usize = 110;

/// The text in lines of [`LINE`] letters, all but the first indented.
pub(crate) fn wrapped(text: &str, indent: usize) -> String {
    let mut lines = String::new();
    let mut column = indent;
    for word in text.split(' ') {
        let length = word.chars().count();
        if column > indent && column + 1 + length > LINE {
            lines.push('\n');
            lines.extend(std::iter::repeat_n(' ', indent));
            column = indent;
        } else if column > indent {
            lines.push(' ');
            column += 1;
        }
        lines.push_str(word);
        column += length;
    }
    lines
}

/// Decimals that show at least so many digits of a number, and four where that is more.
pub(crate) fn decimals(number: f64, significant: i32) -> usize {
    let leading = if number == 0.0 || !number.is_finite() {
        0.0
    } else {
        number.abs().log10().floor()
    };
    // The smallest positive number begins at the 324th decimal.
    let needed = (significant - 1 - leading as i32).clamp(4, 330);
    needed as usize
}

/// A level in percent: 57 rather than 56.99999999999999.
pub(crate) fn percent(level: f64) -> f64 {
    rounded(100.0 * level)
}

/// 2 rather than 2.0000000000000004.
fn rounded(number: f64) -> f64 {
    (number * 1e6).round() / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lines_are_broken_between_words_and_lose_none() {
        let lines = wrapped(&("word ".repeat(60) + "end"), 4);
        assert!(lines.lines().count() > 2 && lines.lines().all(|line| line.len() <= LINE));
        assert!(lines.lines().skip(1).all(|line| line.starts_with("    ")));
        assert_eq!(lines.split_whitespace().count(), 61);
    }

    #[test]
    fn small_numbers_keep_their_digits() {
        let shown = |number: f64, digits| format!("{number:.*}", decimals(number, digits));
        assert_eq!(shown(0.97, 4), "0.9700");
        assert_eq!(shown(0.000_012_36, 4), "0.00001236");
        assert_eq!(
            (shown(0.0, 4), shown(123.4, 2)),
            ("0.0000".into(), "123.4000".into())
        );
        assert_eq!(percent(0.57), 57.0);
    }
}
