//! Two servo models beside each other, as text.

use super::play_of_both::{like_play, more_play, play_of_models};
use super::slower_servo::slower;
use crate::data::units::Units;
use crate::presentation::summary::response::metrics::TableRow;
use crate::presentation::summary::servo::clauses::LOOKS_LIKE_A_LOAD;
use crate::presentation::summary::servo::measured_limits::limits_of_strokes_in_words;
use crate::presentation::summary::servo::quantity_table::{
    of_other_fits, scale_and_unit, under_load,
};
use crate::presentation::summary::servo::servo_remarks::stops_in_words;
use crate::presentation::summary::wording::layout::wrapped;
use crate::presentation::summary::wording::numbers::{digits, digits_beside, four_digits, percent};
use crate::presentation::summary::wording::sixty_degrees::{
    both_ways, seconds_per_60_degrees, whole_ms,
};
use servoid_identification::comparison::{
    Comparison, QuantityPair, RestsApart, ServoModelComparison, Sides, SpeedLimitsOfBoth,
};
use servoid_identification::nonlinear::SpeedLimits;
use servoid_identification::results::{Bounds, Interval, with_unit};
use servoid_identification::servo_model::{QuantityKind, Spread, Stops, Unit};

/// Quantities that a sentence names at the most; the table has them all.
const NAMED: usize = 4;

/// What rests that differ leave open where no play of the machines differs for sure.
const RESTS_LEAVE_OPEN: &str = "Rests alone do not show which of the two is worn, as strokes of another size may turn their difference round, and no play of these models differs for sure; it can be felt at the horn of a servo that holds. The worn one is to be replaced where what differs here is more than its use allows.";

/// A sentence on what differs for sure, and on a load that one model alone has; `a` and `b` are the names of the two, of which `step_responses` are compared as well, if they are.
#[must_use]
pub fn sentence_on_servo_models(
    a: &str,
    b: &str,
    found: &ServoModelComparison,
    step_responses: Option<&Comparison>,
    units: Units<'_>,
) -> String {
    let differences = differences(a, b, found, units);
    let known = found.rests_apart.is_known();
    let by_models = play_of_models(a, b, found, units);
    let more_play = more_play(a, b, found, units);
    let may_be_open = !found.rests_apart.differ() && by_models.is_none() && more_play.is_none();
    let like_play = like_play(a, b, found, units);
    let is_asked = like_play.is_none() && differences.is_empty();
    let play = (may_be_open && (known || is_asked))
        .then(|| (found.rests_apart).nothing_sure_in_words([a, b], units.output.unwrap_or("")));
    let by_responses = || step_responses?.worn_in_words([a, b]);
    let by_rests = || (found.rests_apart.differ()).then(|| RESTS_LEAVE_OPEN.to_owned());
    let worn = more_play.or_else(by_responses).or_else(by_rests);
    let sentences = [
        Some(what_is_sure(a, b, found, differences)),
        worn,
        slower(a, b, found),
        by_models,
        like_play,
        play,
        load_of_one(a, b, found, units),
        speeds_of_both([a, b], found, units),
        strokes_of_both(a, b, found),
        behind_pulses(a, b, found),
    ];
    let sentences: Vec<String> = sentences.into_iter().flatten().collect();
    sentences.join(" ")
}

/// How fast the larger strokes are, as they were measured, which needs no model.
fn speeds_of_both(
    names: [&str; 2],
    found: &ServoModelComparison,
    units: Units<'_>,
) -> Option<String> {
    let speeds = found.speed_limits?;
    let of = |name: &str, limits: SpeedLimits| {
        let both = [limits.upwards, limits.downwards];
        let words = limits_of_strokes_in_words(both, units);
        words.map(|words| format!("at about {words} in {name}"))
    };
    let [a, b] = [of(names[0], speeds.a)?, of(names[1], speeds.b)?];
    Some(format!(
        "By the recordings larger strokes go {a}, and {b}: these have no intervals, and strokes that are larger on one side make a tenth and more of a difference by themselves."
    ))
}

/// That delays count from pulses, where commands waited for them.
fn behind_pulses(a: &str, b: &str, found: &ServoModelComparison) -> Option<String> {
    let waits = found.waits_for_pulses;
    let of = match (waits.a, waits.b) {
        (Some(_), Some(_)) => "both".to_owned(),
        (Some(_), None) => a.to_owned(),
        (None, Some(_)) => b.to_owned(),
        (None, None) => return None,
    };
    Some(format!(
        "Commands of {of} waited for pulses on a clock of their own: the delay as a machine counts from the pulse, and times and shifts of step responses have the waits in them."
    ))
}

/// How long a stroke takes, which people decide by.
fn strokes_of_both(a: &str, b: &str, found: &ServoModelComparison) -> Option<String> {
    let stroke = found.stroke?;
    let [of_a, of_b] = [both_ways(stroke.a_s?), both_ways(stroke.b_s?)];
    let may_be_off = match found.bounds.withdrawn() {
        Some(_) => ", whose figures may be off by more than this differs,",
        None => "",
    };
    Some(format!(
        "By the models{may_be_off} a stroke of 60 degrees takes {of_a} in {a}, and {of_b} in {b}, until it stays within 2 % of its end; no interval of these times is known, and one that overshoots may take longer than a slower one."
    ))
}

/// That an interval shows a load in one model, and the other one has none. One that no interval shows may stand for anything else that the model lacks.
fn load_of_one(a: &str, b: &str, found: &ServoModelComparison, units: Units<'_>) -> Option<String> {
    let is_load = |pair: &&QuantityPair| {
        pair.kind()
            .is_some_and(|kind| QuantityKind::OF_LOAD.contains(&kind))
    };
    let loads = || found.quantities.iter().filter(is_load);
    let [has_a, has_b] = [
        loads().any(|pair| pair.a.is_some()),
        loads().any(|pair| pair.b.is_some()),
    ];
    let (with, without) = match (has_a, has_b) {
        (true, false) => (a, b),
        (false, true) => (b, a),
        _ => return None,
    };
    let differences = &found.bounds.valid()?.differences;
    let sure = |pair: &&QuantityPair| {
        let ends = differences.iter().find(|of| of.name == pair.name);
        let interval = ends.and_then(|ends| if has_a { ends.a } else { ends.b });
        interval.is_some_and(|interval| !interval.contains(0.0))
    };
    let sure: Vec<&QuantityPair> = loads().filter(sure).collect();
    let in_words = |pair: &&QuantityPair| {
        let (scale, unit) = scale_and_unit(pair.unit, units);
        let value = if has_a { pair.a } else { pair.b }?;
        let value = with_unit(four_digits(scale * value), &unit);
        Some(format!("{} {value}", pair.name))
    };
    let words: Vec<String> = sure.iter().filter_map(in_words).collect();
    let looks_like_it = match sure.as_slice() {
        [one] if one.kind() == Some(QuantityKind::LoadAtMiddle) => {
            format!("; {LOOKS_LIKE_A_LOAD}")
        }
        _ => String::new(),
    };
    (!words.is_empty()).then(|| {
        format!(
            "The model of {with} has a load ({}{looks_like_it}), and in that of {without} none shows.",
            words.join(", ")
        )
    })
}

/// What differs for sure, each in a few words: what the recordings show by themselves, then what the models say.
fn differences(a: &str, b: &str, found: &ServoModelComparison, units: Units<'_>) -> Vec<String> {
    let rests = (found.rests_apart).difference_in_words([a, b], units.output.unwrap_or(""));
    let stops = found.stops.filter(|stops| stops.differ).map(|stops| {
        let [of_a, of_b] = [stops.a, stops.b].map(|of| stops_or_none(of, units));
        format!("{of_a} in {a}, {of_b} in {b}")
    });
    let bounds = found.bounds.valid();
    let of_models = bounds.map_or(&[][..], |bounds| &bounds.differences);
    let sure = (found.quantities.iter().zip(of_models))
        .filter(|(_, difference)| difference.is_sure())
        .filter_map(|(pair, _)| Some((pair.name.as_str(), in_words(a, b, pair, units)?)));
    let sure = as_of_one_direction(sure.collect());
    rests.into_iter().chain(stops).chain(sure).collect()
}

/// Names and values in words, each with the other direction once where its values are the same.
fn as_of_one_direction(all: Vec<(&str, String)>) -> Vec<String> {
    let has = |what: &str, direction: &str, values: &str| {
        let same = |(name, own): &(&str, String)| {
            name.strip_suffix(direction) == Some(what) && own == values
        };
        all.iter().any(same)
    };
    let once = |(name, values): &(&str, String)| {
        let of = |direction: &str| name.strip_suffix(direction);
        match (of(" upwards"), of(" downwards")) {
            (Some(what), _) if has(what, " downwards", values) => Some(format!("{what} {values}")),
            (_, Some(what)) if has(what, " upwards", values) => None,
            _ => Some(format!("{name} {values}")),
        }
    };
    all.iter().filter_map(once).collect()
}

/// That they differ, or that it is not known. It is said of the recordings: their bounds are those of noise, and no servo is the same in two runs.
fn what_is_sure(
    a: &str,
    b: &str,
    found: &ServoModelComparison,
    differences: Vec<String>,
) -> String {
    let count = differences.len();
    let rest = match count > NAMED {
        true => format!("; and {} more", count - NAMED),
        false => String::new(),
    };
    let named: Vec<String> = differences.into_iter().take(NAMED).collect();
    let named = named.join("; ") + &rest;
    match &found.bounds {
        Bounds::Withdrawn(reason) => {
            let of_sides = found.without_bounds.in_words([a, b]);
            let because = format!(
                "because {}; the values stand without intervals",
                of_sides.unwrap_or_else(|| reason.because().to_owned())
            );
            match count {
                0 => format!("As machines: no statement about the difference, {because}."),
                _ => format!(
                    "As machines {a} and {b} differ in these recordings: {named}. No statement about other differences, {because}."
                ),
            }
        }
        Bounds::Valid(_) if count == 0 && !found.compares() => format!(
            "As machines nothing is compared: the recordings determine no quantity of both {a} and {b}."
        ),
        Bounds::Valid(bounds) if count == 0 => format!(
            "As machines: no quantity of {a} and {b} is shown to differ ({} % intervals).",
            percent(bounds.level)
        ),
        Bounds::Valid(bounds) => format!(
            "As machines {a} and {b} differ in these recordings, each quantity by itself at {} % and however little: {named}. What differs from run to run is \
             not included.",
            percent(bounds.level)
        ),
    }
}

/// "10.3 ms in A, 12.1 ms in B"
fn in_words(a: &str, b: &str, pair: &QuantityPair, units: Units<'_>) -> Option<String> {
    let (scale, unit) = scale_and_unit(pair.unit, units);
    let shown = |value: f64| {
        let turn = (pair.unit == Unit::OutputPerSecond)
            .then(|| seconds_per_60_degrees(value, units))
            .flatten();
        let turn = turn.map_or_else(String::new, |turn| format!(" ({turn})"));
        with_unit(four_digits(scale * value), &unit) + &turn
    };
    let (of_a, of_b) = (shown(pair.a?), shown(pair.b?));
    Some(format!("{of_a} in {a}, {of_b} in {b}"))
}

/// "a stop at 6 deg", "no stop"
fn stops_or_none(stops: Stops, units: Units<'_>) -> String {
    stops_in_words(stops, units).unwrap_or_else(|| "no stop".to_owned())
}

/// Width of a column of the table \[letters\].
const COLUMN: usize = 21;

/// The letter of a side, with the name of its file where the column has room for it.
fn head_of_side(letter: char, name: &str) -> String {
    let file = match name.split(", ").count() {
        1 => name.rsplit(['/', '\\']).next().unwrap_or(name).to_owned(),
        files => format!("{files} files"),
    };
    let both = format!("{letter}  {file}");
    match both.chars().count() <= COLUMN {
        true => both,
        false => letter.to_string(),
    }
}

/// The servos A and B of the files `names` quantity by quantity, with what is sure about their difference.
#[must_use]
pub fn of_servo_models(names: [&str; 2], found: &ServoModelComparison, units: Units<'_>) -> String {
    let [a, b] = [head_of_side('A', names[0]), head_of_side('B', names[1])];
    let difference = found.bounds.valid().map_or("", |_| "difference");
    let below = what_is_below(found);
    let head = format!("  {below:34} {a:>COLUMN$} {b:>COLUMN$} {difference:>COLUMN$}");
    let mut text = format!("\n{}\n", head.trim_end());
    for row in servo_model_rows(found, units) {
        let line = |label: &str, cells: Vec<&str>| {
            let cells: String = cells
                .iter()
                .map(|cell| format!(" {cell:>COLUMN$}"))
                .collect();
            format!("{}\n", format!("  {label:34}{cells}").trim_end())
        };
        let cells = row.cells.iter().map(|(v, i)| (v.as_str(), i.as_str()));
        let (values, intervals): (Vec<&str>, Vec<&str>) = cells.unzip();
        text += &line(&row.label, values);
        if intervals.iter().any(|interval| !interval.is_empty()) {
            text += &line("", intervals);
        }
    }
    text + &format!(
        "\n  {}\n",
        wrapped(&how_servo_models_are_compared(found), 2)
    )
}

/// What stands below the figures: intervals, or other fits, which nobody is to take for any.
pub(crate) fn what_is_below(found: &ServoModelComparison) -> String {
    match found.bounds.valid() {
        Some(bounds) => format!("{} % intervals below", percent(bounds.level)),
        None if has_interval_of_one(found) => {
            "intervals (..), or by how much other fits are off, below".to_owned()
        }
        None => "no intervals; below, how far other fits are off".to_owned(),
    }
}

/// Whether one side has intervals, and the other one none.
fn has_interval_of_one(found: &ServoModelComparison) -> bool {
    let mut pairs = found.quantities.iter();
    pairs.any(|pair| pair.interval_of_one != Sides::default())
}

/// The way the differences were computed.
pub(crate) fn how_servo_models_are_compared(found: &ServoModelComparison) -> String {
    let angles = match found.at_other_angles && found.bounds.valid().is_some() {
        true => {
            " Where a load changes with the angle, speed, acceleration and load are those at the middle of the commands of each side, and these middles differ here: the \
             intervals of their differences contain what that makes."
        }
        false => "",
    };
    let how = match found.bounds {
        Bounds::Valid(_) if found.shared_delay_error => {
            "Difference: second less first, from the ends of both intervals, but of the delay without the time by which commands or \
             positions were recorded earlier or later in both: it is one and the same where both were recorded in one way. It holds wherever both hold, and \
             is wider than independent recordings would need."
        }
        Bounds::Valid(_) => {
            "Difference: second less first, from the ends of both intervals: it holds wherever both hold, and is wider than independent \
             recordings would need."
        }
        Bounds::Withdrawn(_) => {
            "Without intervals on both sides nothing is said about the difference. \"Other fits up to …\" is how far these are from the figure, and no interval: what a model lacks is in all of them, and it may be off by less, or by several times as much."
        }
    };
    let longest_s = found.waits_s[0].max(found.waits_s[1]);
    let waits = match longest_s > 0.0 && found.bounds.valid().is_some() {
        true => format!(
            " Of the delay it contains that each recording may have its own wait for pulses of another clock, by which delays differ by up to {:.0} ms (--exact-command states that no command waits).",
            1e3 * longest_s
        ),
        false => String::new(),
    };
    let stroke = match found
        .stroke
        .is_some_and(|stroke| stroke.a_s.is_some() != stroke.b_s.is_some())
    {
        true => {
            " Where a stroke has no time, that recording does not show how the servo would end it (it has none so large, and no top speed), or by its model the servo does not."
        }
        false => "",
    };
    let rests = match has_dead_band_of_one_side(found) {
        true => {
            " A dead band and friction rest alike: the dead band of one model may be friction in the other."
        }
        false => "",
    };
    format!("{how}{waits}{angles}{stroke}{rests}")
}

/// Whether one model alone has a dead band, and the other one friction.
fn has_dead_band_of_one_side(found: &ServoModelComparison) -> bool {
    let of_kind = |kind| {
        let mut all = found.quantities.iter();
        all.find(|pair| pair.kind() == Some(kind))
    };
    let dead_band = of_kind(QuantityKind::DeadBand);
    let friction = of_kind(QuantityKind::RestingError);
    dead_band
        .zip(friction)
        .is_some_and(|(dead_band, friction)| {
            dead_band.a.is_none() && friction.a.is_some()
                || dead_band.b.is_none() && friction.b.is_some()
        })
}

/// Each quantity: value and interval of both, and of the difference where both have intervals.
pub(crate) fn servo_model_rows(found: &ServoModelComparison, units: Units<'_>) -> Vec<TableRow> {
    let bounds = found.bounds.valid();
    let of_a = |pair: &QuantityPair| pair.kind().filter(|_| pair.a.is_some());
    let of_b = |pair: &QuantityPair| pair.kind().filter(|_| pair.b.is_some());
    let [kinds_of_a, kinds_of_b]: [Vec<QuantityKind>; 2] = [
        found.quantities.iter().filter_map(of_a).collect(),
        found.quantities.iter().filter_map(of_b).collect(),
    ];
    let row = |(index, pair): (usize, &QuantityPair)| {
        let (scale, unit) = scale_and_unit(pair.unit, units);
        let width = |interval: Option<Interval>| Some(scale * interval?.width()?);
        // Without intervals, digits far below what the two sides are apart say nothing.
        let apart = pair.a.zip(pair.b).map(|(a, b)| scale * (a - b).abs());
        let shown = |value: Option<f64>, interval: Option<Interval>| {
            let digits = |v| match bounds.is_some() || interval.is_some() {
                true => digits_beside(scale * v, 4, width(interval)),
                false => digits_beside(scale * v, 3, apart),
            };
            value.map_or("-".to_owned(), digits)
        };
        let in_unit = |value: Option<f64>, interval: Option<Interval>| {
            let unit = value.map_or("", |_| &unit);
            with_unit(shown(value, interval), unit)
        };
        let ends = |interval: Option<Interval>, value: Option<f64>| match interval {
            // What a record leaves open has ends that nobody reads.
            Some(found) if value.is_some() && found.lower.or(found.upper).is_some() => {
                let [lower, upper] = [found.lower, found.upper].map(|end| shown(end, interval));
                format!("{lower} .. {upper}")
            }
            Some(_) if value.is_none() => "not determined".to_owned(),
            _ => String::new(),
        };
        let other_fits = |of: Option<Spread>, value: Option<f64>| {
            of_other_fits(scale * of?.farthest_from(value?))
        };
        let sure = bounds.and_then(|bounds| bounds.differences.get(index));
        let [of_a, of_b, apart] = match sure {
            Some(found) => [found.a, found.b, found.difference],
            None => [pair.interval_of_one.a, pair.interval_of_one.b, None],
        };
        let below = |of: Option<Interval>, value, fits, kinds: &[QuantityKind]| {
            let ends = match bounds.is_some() || of.is_some() {
                true => ends(of, value),
                false => other_fits(fits, value).unwrap_or_default(),
            };
            let load = under_load(pair.kind(), kinds.iter().copied()).filter(|_| value.is_some());
            let parts = [Some(ends), load.map(str::to_owned)].into_iter().flatten();
            let parts: Vec<String> = parts.filter(|part| !part.is_empty()).collect();
            parts.join(", ")
        };
        let mut cells = vec![
            (
                in_unit(pair.a, of_a),
                below(of_a, pair.a, pair.other_fits.a, &kinds_of_a),
            ),
            (
                in_unit(pair.b, of_b),
                below(of_b, pair.b, pair.other_fits.b, &kinds_of_b),
            ),
        ];
        if bounds.is_some() {
            let less = apart.map_or_else(String::new, |found| in_unit(found.value, apart));
            cells.push((less, ends(apart, apart.and_then(|found| found.value))));
        }
        TableRow {
            label: pair.name.clone(),
            cells,
        }
    };
    let mut rows: Vec<TableRow> = found.quantities.iter().enumerate().map(row).collect();
    rows.extend(speed_rows(found, units));
    rows.extend(stroke_rows(found));
    rows.extend(row_of_rests(found, units));
    rows.extend(found.stops.map(|stops| {
        let in_words = |of: Stops| (stops_or_none(of, units), String::new());
        let mut cells = vec![in_words(stops.a), in_words(stops.b)];
        cells.extend(bounds.map(|_| Default::default()));
        TableRow {
            label: "stops".to_owned(),
            cells,
        }
    }));
    rows
}

/// How far apart rests under one command are, with the intervals that their scatter gives, whatever the models say.
fn row_of_rests(found: &ServoModelComparison, units: Units<'_>) -> Option<TableRow> {
    let RestsApart {
        a, b, difference, ..
    } = found.rests_apart;
    a.or(b)?;
    let cell = |of: Option<Interval>| {
        let Some((of, value)) = of.and_then(|of| Some((of, of.value?))) else {
            return ("-".to_owned(), "not shown".to_owned());
        };
        let [value, lower, upper] = [Some(value), of.lower, of.upper]
            .map(|number| number.map_or_else(String::new, |v| digits_beside(v, 3, of.width())));
        let value = with_unit(value, units.output.unwrap_or(""));
        (value, format!("{lower} .. {upper}"))
    };
    let mut cells = vec![cell(a), cell(b)];
    cells.extend(found.bounds.valid().map(|_| cell(difference)));
    Some(TableRow {
        label: "rests under one command, apart".to_owned(),
        cells,
    })
}

/// How fast the larger strokes of each recording are, each way; no interval is known of that.
fn speed_rows(found: &ServoModelComparison, units: Units<'_>) -> Vec<TableRow> {
    let Some(SpeedLimitsOfBoth { a, b }) = found.speed_limits else {
        return Vec::new();
    };
    let (scale, unit) = scale_and_unit(Unit::OutputPerSecond, units);
    let cell = |speed: Option<f64>| {
        let words = |speed| with_unit(digits(scale * speed, 2), &unit);
        (speed.map_or("-".to_owned(), words), String::new())
    };
    let both = [
        ("upwards", a.upwards, b.upwards),
        ("downwards", a.downwards, b.downwards),
    ];
    let is_known = |(_, a, b): &(&str, Option<f64>, Option<f64>)| a.or(*b).is_some();
    let row = |(way, a, b): (&str, Option<f64>, Option<f64>)| TableRow {
        label: format!("speed of larger strokes {way}"),
        cells: vec![cell(a), cell(b)],
    };
    both.into_iter().filter(is_known).map(row).collect()
}

/// How long a stroke of 60 degrees takes, each way; no interval is known of that.
fn stroke_rows(found: &ServoModelComparison) -> Vec<TableRow> {
    let Some(stroke) = found.stroke else {
        return Vec::new();
    };
    let ms = |time_s: Option<f64>| {
        let time = time_s.map_or("-".to_owned(), |time_s| format!("{} ms", whole_ms(time_s)));
        (time, String::new())
    };
    let row = |(way, name): (usize, &str)| {
        let of = |times: Option<[f64; 2]>| times.and_then(|both| both.get(way).copied());
        let (a_s, b_s) = (of(stroke.a_s), of(stroke.b_s));
        let mut cells = vec![ms(a_s), ms(b_s)];
        if found.bounds.valid().is_some() {
            let apart = a_s.zip(b_s).map(|(a_s, b_s)| b_s - a_s);
            cells.push(apart.map_or_else(Default::default, |apart| ms(Some(apart))));
        }
        TableRow {
            label: format!("stroke of 60 degrees {name}"),
            cells,
        }
    };
    [(0, "upwards"), (1, "downwards")]
        .into_iter()
        .map(row)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_identification::comparison::{
        QuantityDifference, QuantityDifferences, StrokeTimes,
    };
    use servoid_identification::results::Reason;

    /// Of loads `a` and `b`, the latter with an interval or without.
    fn sentence(a: Option<f64>, b: Option<f64>, of_b: Option<Interval>) -> String {
        let bounds = of_b.map(|of_b| QuantityDifferences {
            level: 0.99,
            differences: vec![QuantityDifference {
                name: QuantityKind::LoadAtMiddle.name().to_owned(),
                a: None,
                b: Some(of_b),
                difference: None,
            }],
        });
        let found = ServoModelComparison {
            quantities: vec![QuantityPair {
                name: QuantityKind::LoadAtMiddle.name().to_owned(),
                unit: Unit::Command,
                a,
                b,
                other_fits: Sides::default(),
                interval_of_one: Sides::default(),
            }],
            stops: None,
            rests_apart: RestsApart::default(),
            speed_limits: None,
            shared_delay_error: false,
            waits_s: [0.0; 2],
            rmse: Sides::default(),
            at_other_angles: false,
            stroke: Some(StrokeTimes {
                size: 60.0,
                a_s: Some([0.239, 0.171]),
                b_s: b.map(|_| [0.2, 0.2001]),
            }),
            bounds: bounds.map_or(Bounds::Withdrawn(Reason::ErrorsNotNoise), Bounds::Valid),
            without_bounds: Sides::default(),
            waits_for_pulses: Sides::default(),
        };
        let units = Units {
            input: Some("deg"),
            output: Some("deg"),
        };
        sentence_on_servo_models("A", "B", &found, None, units)
    }

    #[test]
    fn what_is_the_same_in_both_directions_is_said_once() {
        let said = |all: &[(&'static str, &str)]| {
            let all = all
                .iter()
                .map(|(name, values)| (*name, (*values).to_owned()));
            as_of_one_direction(all.collect())
        };
        let (up, down) = ("top speed upwards", "top speed downwards");
        let (same, other) = (
            "600 deg/s in A, 480 deg/s in B",
            "590 deg/s in A, 470 deg/s in B",
        );
        assert_eq!(
            said(&[("delay", "4 ms in A, 5 ms in B"), (up, same), (down, same)]),
            [
                "delay 4 ms in A, 5 ms in B".to_owned(),
                format!("top speed {same}")
            ]
        );
        assert_eq!(
            said(&[(up, same), (down, other)]),
            [format!("{up} {same}"), format!("{down} {other}")]
        );
    }

    #[test]
    fn a_load_that_an_interval_shows_in_one_model_alone_is_named() {
        let of =
            "(load at the middle 0.2042 deg; a drive that is weaker to one side looks the same)";
        let times = "By the models a stroke of 60 degrees takes 239 ms upwards and 171 ms downwards in A, and 200 ms in B, until it stays within 2 % of its end; no interval of these times is known, and one that overshoots may take longer than a slower one.";
        let ends = |lower: f64| Some(Interval::new(0.2042, lower, 0.3));
        let loaded = sentence(None, Some(0.2042), ends(0.1));
        let said = format!("The model of B has a load {of}, and in that of A none shows. {times}");
        assert!(loaded.ends_with(&said), "{loaded}");
        assert!(!sentence(Some(0.3), None, None).contains("a stroke of 60"));
        for others in [
            sentence(None, Some(0.2042), ends(-0.1)),
            sentence(None, Some(0.2042), None),
            sentence(Some(0.3), Some(0.2), ends(0.1)),
            sentence(None, None, None),
        ] {
            assert!(!others.contains("has a load"), "{others}");
        }
    }
}
