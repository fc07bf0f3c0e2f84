//! Results as text for a terminal.

mod beyond;
mod comparison;

pub use beyond::{of_flight_model, of_limits};
pub use comparison::{facts_of_comparison, how_compared, of_comparison, table_of_comparison};

use servoid_identification::comparison::Comparison;
use servoid_identification::metrics::{Interval, Metrics};
use servoid_identification::model::SelectedBy;
use servoid_identification::{Advice, Model, Validation};
use std::fmt::Write;

/// One line of a table of metrics.
struct Row {
    /// As the model's document calls it.
    key: &'static str,
    name: &'static str,
    unit: &'static str,
    /// From the model's unit to the printed one.
    scale: f64,
    digits: usize,
    of: fn(&Metrics) -> Interval,
}

const ROWS: [Row; 8] = [
    Row {
        key: "dc_gain",
        name: "DC gain",
        unit: "",
        scale: 1.0,
        digits: 4,
        of: |m| m.dc_gain,
    },
    Row {
        key: "delay_s",
        name: "delay (5 %)",
        unit: "ms",
        scale: 1e3,
        digits: 2,
        of: |m| m.delay_s,
    },
    Row {
        key: "t50_s",
        name: "time to 50 %",
        unit: "ms",
        scale: 1e3,
        digits: 2,
        of: |m| m.t50_s,
    },
    Row {
        key: "rise_time_s",
        name: "rise time (10-90 %)",
        unit: "ms",
        scale: 1e3,
        digits: 2,
        of: |m| m.rise_time_s,
    },
    Row {
        key: "overshoot_percent",
        name: "overshoot",
        unit: "%",
        scale: 1.0,
        digits: 2,
        of: |m| m.overshoot_percent,
    },
    Row {
        key: "settling_time_s",
        name: "settling time (2 %)",
        unit: "ms",
        scale: 1e3,
        digits: 1,
        of: |m| m.settling_time_s,
    },
    Row {
        key: "bandwidth_rad_s",
        name: "bandwidth (-3 dB)",
        unit: "rad/s",
        scale: 1.0,
        digits: 2,
        of: |m| m.bandwidth_rad_s,
    },
    Row {
        key: "phase_minus_90_rad_s",
        name: "-90 deg of phase at",
        unit: "rad/s",
        scale: 1.0,
        digits: 2,
        of: |m| m.phase_minus_90_rad_s,
    },
];

impl Row {
    fn number(&self, value: Option<f64>) -> String {
        self.number_like(value, value)
    }

    /// A number with the digits that `like` has.
    fn number_like(&self, value: Option<f64>, like: Option<f64>) -> String {
        // A gain has the units of the recording, and any size with them.
        let digits = match (self.key, like) {
            ("dc_gain", Some(like)) => decimals(like, 4),
            _ => self.digits,
        };
        value.map_or_else(
            || "-".to_owned(),
            |value| format!("{:.digits$}", value * self.scale),
        )
    }

    /// Name and unit.
    fn label(&self) -> String {
        match self.unit {
            "" => self.name.to_owned(),
            unit => format!("{} ({unit})", self.name),
        }
    }

    fn bounds(&self, interval: &Interval) -> String {
        let like = interval.value.or(interval.upper).or(interval.lower);
        let number = |bound: f64| self.number_like(Some(bound), like);
        match (interval.lower, interval.upper) {
            (None, None) => String::new(),
            (Some(lower), None) => format!("{} or more", number(lower)),
            (None, Some(upper)) => format!("up to {}", number(upper)),
            (Some(lower), Some(upper)) => format!("{} .. {}", number(lower), number(upper)),
        }
    }
}

/// The level of a model's bounds, as text: none where they have not earned one.
#[must_use]
pub fn level_text(model: &Model) -> String {
    match model.bounds_hold() {
        true => format!("{} %", percent(model.step.pointwise.level)),
        false => "no level".to_owned(),
    }
}

/// What was found by one identification.
#[must_use]
pub fn of_model(source: &str, model: &Model, unit: Option<&str>) -> String {
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _infallible = write_model(&mut text, source, model, unit);
    text
}

fn write_model(
    text: &mut String,
    source: &str,
    model: &Model,
    unit: Option<&str>,
) -> std::fmt::Result {
    let unit = unit.map(|u| format!(" {u}")).unwrap_or_default();
    let (structure, fit, period) = (&model.structure, &model.fit, model.sample_period_s);
    let (each, whole) = model.step.mean_half_widths();
    let level = level_text(model);
    let (error_digits, band_digits) = (decimals(fit.rmse, 2), decimals(each, 2));
    writeln!(text, "{source}")?;
    if !model.bounds_hold() {
        writeln!(
            text,
            "  ! THE BOUNDS BELOW DO NOT HOLD: the errors are not noise (see the advice)"
        )?;
    }
    if model.is_best_linear_description() {
        writeln!(
            text,
            "  ! NOT LINEAR: the bounds are those of the linear description that fits this reference best (see the advice)"
        )?;
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
        SelectedBy::User => "as asked for",
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
    writeln!(
        text,
        "  step band   +-{each:.band_digits$} each point, +-{whole:.band_digits$} whole curve ({level}, of a unit step, mean)",
    )?;
    writeln!(text, "  offset      {:.error_digits$}{unit}", model.offset)?;
    writeln!(
        text,
        "  residuals   white: {}, independent of the input: {}, linear: {}",
        probability(model.residuals.whiteness_p),
        probability(model.residuals.input_correlation_p),
        probability(model.residuals.linearity_p)
    )?;
    let interval = match model.bounds_hold() {
        true => format!("{level} interval"),
        false => "interval, of no level".to_owned(),
    };
    writeln!(text, "\n  {:22} {:>10}       {interval}", "", "value")?;
    for row in &ROWS {
        let interval = (row.of)(&model.metrics);
        // A unit beside no number would read as one.
        let unit = interval.value.map_or("", |_| row.unit);
        let bounds = match (interval.value, row.bounds(&interval)) {
            (None, bounds) if bounds.is_empty() => withheld(model).to_owned(),
            (_, bounds) => bounds,
        };
        let (name, value) = (row.name, row.number(interval.value));
        writeln!(text, "  {name:22} {value:>10} {unit:5} {bounds}")?;
    }
    write_advice(text, &model.advice)
}

/// Why a figure has no value.
fn withheld(model: &Model) -> &'static str {
    let gain = &model.metrics.dc_gain;
    if gain.value.is_some() && gain.contains(0.0) {
        "withheld: the gain may be zero"
    } else if model.bounds_hold() {
        "not reached, as far as this recording tells"
    } else {
        "withheld: two ways to estimate it disagree (see the advice)"
    }
}

/// How well a model predicted a recording that it had not seen.
#[must_use]
pub fn of_validation(validation: &Validation, unit: Option<&str>) -> String {
    let unit = unit.map(|u| format!(" {u}")).unwrap_or_default();
    let digits = decimals(validation.rmse, 2);
    format!(
        "fit {:.2} %, error {:.digits$}{unit} rms, bias {:+.digits$}{unit}, {} samples{}\n",
        validation.fit_percent,
        validation.rmse,
        validation.bias,
        validation.samples_used,
        match validation.runs_from_rest {
            0 => "",
            _ => ", the first ones too, as the runs begin at rest by the look of them",
        }
    )
}

/// A line of a table of metrics: what it is, and value and bounds for each model.
#[derive(Clone, Debug, PartialEq)]
pub struct MetricRow {
    /// Name and unit.
    pub label: String,
    /// Value and bounds, as text.
    pub cells: Vec<(String, String)>,
}

/// The metrics of models side by side, as text.
#[must_use]
pub fn metric_rows(models: &[&Metrics]) -> Vec<MetricRow> {
    let row = |row: &Row| MetricRow {
        label: row.label(),
        cells: models
            .iter()
            .map(|metrics| (row.of)(metrics))
            .map(|interval| (row.number(interval.value), row.bounds(&interval)))
            .collect(),
    };
    ROWS.iter().map(row).collect()
}

/// The metrics of both sides of a comparison and the second less the first, with bounds, as text.
#[must_use]
pub fn difference_rows(found: &Comparison) -> Vec<MetricRow> {
    let of = |row: &Row| {
        let difference = found.differences.iter().find(|d| d.metric == row.key)?;
        let side = |bounds: Option<[f64; 2]>| {
            bounds.map_or_else(String::new, |[lower, upper]| {
                row.bounds(&Interval::new(lower, lower, upper))
            })
        };
        let bounds = Interval {
            value: difference.difference,
            lower: difference.lower,
            upper: difference.upper,
        };
        Some(MetricRow {
            label: row.label(),
            cells: vec![
                (row.number(difference.a), side(difference.a_bounds)),
                (row.number(difference.b), side(difference.b_bounds)),
                (row.number(bounds.value), row.bounds(&bounds)),
            ],
        })
    };
    ROWS.iter().filter_map(of).collect()
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
