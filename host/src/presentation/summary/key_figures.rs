//! The six numbers that people ask for first, of one servo or of two.

use super::headline::stroke_in_words;
use super::response::first_finding::first_finding;
use super::response::low_order::gain_by_order;
use super::response::metrics::{self, MetricEntry, NONE};
use super::servo::measured_limits::measured_limits;
use super::servo::quantity_table::{QuantityRow, quantity_rows, scale_and_unit, under_load};
use super::servo::what_to_record::shown_by;
use super::two_servos::comparison::verdict;
use super::wording::numbers::{digits, four_digits, percent, signed, with_bounds};
use super::wording::sixty_degrees::{
    per_60_degrees, seconds_per_60_degrees, stroke_of_60_degrees_ms,
};
use crate::data::pulse_widths::is_pulse;
use crate::data::units::Units;
use servoid_identification::comparison::{
    Comparison, QuantityDifference, QuantityPair, ServoModelComparison,
};
use servoid_identification::flight_model::FlightModel;
use servoid_identification::results::{Advice, Interval, Metrics, Model};
use servoid_identification::servo_model::{Quantity, QuantityKind, ServoModel, Spread};

/// A number for people.
#[derive(Clone, Debug)]
pub(crate) struct KeyFigure {
    /// What it is.
    pub label: String,
    /// The number with its unit.
    pub value: String,
    /// Its bounds, or what else is known of it.
    pub below: String,
}

/// So many are shown.
pub(crate) const KEY_FIGURES: usize = 6;

/// Of one linear response.
const OF_A_RESPONSE: [&str; KEY_FIGURES] = [
    "delay_s",
    "rise_time_s",
    "settling_time_s",
    "overshoot_percent",
    "bandwidth_rad_s",
    "dc_gain",
];

/// Beside the largest difference and the delay between two.
const OF_A_DIFFERENCE: [&str; KEY_FIGURES - 2] = [
    "rise_time_s",
    "overshoot_percent",
    "bandwidth_rad_s",
    "dc_gain",
];

/// Of a servo as a machine: those that it has, in this order.
const OF_A_MACHINE: [QuantityKind; 11] = [
    QuantityKind::TopSpeedUpwards,
    QuantityKind::TopSpeedDownwards,
    QuantityKind::Delay,
    QuantityKind::Bandwidth,
    QuantityKind::Play,
    QuantityKind::DampingRatio,
    QuantityKind::RestingError,
    QuantityKind::DeadBand,
    QuantityKind::Gain,
    QuantityKind::ErrorOfFullDrive,
    QuantityKind::Offset,
];

/// What else two of them may differ in.
const OF_TWO_MACHINES: [QuantityKind; 5] = [
    QuantityKind::AccelerationUpwards,
    QuantityKind::AccelerationDownwards,
    QuantityKind::LoadAtMiddle,
    QuantityKind::SpringOfLoad,
    QuantityKind::LoadOfLevelArm,
];

/// Of a linear model, with the low-order model of a band.
pub(crate) fn of_response(
    model: &Model,
    low_order: Option<&FlightModel>,
    units: Units<'_>,
) -> Vec<KeyFigure> {
    let gain = units.gain().unwrap_or_default();
    let times_are_doubtful = first_finding(model).is_some_and(Advice::doubts_times);
    let figure = |entry: &MetricEntry| {
        let (value, bounds) = match times_are_doubtful && entry.is_of_time() {
            true => (NONE.to_owned(), "left out".to_owned()),
            false => entry.cell(&entry.of(&model.metrics)),
        };
        let below = match (value.as_str(), bounds.is_empty()) {
            (NONE, true) => reason_of_none(&model.metrics).to_owned(),
            (_, true) => "no bounds".to_owned(),
            _ => bounds,
        };
        KeyFigure {
            label: entry.name().to_owned(),
            value: with_unit(value, entry.unit_with(&gain)),
            below,
        }
    };
    let entries = OF_A_RESPONSE.into_iter().filter_map(metrics::entry);
    let by_order = low_order.and_then(|flight| by_order(flight, units));
    let is_open =
        |entry: &MetricEntry| entry.is("dc_gain") && model.metrics.dc_gain.value.is_none();
    let shown = |entry: &MetricEntry| match &by_order {
        Some(gain) if is_open(entry) => gain.clone(),
        _ => figure(entry),
    };
    entries.map(shown).collect()
}

/// The gain by a low-order model, in the place of one that is not known by itself.
fn by_order(flight: &FlightModel, units: Units<'_>) -> Option<KeyFigure> {
    let (value, below) = gain_by_order(flight, units)?;
    Some(KeyFigure {
        label: "gain".to_owned(),
        value,
        below,
    })
}

fn reason_of_none(metrics: &Metrics) -> &'static str {
    match metrics.withheld {
        Some(_) => "withheld",
        None => "not reached",
    }
}

/// A unit beside no number would read as one.
fn with_unit(value: String, unit: &str) -> String {
    match (value.as_str(), unit) {
        (NONE, _) | (_, "") => value,
        _ => format!("{value} {unit}"),
    }
}

/// Of a servo as a machine, with the low-order model of a band.
pub(crate) fn of_machine(
    model: &ServoModel,
    low_order: Option<&FlightModel>,
    units: Units<'_>,
) -> Vec<KeyFigure> {
    let rows = quantity_rows(&model.quantities, units);
    let of_kind = |kind: &QuantityKind| rows.iter().find(|(found, _)| found.kind() == Some(*kind));
    let one_speed = has_one_top_speed(model);
    let known = OF_A_MACHINE
        .iter()
        .filter(|kind| !(one_speed && **kind == QuantityKind::TopSpeedDownwards))
        .filter(|kind| !is_at_no_pulse(**kind, model, units))
        .filter_map(of_kind);
    // What the recording determines comes first.
    let (determined, open): (Vec<_>, Vec<_>) = known.partition(|(found, _)| found.determined);
    let figure = |(quantity, row): &&(&Quantity, QuantityRow)| {
        let (value, below) = value_and_below(model, (quantity, row), units);
        KeyFigure {
            label: match one_speed {
                true => row.name.replace("top speed upwards", "top speed"),
                false => row.name.clone(),
            },
            value: with_unit(value, &row.unit),
            below,
        }
    };
    let fit = fit_figure(format!("{:.1} %", model.fit.held_out_percent));
    let mut all: Vec<KeyFigure> = determined.iter().map(figure).collect();
    let speeds = determined
        .iter()
        .take_while(|(found, _)| is_top_speed(found));
    let behind_speeds = speeds.count();
    if let Some(stroke) = whole_stroke(model, units) {
        all.insert(behind_speeds, stroke);
    }
    all.truncate(KEY_FIGURES - 1);
    all.push(fit);
    let by_order = low_order.and_then(|flight| by_order(flight, units));
    let is_gain = |found: &Quantity| found.kind() == Some(QuantityKind::Gain);
    let shown = |row: &&(&Quantity, QuantityRow)| match &by_order {
        Some(gain) if is_gain(row.0) => gain.clone(),
        _ => figure(row),
    };
    all.extend(open.iter().map(shown));
    all.truncate(KEY_FIGURES);
    all
}

/// The figure of a quantity, and what is known of it beside. A top speed is the one that the strokes show, where they do.
fn value_and_below(
    model: &ServoModel,
    (quantity, row): (&Quantity, &QuantityRow),
    units: Units<'_>,
) -> (String, String) {
    if let Some(limit) = model.limit_of_strokes(quantity.kind()) {
        let turn = seconds_per_60_degrees(limit, units);
        let turn = turn.map_or_else(String::new, |turn| format!("; {turn}"));
        return (digits(limit, 3), format!("by its larger strokes{turn}"));
    }
    let turn = per_60_degrees(quantity, units);
    let below = match (row.interval.is_empty(), turn) {
        _ if !quantity.determined => {
            let shown_by = quantity.kind().and_then(shown_by);
            let shown_by = shown_by.map(|words| format!(": {words}"));
            format!("not determined{}", shown_by.unwrap_or_default())
        }
        (true, None) => "no interval".to_owned(),
        (true, Some(turn)) => turn,
        (false, None) => row.interval.clone(),
        (false, Some(turn)) => format!("{}; {turn}", row.interval),
    };
    // The ranges of other fits stand where intervals do.
    let doubts = [
        (model.stayed_below(quantity), "extrapolated; "),
        (
            quantity.other_fits.is_some() && quantity.determined,
            "no interval; ",
        ),
    ];
    let doubts = doubts.into_iter().filter(|(applies, _)| *applies);
    let doubts: String = doubts.map(|(_, words)| words).collect();
    (row.value.clone(), doubts + &below)
}

/// Whether it is the position at a pulse of 0 us, which no servo gets.
fn is_at_no_pulse(kind: QuantityKind, model: &ServoModel, units: Units<'_>) -> bool {
    kind == QuantityKind::Offset && is_pulse(units, model.commands)
}

fn is_top_speed(quantity: &Quantity) -> bool {
    let kind = quantity.kind();
    matches!(
        kind,
        Some(QuantityKind::TopSpeedUpwards | QuantityKind::TopSpeedDownwards)
    )
}

/// The whole stroke of 60 degrees, beside the speed in it.
fn whole_stroke(model: &ServoModel, units: Units<'_>) -> Option<KeyFigure> {
    let [up, down] = stroke_of_60_degrees_ms(model, units)?;
    let (value, below) = match up == down {
        true => (format!("{up} ms"), "with delay, to within 2 %"),
        false => (
            format!("{up} / {down} ms"),
            "up / down, with delay, to within 2 %",
        ),
    };
    Some(KeyFigure {
        label: "stroke of 60°".to_owned(),
        value,
        below: below.to_owned(),
    })
}

/// How well parts of the record are predicted that a fit has not seen.
fn fit_figure(value: String) -> KeyFigure {
    KeyFigure {
        label: "predicts unseen parts to".to_owned(),
        value,
        below: "of the motion".to_owned(),
    }
}

/// Whether it turns as fast both ways, by the model and by its strokes.
fn has_one_top_speed(model: &ServoModel) -> bool {
    let of = |kind: QuantityKind| model.quantity(kind).map(|found| found.value);
    let speeds = [
        QuantityKind::TopSpeedUpwards,
        QuantityKind::TopSpeedDownwards,
    ];
    let [up, down] = speeds.map(of);
    let [shown_up, shown_down] =
        measured_limits(model).map(|limit| limit.map(|limit| digits(limit, 3)));
    up.is_some() && up == down && shown_up == shown_down
}

/// Of a comparison, which has bounds.
pub(crate) fn of_comparison(b: &str, found: &Comparison, units: Units<'_>) -> Vec<KeyFigure> {
    let gain = units.gain().unwrap_or_default();
    let mut all = Vec::with_capacity(KEY_FIGURES);
    if let Some(bounds) = found.bounds.valid() {
        let largest = &bounds.difference_percent;
        all.push(KeyFigure {
            label: "largest difference".to_owned(),
            value: format!("{:.1} .. {:.1} %", largest.at_least, largest.at_most),
            below: format!(
                "of the step{}, {} %: {}",
                stroke_in_words(largest.stroke),
                percent(bounds.level),
                verdict(found.verdict)
            ),
        });
        let shift =
            |shift: &Interval| with_bounds(shift, " ms", |seconds| signed(1e3 * seconds, 1));
        let (value, below) = match &found.curves[..] {
            [up, down] => (
                shift_alone(&up.delay_shift_s, &down.delay_shift_s),
                "strokes up / down".to_owned(),
            ),
            [both] => match shift(&both.delay_shift_s).split_once(" (") {
                Some((value, bounds)) => {
                    (value.to_owned(), bounds.trim_end_matches(')').to_owned())
                }
                None => (NONE.to_owned(), String::new()),
            },
            _ => (NONE.to_owned(), String::new()),
        };
        all.push(KeyFigure {
            label: format!("{b} is behind by"),
            value,
            below,
        });
    }
    let figure = |entry: &MetricEntry| {
        let difference = found.differences.iter().find(|d| entry.is(&d.metric))?;
        let (value, bounds) = entry.cell_of_difference(difference);
        Some(KeyFigure {
            label: entry.name().to_owned(),
            value: with_unit(
                side_by_side(entry, [difference.a, difference.b]),
                entry.unit_with(&gain),
            ),
            below: match bounds.is_empty() {
                true => NONE.to_owned(),
                false => format!("{}{value} ({bounds})", sign(difference.difference)),
            },
        })
    };
    let entries = OF_A_DIFFERENCE.into_iter().filter_map(metrics::entry);
    all.extend(entries.filter_map(figure));
    all
}

/// "+10.1 / -4.0 ms"
fn shift_alone(up: &Interval, down: &Interval) -> String {
    let [up, down] = [up, down].map(|shift| {
        shift
            .value
            .map_or(NONE.to_owned(), |seconds| signed(1e3 * seconds, 1))
    });
    format!("{up} / {down} ms")
}

fn sign(value: Option<f64>) -> &'static str {
    match value {
        Some(value) if value > 0.0 => "+",
        _ => "",
    }
}

/// "54.1 → 61.3"; "-" where neither is there.
fn side_by_side(entry: &MetricEntry, [a, b]: [Option<f64>; 2]) -> String {
    match a.or(b) {
        None => NONE.to_owned(),
        Some(_) => format!("{} → {}", entry.value(a), entry.value(b)),
    }
}

/// Of two linear models that are not compared.
pub(crate) fn of_both(models: [&Model; 2], gain: &str) -> Vec<KeyFigure> {
    let figure = |entry: &MetricEntry| {
        let values = models.map(|model| entry.of(&model.metrics).value);
        let value = side_by_side(entry, values);
        let below = match (value.as_str(), models) {
            (NONE, [a, _]) => reason_of_none(&a.metrics).to_owned(),
            _ => "no bounds".to_owned(),
        };
        KeyFigure {
            label: entry.name().to_owned(),
            value: with_unit(value, entry.unit_with(gain)),
            below,
        }
    };
    let entries = OF_A_RESPONSE.into_iter().filter_map(metrics::entry);
    entries.map(figure).collect()
}

/// Share from which on two numbers without intervals are shown as different.
const VISIBLY: f64 = 0.01;

/// Whether it is one of those that stand for each other at rest.
fn is_of_rest(pair: &QuantityPair) -> bool {
    matches!(
        pair.kind(),
        Some(QuantityKind::DeadBand | QuantityKind::RestingError | QuantityKind::Play)
    )
}

/// Of two servos as machines: what they differ in comes first.
pub(crate) fn of_both_machines(
    found: &ServoModelComparison,
    models: [&ServoModel; 2],
    units: Units<'_>,
) -> Vec<KeyFigure> {
    let of_kind = |kind: &QuantityKind| {
        let mut all = found.quantities.iter();
        let index = all.position(|pair| pair.kind() == Some(*kind))?;
        Some((index, found.quantities.get(index)?))
    };
    let of_side = |value: fn(&QuantityPair) -> Option<f64>| {
        let known = move |pair: &&QuantityPair| value(pair).is_some();
        (found.quantities.iter().filter(known)).filter_map(QuantityPair::kind)
    };
    let loads = |pair: &QuantityPair| {
        let a = under_load(pair.kind(), of_side(|pair| pair.a)).map(|load| ("A", load));
        let b = under_load(pair.kind(), of_side(|pair| pair.b)).map(|load| ("B", load));
        match (a, b) {
            (Some((_, load)), Some(_)) => format!("; both {load}"),
            (Some((side, load)), None) | (None, Some((side, load))) => format!("; {side} {load}"),
            (None, None) => String::new(),
        }
    };
    let figure = |(index, pair): (usize, &QuantityPair)| {
        let (scale, unit) = scale_and_unit(pair.unit, units);
        // Top speeds of models that lack something are off by more than what strokes show.
        let measured = pair.kind().and_then(|kind| found.speeds_of_strokes(kind));
        if let Some(speeds) = measured {
            let [a, b] = speeds.map(|speed| digits(scale * speed, 3));
            return KeyFigure {
                label: pair.name.clone(),
                value: with_unit(format!("{a} → {b}"), &unit),
                below: "by larger strokes; no interval".to_owned(),
            };
        }
        let shown = |value: Option<f64>| value.map_or(NONE.to_owned(), |v| four_digits(scale * v));
        let value = format!("{} → {}", shown(pair.a), shown(pair.b));
        let difference = found
            .bounds
            .valid()
            .and_then(|bounds| bounds.differences.get(index)?.difference);
        let below = difference.and_then(|difference| {
            Some(format!(
                "difference {} .. {}",
                shown(Some(difference.lower?)),
                shown(Some(difference.upper?))
            ))
        });
        let has_waits = pair.kind() == Some(QuantityKind::Delay) && found.waits_s != [0.0; 2];
        KeyFigure {
            label: match has_waits {
                true => format!("{}, with waits for pulses", pair.name),
                false => pair.name.clone(),
            },
            value: with_unit(value, &unit),
            below: match (below, pair.a.and(pair.b)) {
                (Some(below), _) => below + &loads(pair),
                (None, Some(_)) => format!("no interval{}", loads(pair)),
                (None, None) if is_of_rest(pair) => {
                    "of one side only; dead band, friction and play rest alike".to_owned()
                }
                (None, None) => "of one side only".to_owned(),
            },
        }
    };
    let mut pairs: Vec<(usize, &QuantityPair)> = (OF_A_MACHINE.iter())
        .chain(&OF_TWO_MACHINES)
        .filter(|kind| !is_at_no_pulse(**kind, models[0], units))
        .filter_map(of_kind)
        .filter(|(_, pair)| pair.a.or(pair.b).is_some())
        .collect();
    // What differs comes first, and what one recording alone determines last.
    pairs.sort_by_key(|(index, pair)| {
        let difference = found
            .bounds
            .valid()
            .and_then(|bounds| bounds.differences.get(*index));
        place_of(pair, difference)
    });
    let [a, b] = models.map(|model| format!("{:.1}", model.fit.held_out_percent));
    let fits = fit_figure(format!("{a} → {b} %"));
    let mut all: Vec<KeyFigure> = pairs.into_iter().map(figure).collect();
    all.truncate(KEY_FIGURES - 1);
    all.push(fits);
    all
}

/// Where a pair of quantities stands among others: 0 where both servos differ in it, 1 where they are not known to, 2 where it is known of one alone. Where
/// there is no interval of the difference they differ where what is known of each does.
fn place_of(pair: &QuantityPair, difference: Option<&QuantityDifference>) -> u8 {
    let interval = difference.and_then(|found| found.difference);
    let bounds = interval.and_then(|interval| interval.lower.zip(interval.upper));
    let apart = known_of(pair.interval_of_one.a, pair.other_fits.a)
        .zip(known_of(pair.interval_of_one.b, pair.other_fits.b))
        .map(|(a, b)| a[1] < b[0] || b[1] < a[0]);
    let visibly = |(a, b): (f64, f64)| (a - b).abs() > VISIBLY * a.abs().max(b.abs());
    match (pair.a.zip(pair.b), bounds) {
        (Some(_), Some((lower, upper))) => u8::from(lower <= 0.0 && upper >= 0.0),
        (Some(both), None) => u8::from(!(visibly(both) && apart.unwrap_or(true))),
        // A servo whose model does without such a term follows to the end, or has no load.
        (None, _) if pair.kind().is_some_and(is_of_a_term) => 0,
        (None, _) => 2,
    }
}

/// The interval of a side, or the range of its other fits.
fn known_of(interval: Option<Interval>, fits: Option<Spread>) -> Option<[f64; 2]> {
    let of_interval = interval.and_then(|of| of.ends());
    of_interval.or(fits.map(|of| [of.least, of.most]))
}

/// Whether a servo without it has none, rather than one that is not known.
fn is_of_a_term(kind: QuantityKind) -> bool {
    matches!(
        kind,
        QuantityKind::DeadBand
            | QuantityKind::Play
            | QuantityKind::RestingError
            | QuantityKind::LoadAtMiddle
            | QuantityKind::SpringOfLoad
            | QuantityKind::LoadOfLevelArm
    )
}
