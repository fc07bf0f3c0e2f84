//! Tables of gain, delay, rise time and the like.

use super::first_finding::first_finding;
use crate::data::model_metadata::ModelMetadata;
use crate::presentation::summary::wording::numbers::{
    decimals, digits_beside, fixed, head_of_bounds, widest_shown_with,
};
use crate::presentation::summary::wording::strokes::stroke_in_words;
use servoid_identification::comparison::{Comparison, MetricDifference};
use servoid_identification::results::{Advice, Interval, Metrics, Model, Reason};

/// One line of a table of metrics.
pub(crate) struct MetricEntry {
    /// As the model's document calls it.
    key: &'static str,
    name: &'static str,
    unit: Unit,
    of: fn(&Metrics) -> Interval,
}

const ROWS: [MetricEntry; 8] = [
    row("dc_gain", "DC gain", ("", 1.0, 4), |m| m.dc_gain),
    row("delay_s", "delay (5 %)", MS, |m| m.delay_s),
    row("t50_s", "time to 50 %", MS, |m| m.t50_s),
    row("rise_time_s", "rise time (10-90 %)", MS, |m| m.rise_time_s),
    row("overshoot_percent", "overshoot", ("%", 1.0, 2), |m| {
        m.overshoot_percent
    }),
    row(
        SETTLING_TIME,
        "settling time (2 %)",
        ("ms", 1e3, 1),
        settling_time,
    ),
    row("bandwidth_rad_s", "bandwidth (-3 dB)", HERTZ, |m| {
        m.bandwidth_rad_s
    }),
    row("phase_minus_90_rad_s", "-90 deg of phase at", HERTZ, |m| {
        m.phase_minus_90_rad_s
    }),
];

/// The settling time, but of a response that is not over: what lies beyond the end that was seen decides when it stays within 2 %
/// of it.
pub(crate) fn settling_time(metrics: &Metrics) -> Interval {
    match metrics.bounds.withdrawn() {
        Some(Reason::ResponseNotOver) => Interval::default(),
        _ => metrics.settling_time_s,
    }
}

/// A unit as printed, the factor from the model's unit to it, and decimals.
type Unit = (&'static str, f64, usize);

/// Text of a value that no data support.
pub(crate) const NONE: &str = "-";

/// Behind a bound without another.
const OR_MORE: &str = " or more";

/// Said in the place of times that rest on a time between samples which is that of no recording of a servo.
const TIMES_LEFT_OUT: &str = "times and frequencies are left out: the time between samples is not that of a recording of a servo";

/// The key of the time after which a response stays at its end.
const SETTLING_TIME: &str = "settling_time_s";

const MS: Unit = ("ms", 1e3, 2);
const HERTZ: Unit = ("Hz", std::f64::consts::TAU.recip(), 3);

const fn row(
    key: &'static str,
    name: &'static str,
    unit: Unit,
    of: fn(&Metrics) -> Interval,
) -> MetricEntry {
    MetricEntry {
        key,
        name,
        unit,
        of,
    }
}

/// The metric that the model's document calls `key`.
pub(crate) fn entry(key: &str) -> Option<&'static MetricEntry> {
    ROWS.iter().find(|row| row.key == key)
}

impl MetricEntry {
    /// Its name, without a unit.
    pub(crate) fn name(&self) -> &'static str {
        self.name
    }

    /// Whether it is a time or a frequency.
    pub(crate) fn is_of_time(&self) -> bool {
        matches!(self.unit.0, "ms" | "Hz")
    }

    /// Whether the model's document calls it so.
    pub(crate) fn is(&self, key: &str) -> bool {
        self.key == key
    }

    /// Of a model.
    pub(crate) fn of(&self, metrics: &Metrics) -> Interval {
        (self.of)(metrics)
    }

    /// A number with the digits that `like` has.
    fn number(&self, value: f64, like: f64) -> String {
        let (_, scale, digits) = self.unit;
        // A gain has the units of the recording, and any size with them.
        let digits = if self.key == "dc_gain" {
            decimals(like, 4)
        } else {
            digits
        };
        fixed(value * scale, digits)
    }

    pub(crate) fn value(&self, value: Option<f64>) -> String {
        value.map_or_else(|| NONE.to_owned(), |value| self.number(value, value))
    }

    /// The unit, that of a gain being `gain`.
    pub(crate) fn unit_with<'a>(&self, gain: &'a str) -> &'a str {
        if self.key == "dc_gain" {
            gain
        } else {
            self.unit.0
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
    pub(crate) fn cell(&self, interval: &Interval) -> (String, String) {
        let (value, bounds) = self.shown(interval);
        // Times and shares are 0 or more in all servos.
        let says_nothing = interval.upper.is_none()
            && (interval.lower).is_some_and(|lower| self.number(lower, lower).parse() == Ok(0.0));
        match says_nothing {
            true => (value, String::new()),
            false => (value, bounds),
        }
    }

    /// Value and bounds. Without bounds nothing says how many digits hold, so it has three at the most.
    fn shown(&self, interval: &Interval) -> (String, String) {
        let bounds = self.bounds(interval);
        // A time that the record shows no end of is known by its lower bound alone.
        let open = interval.lower.is_some() && interval.upper.is_none();
        let value = match interval.value {
            _ if open && self.is(SETTLING_TIME) => NONE.to_owned(),
            Some(value) if bounds.is_empty() => self.rough(value),
            value => self.value(value),
        };
        (value, bounds)
    }

    /// A difference with its bounds, in the digits that its interval leaves and both sides have.
    pub(crate) fn cell_of_difference(&self, found: &MetricDifference) -> (String, String) {
        let (value, lower, upper) = (found.difference, found.lower, found.upper);
        let interval = Interval {
            value,
            lower,
            upper,
        };
        let ends = value.zip(lower.zip(upper));
        let Some((value, (lower, upper))) = ends else {
            return self.shown(&interval);
        };
        let (_, scale, digits) = self.unit;
        let of_sides = match (self.key, found.a) {
            ("dc_gain", Some(gain)) => decimals(gain, 4),
            _ => digits,
        };
        let ends = [lower, upper].map(|end| scale * end);
        let least = widest_shown_with(of_sides);
        let shown = |number: f64, width: f64| digits_beside(number, 4, Some(width));
        let width = (scale * (upper - lower)).max(least);
        // An end that is rounded to 0 no longer says whether the difference is sure.
        let hidden = |end: &f64| *end != 0.0 && shown(*end, width).parse() == Ok(0.0);
        let width = match ends.iter().any(hidden) {
            true => least,
            false => width,
        };
        let [lower, upper] = ends.map(|end| shown(end, width));
        (shown(scale * value, width), format!("{lower} .. {upper}"))
    }

    fn rough(&self, value: f64) -> String {
        let (_, scale, digits) = self.unit;
        let leading = (scale * value).abs().log10().floor();
        let most = match self.key {
            "dc_gain" => decimals(value, 3),
            _ => digits,
        };
        let decimals = match leading.is_finite() {
            true => (2 - leading as i32).clamp(0, most as i32) as usize,
            false => most,
        };
        format!("{:.decimals$}", scale * value)
    }

    fn bounds(&self, interval: &Interval) -> String {
        let like = interval.value.or(interval.upper).or(interval.lower);
        let number = |bound: f64| self.number(bound, like.unwrap_or(bound));
        match (interval.lower, interval.upper) {
            (None, None) => String::new(),
            (Some(lower), None) => number(lower) + OR_MORE,
            (None, Some(upper)) => format!("up to {}", number(upper)),
            (Some(lower), Some(upper)) => format!("{} .. {}", number(lower), number(upper)),
        }
    }
}

/// The metrics of one model, a line each; `of_motion` where they are those of the recorded motion alone.
pub(crate) fn table(model: &Model, of: &ModelMetadata, of_motion: bool) -> String {
    let gain = of.units().gain().unwrap_or_default();
    let metrics = &model.metrics;
    let mut head = head_of_bounds(metrics.bounds.as_ref().map(|bounds| bounds.level));
    if metrics.bounds.valid().is_some() && of_motion {
        head += ", of this motion";
    }
    let missing = "not reached, as far as this recording shows";
    let strokes = stroke_in_words(of).map(|stroke| format!("strokes of {stroke}"));
    let strokes = strokes.unwrap_or_default();
    let mut text = format!("\n  {strokes:22} {:>10}       {head}\n", "value");
    let times_are_doubtful = first_finding(model).is_some_and(Advice::doubts_times);
    let shown = |row: &&MetricEntry| !(times_are_doubtful && row.is_of_time());
    for row in ROWS.iter().filter(shown) {
        let interval = (row.of)(metrics);
        let (value, bounds) = row.cell(&interval);
        // A unit beside no number would read as one.
        let (unit, bounds) = match (row.unit_with(&gain), value.as_str()) {
            (unit, NONE) => ("", bounds.replace(OR_MORE, &format!(" {unit}{OR_MORE}"))),
            (unit, _) => (unit, bounds),
        };
        let bounds = match interval.value {
            // One line below has the reason of all.
            None if bounds.is_empty() && metrics.withheld.is_some() => continue,
            None if bounds.is_empty() => missing,
            _ => &bounds,
        };
        let radians = match (row.unit, interval.value) {
            (HERTZ, Some(value)) => format!("  = {value:.2} rad/s"),
            _ => String::new(),
        };
        let line = format!("  {:22} {value:>10} {unit:5} {bounds}{radians}", row.name);
        text += &format!("{}\n", line.trim_end());
    }
    if times_are_doubtful {
        text += &format!("  {TIMES_LEFT_OUT}\n");
    }
    text.extend(withheld_line(metrics).map(|line| format!("  {line}\n")));
    text
}

/// Which metrics are withheld, and why, where some are.
pub(crate) fn withheld_line(metrics: &Metrics) -> Option<String> {
    let because = metrics.why_withheld()?;
    let which = match ROWS.iter().any(|row| row.of(metrics).value.is_some()) {
        true => "the others",
        false => "all",
    };
    Some(format!("{which} are withheld: {because} (see the advice)"))
}

/// A line of a table of numbers with bounds.
pub(crate) struct TableRow {
    /// Name and unit.
    pub label: String,
    /// Value and bounds, as text.
    pub cells: Vec<(String, String)>,
}

/// Metrics side by side. The gain has the unit `gain`, empty where there is none.
pub(crate) fn metric_rows(metrics: &[&Metrics], gain: &str) -> Vec<TableRow> {
    // What is withheld is said once, and has no row.
    let withheld = metrics.iter().any(|metrics| metrics.withheld.is_some());
    let row = |row: &MetricEntry| {
        let intervals: Vec<Interval> = metrics.iter().map(|metrics| (row.of)(metrics)).collect();
        let shown = !withheld || intervals.iter().any(|found| found.value.is_some());
        shown.then(|| TableRow {
            label: row.label(gain),
            cells: intervals.iter().map(|found| row.cell(found)).collect(),
        })
    };
    ROWS.iter().filter_map(row).collect()
}

/// In the place of an interval of a difference that has none, where others have.
const LEFT_OPEN: &str = "open, as that of one side is";

/// The metrics of both sides of a comparison and the second less the first. The gain has the unit `gain`, empty
/// where there is none.
pub(crate) fn difference_rows(found: &Comparison, gain: &str) -> Vec<TableRow> {
    let of = |row: &MetricEntry| {
        let difference = found.differences.iter().find(|d| d.metric == row.key)?;
        let side = |bounds: Option<[f64; 2]>| {
            bounds.map_or_else(String::new, |[lower, upper]| {
                row.bounds(&Interval::new(lower, lower, upper))
            })
        };
        let (value, bounds) = row.cell_of_difference(difference);
        let is_left_open = found.bounds.valid().is_some() && value != NONE && bounds.is_empty();
        let bounds = match is_left_open {
            true => LEFT_OPEN.to_owned(),
            false => bounds,
        };
        Some(TableRow {
            label: row.label(gain),
            cells: vec![
                (row.value(difference.a), side(difference.a_bounds)),
                (row.value(difference.b), side(difference.b_bounds)),
                (value, bounds),
            ],
        })
    };
    ROWS.iter().filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_has_the_digits_of_its_interval_and_keeps_the_sign_of_its_ends() {
        let shown = |key: &str, a: f64, [difference, lower, upper]: [f64; 3]| {
            let found = MetricDifference {
                metric: key.to_owned(),
                a: Some(a),
                a_bounds: None,
                b: Some(a + difference),
                b_bounds: None,
                difference: Some(difference),
                lower: Some(lower),
                upper: Some(upper),
            };
            let (value, bounds) = entry(key).unwrap().cell_of_difference(&found);
            format!("{value} {bounds}")
        };
        let gain = [0.001_873, -0.128_965, 0.132_71];
        assert_eq!(shown("dc_gain", 1.0078, gain), "0.002 -0.129 .. 0.133");
        let quarter_turn = [-0.0004, -0.018, 0.015].map(|hertz| hertz * std::f64::consts::TAU);
        assert_eq!(
            shown("phase_minus_90_rad_s", 25.8, quarter_turn),
            "0.000 -0.018 .. 0.015"
        );
        let settling = [0.0946, 0.0004, 0.1305];
        assert_eq!(
            shown("settling_time_s", 0.09, settling),
            "94.6 0.4 .. 130.5"
        );
    }
}
