//! Results as text for a terminal.

mod beyond;
mod comparison;

pub use beyond::{of_flight_model, of_limits};
pub use comparison::{facts_of_comparison, of_comparison};

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
        value.map_or_else(
            || "-".to_owned(),
            |v| format!("{:.*}", self.digits, v * self.scale),
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
        match (interval.lower, interval.upper) {
            (None, None) => String::new(),
            (lower, upper) => format!("{} .. {}", self.number(lower), self.number(upper)),
        }
    }
}

/// The level of a model's bounds, as text: none where they have not earned one.
#[must_use]
pub fn level_text(model: &Model) -> String {
    match model.bounds_hold() {
        true => format!("{} %", 100.0 * model.step.pointwise.level),
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
    writeln!(text, "{source}")?;
    if !model.bounds_hold() {
        writeln!(
            text,
            "  ! THE BOUNDS BELOW DO NOT HOLD: the errors are not noise (see the advice)"
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
        "  fit         {:.2} % simulated, {:.2} % one step ahead, error {:.4}{unit} rms",
        fit.simulation_percent, fit.one_step_percent, fit.rmse
    )?;
    writeln!(
        text,
        "  step band   +-{each:.4} each point, +-{whole:.4} whole curve ({level}, of a unit step, mean)",
    )?;
    writeln!(text, "  offset      {:.4}{unit}", model.offset)?;
    writeln!(
        text,
        "  residuals   white: {}, independent of the input: {}",
        probability(model.residuals.whiteness_p),
        probability(model.residuals.input_correlation_p)
    )?;
    writeln!(text, "\n  {:22} {:>10}       {level} interval", "", "value")?;
    for row in &ROWS {
        let interval = (row.of)(&model.metrics);
        writeln!(
            text,
            "  {:22} {:>10} {:5} {}",
            row.name,
            row.number(interval.value),
            row.unit,
            row.bounds(&interval)
        )?;
    }
    write_advice(text, &model.advice)
}

/// How well a model predicted a recording that it had not seen.
#[must_use]
pub fn of_validation(validation: &Validation, unit: Option<&str>) -> String {
    let unit = unit.map(|u| format!(" {u}")).unwrap_or_default();
    format!(
        "fit {:.2} %, error {:.4}{unit} rms, bias {:+.4}{unit}, {} samples{}\n",
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

/// Two models side by side, with their difference.
#[must_use]
pub fn side_by_side(bench: &Metrics, aircraft: &Metrics) -> String {
    let mut text = format!(
        "{:32} {:>12} {:>12} {:>12}\n",
        "", "bench", "aircraft", "difference"
    );
    for row in &ROWS {
        let (a, b) = ((row.of)(bench).value, (row.of)(aircraft).value);
        let difference = a.zip(b).map(|(a, b)| b - a);
        let _infallible = writeln!(
            text,
            "{:32} {:>12} {:>12} {:>12}",
            row.label(),
            row.number(a),
            row.number(b),
            row.number(difference)
        );
    }
    text
}

fn write_advice(text: &mut String, advice: &[Advice]) -> std::fmt::Result {
    for item in advice {
        writeln!(text, "\n  ! {}\n    {}", item.finding, item.remedy)?;
    }
    Ok(())
}

/// Samples, structure and fit in one sentence.
#[must_use]
pub fn one_line(model: &Model, unit: Option<&str>) -> String {
    let unit = unit.map(|u| format!(" {u}")).unwrap_or_default();
    let (structure, fit) = (&model.structure, &model.fit);
    format!(
        "{} samples used, {} missing, every {} ms; settling N = {} samples, n = {} frequencies, noise order d = {}; fit {:.2} % simulated, error {:.4}{unit} rms; residuals white: {}, independent of the input: {}",
        fit.samples_used,
        fit.samples_missing,
        rounded(model.sample_period_s * 1e3),
        structure.settling_samples,
        structure.frequencies,
        structure.noise_order,
        fit.simulation_percent,
        fit.rmse,
        probability(model.residuals.whiteness_p),
        probability(model.residuals.input_correlation_p)
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

/// 2 rather than 2.0000000000000004.
fn rounded(number: f64) -> f64 {
    (number * 1e6).round() / 1e6
}
