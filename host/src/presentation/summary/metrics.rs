//! Tables of gain, delay, rise time and the like.

use super::numbers::{decimals, percent};
use crate::data::units::Units;
use servoid_identification::comparison::Comparison;
use servoid_identification::results::{Bounds, Interval, Metrics, Model};
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

    /// The unit, that of a gain being `gain`.
    fn unit_with<'a>(&self, gain: &'a str) -> &'a str {
        match self.key {
            "dc_gain" => gain,
            _ => self.unit,
        }
    }

    /// Name and unit, that of a gain being `gain`.
    fn label(&self, gain: &str) -> String {
        match self.unit_with(gain) {
            "" => self.name.to_owned(),
            unit => format!("{} ({unit})", self.name),
        }
    }

    /// Value and bounds.
    fn cell(&self, interval: &Interval) -> (String, String) {
        (self.number(interval.value), self.bounds(interval))
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

/// The figures of one model, a line each.
pub(super) fn write_table(text: &mut String, model: &Model, units: Units<'_>) -> std::fmt::Result {
    let gain = units.gain().unwrap_or_default();
    let metrics = &model.metrics;
    let interval = match metrics.bounds {
        Bounds::Valid(bounds) => format!("{} % interval", percent(bounds.level)),
        Bounds::Withdrawn(_) => "no bounds".to_owned(),
    };
    writeln!(text, "\n  {:22} {:>10}       {interval}", "", "value")?;
    let missing = metrics.withheld.map_or_else(
        || "not reached, as far as this recording shows".to_owned(),
        |reason| format!("withheld: {} (see the advice)", reason.because()),
    );
    for row in &ROWS {
        let interval = (row.of)(metrics);
        // A unit beside no number would read as one.
        let unit = interval.value.map_or("", |_| row.unit_with(&gain));
        let bounds = match (interval.value, row.bounds(&interval)) {
            (None, bounds) if bounds.is_empty() => missing.clone(),
            (_, bounds) => bounds,
        };
        let line = format!(
            "  {:22} {:>10} {unit:5} {bounds}",
            row.name,
            row.number(interval.value)
        );
        writeln!(text, "{}", line.trim_end())?;
    }
    Ok(())
}

/// A line of a table of metrics: what it is, and value and bounds for each model.
#[derive(Clone, Debug, PartialEq)]
pub struct MetricRow {
    /// Name and unit.
    pub label: String,
    /// Value and bounds, as text.
    pub cells: Vec<(String, String)>,
}

/// Metrics that belong to no model, such as those that are expected of one, as text.
#[must_use]
pub fn rows_of_metrics(metrics: &Metrics) -> Vec<MetricRow> {
    let of = |row: &Row| MetricRow {
        label: row.label(""),
        cells: vec![row.cell(&(row.of)(metrics))],
    };
    ROWS.iter().map(of).collect()
}

/// The metrics of models side by side, as text; bounds where there are any. The gain has the unit `gain`,
/// empty where there is none.
#[must_use]
pub fn metric_rows(models: &[&Model], gain: &str) -> Vec<MetricRow> {
    let row = |row: &Row| MetricRow {
        label: row.label(gain),
        cells: models
            .iter()
            .map(|model| row.cell(&(row.of)(&model.metrics)))
            .collect(),
    };
    ROWS.iter().map(row).collect()
}

/// The metrics of both sides of a comparison and the second less the first, with bounds, as text. The
/// gain has the unit `gain`, empty where there is none.
#[must_use]
pub fn difference_rows(found: &Comparison, gain: &str) -> Vec<MetricRow> {
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
            label: row.label(gain),
            cells: vec![
                (row.number(difference.a), side(difference.a_bounds)),
                (row.number(difference.b), side(difference.b_bounds)),
                (row.number(bounds.value), row.bounds(&bounds)),
            ],
        })
    };
    ROWS.iter().filter_map(of).collect()
}
