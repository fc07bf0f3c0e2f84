//! The servo as a machine, as text for a terminal.

use super::layout::wrapped;
use super::numbers::head_of_bounds;
use crate::data::model_file::ServoModelDocument;
use crate::data::units::Units;
use servoid_identification::results::{Bounds, Interval, Reason, with_unit};
use servoid_identification::servo_model::{
    LadderRung, LinearKind, LinearModelFit, LinearModels, LoadKind, Quantity, QuantityKind,
    ServoFit, ServoModel, Spread, Stops, Terms, Unit,
};

/// Parameters with their intervals; with `explain`, the terms that were tried.
#[must_use]
pub fn of_servo_model(document: &ServoModelDocument, units: Units<'_>, explain: bool) -> String {
    let model = &document.model;
    let level = model.covariance.as_ref().map(|covariance| covariance.level);
    let mut text = format!(
        "\nservo model: {}\n  fit {:.2} %; of parts that it had not seen {:.2} % (a linear servo of second order: {:.2} %)\n",
        terms_in_words(model.terms),
        model.fit.simulation_percent,
        model.fit.held_out_percent,
        model.fit.linear_held_out_percent
    );
    if let Bounds::Withdrawn(reason) = &level {
        text += &format!("  ! NO INTERVALS CAN BE GIVEN: {}\n", reason.because());
    }
    if !model.alternatives.is_empty() {
        text += &format!(
            "  {} other sets of terms predict as well: the intervals hold for all of them\n",
            model.alternatives.len()
        );
    }
    if let Some(sentence) = run_offsets_in_words(model, units) {
        text += &format!("  {}\n", wrapped(&sentence, 2));
    }
    if let Some(sentence) = stops_in_words(model.stops, units) {
        text += &format!("  {sentence}\n");
    }
    text += &quantities(&model.quantities, level, units);
    if let Some(sentence) = whole_stroke(model, units) {
        text += &format!("  {}\n", wrapped(&sentence, 2));
    }
    if let Some(sentence) = whose_controller(document) {
        text += &format!("  {}\n", wrapped(&sentence, 2));
    }
    for advice in advice_on_servo_model(model) {
        text += &format!("  {}\n", wrapped(advice, 2));
    }
    if explain {
        text +=
            "\n  terms that were tried: fit of parts that they had not seen, and of the whole\n";
        text.extend(model.ladder.iter().map(rung));
        text.extend(
            model
                .linear_models
                .as_ref()
                .map(|found| linear_models(found, &model.fit)),
        );
    }
    text
}

/// Which controller the quantities are of, and how much stiffer the others are, where there are several.
fn whose_controller(document: &ServoModelDocument) -> Option<String> {
    let (first, others) = document.controller_names.split_first()?;
    let stiffness = |number: usize| document.model.parameters(number).stiffness;
    let other = |(name, number): (&f64, usize)| {
        let times = stiffness(number) / stiffness(0);
        format!("{name} is {} times as stiff", digits(times, 3))
    };
    let others: Vec<String> = others.iter().zip(1..).map(other).collect();
    (!others.is_empty()).then(|| format!(
        "Bandwidth, damping ratio, error of full drive and what is left at rest are those with the controller {first}; {}.",
        others.join(", ")
    ))
}

/// Where the servo stops.
pub(super) fn stops_in_words(stops: Stops, units: Units<'_>) -> Option<String> {
    let at = |end: f64| with_unit(four_digits(end), units.output.unwrap_or_default());
    match [stops.lower, stops.upper].map(|end| end.map(at)) {
        [None, None] => None,
        [Some(lower), Some(upper)] => Some(format!("stops at {lower} and {upper}")),
        [end, None] | [None, end] => Some(format!("a stop at {}", end.unwrap_or_default())),
    }
}

/// That each run has an offset of its own, and how far these lie from their mean.
pub(crate) fn run_offsets_in_words(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let ends = |end: fn(f64, f64) -> f64| model.run_offsets.iter().copied().reduce(end);
    let (least, most) = ends(f64::min).zip(ends(f64::max))?;
    let unit = units.output.map(|unit| format!(" {unit}"));
    Some(format!(
        "The {} runs rest at different positions: each has an offset of its own, {least:+.3} to {most:+.3}{} from their mean, which is \
         the offset here.",
        model.run_offsets.len(),
        unit.unwrap_or_default()
    ))
}

/// What to say below the quantities of a servo model.
pub(crate) fn advice_on_servo_model(model: &ServoModel) -> Vec<&'static str> {
    match model.is_linear() && model.covariance.valid().is_some() {
        true => vec![LINEAR_IS_SHARPER],
        false => {
            let mut advice = what_to_record(&model.quantities);
            advice.extend(holds_alike(model).then_some(STAIRS_DO_NOT_SEPARATE));
            advice
        }
    }
}

/// Whether the record leaves open how a servo is held off its command: by a dead band, which stands still at its edge, or by friction.
fn holds_alike(model: &ServoModel) -> bool {
    let is_held = model.terms.dead_band || model.terms.friction;
    let is_open = |found: &Quantity| {
        let of_friction = |kind| QuantityKind::OF_FRICTION.contains(&kind);
        !found.determined && found.kind().is_some_and(of_friction)
    };
    let misses = model.covariance.withdrawn() == Some(Reason::ErrorsNotNoise);
    is_held && (misses || model.quantities.iter().any(is_open))
}

/// Said of a servo that a dead band or friction holds, where the record does not show which.
const STAIRS_DO_NOT_SEPARATE: &str = "Dead band and friction rest alike, and stairs hardly distinguish them: a large slow motion that goes on does, such as \
    --reference multisine --amplitude 30 --frequencies 0.1:3 --length 20, as far as the travel allows.";

/// Said of a servo model without any term beyond a linear servo.
const LINEAR_IS_SHARPER: &str = "This recording needs no more than a linear servo: where the linear model has intervals, they are \
    narrower. Those here also hold for limits, friction and loads that the recording leaves open.";

/// The table of the linear models beside the servo model.
fn linear_models(found: &LinearModels, fit: &ServoFit) -> String {
    let samples = match found.samples_used == fit.samples_used {
        true => "all samples".to_owned(),
        false => format!(
            "the {} of {} samples that all predict",
            found.samples_used, fit.samples_used
        ),
    };
    let mut text = format!(
        "\n  linear models beside it, each identified again without the parts that it predicts: fit on {samples}\n"
    );
    let row = |percent: f64, name: &str| format!("  {percent:7.2} %  {name}\n");
    text += &row(found.servo_model_percent, "this servo model");
    let name = |kind: LinearKind| match kind {
        LinearKind::Linear => "linear model",
        LinearKind::DirectionSplit => "linear model of strokes up, and of strokes down",
    };
    let of = |model: &LinearModelFit| row(model.held_out_percent, name(model.kind));
    text.extend(found.models.iter().map(of));
    text
}

/// The table of quantities with its head.
pub(crate) fn quantities(all: &[Quantity], level: Bounds<f64>, units: Units<'_>) -> String {
    let head = head_of_bounds(level);
    let mut text = format!("  {:34} {:>12} {:8} {head}\n", "", "value", "");
    let rows = quantity_rows(all, units).into_iter();
    text.extend(rows.map(|(quantity, found)| row(&found, per_60_degrees(quantity, units))));
    text
}

/// Said of a quantity that the record leaves open.
const NOT_DETERMINED: &str = "not determined by this recording";

/// An interval whose ends are so far apart says nothing.
const WORTH_PRINTING: f64 = 1000.0;

/// Quantities that a recording may leave open, and what would show them: in a few words, and as advice.
const WHAT_SHOWS: [(&[QuantityKind], &str, &str); 3] = [
    (
        QuantityKind::OF_LIMIT,
        "large strokes show it",
        "Top speed and acceleration show in large strokes: record steps over most of the travel, each held until the servo rests.",
    ),
    (
        QuantityKind::OF_SMALL_SIGNALS,
        "small quick strokes show it",
        "Bandwidth and damping show in small quick strokes: record steps or random levels of a few degrees, sampled every 5 ms or faster.",
    ),
    (
        &[
            QuantityKind::DeadBand,
            QuantityKind::RestingError,
            QuantityKind::FrictionAtRest,
            QuantityKind::FrictionOfGears,
            QuantityKind::LoadAtMiddle,
            QuantityKind::LoadOfLevelArm,
            QuantityKind::Gain,
            QuantityKind::Offset,
        ],
        "rests at many levels show it",
        "Friction, dead band, load and gain show at rest: record stairs of at least four levels, each reached from both sides and held until the servo rests.",
    ),
];

/// What to record for the quantities that this recording leaves open.
fn what_to_record(quantities: &[Quantity]) -> Vec<&'static str> {
    let open = |kinds: &&[QuantityKind]| {
        let left_open = quantities.iter().filter(|found| !found.determined);
        let mut left_open = left_open.filter_map(Quantity::kind);
        left_open.any(|kind| kinds.contains(&kind))
    };
    WHAT_SHOWS
        .iter()
        .filter(|(kinds, ..)| open(kinds))
        .map(|(.., advice)| *advice)
        .collect()
}

/// What would show a quantity of this kind, in a few words.
pub(super) fn shown_by(kind: QuantityKind) -> Option<&'static str> {
    let mut all = WHAT_SHOWS.iter();
    let found = all.find(|(kinds, ..)| kinds.contains(&kind));
    found.map(|(_, words, _)| *words)
}

/// The load that the number of a quantity is for, behind its name, where there is a load among `all`: speeds are those under the load in
/// the middle of the commands, and accelerations those of the drive alone.
pub(super) fn under_load(
    kind: Option<QuantityKind>,
    mut all: impl Iterator<Item = QuantityKind>,
) -> &'static str {
    let of_kind = match kind {
        Some(QuantityKind::TopSpeedUpwards | QuantityKind::TopSpeedDownwards) => ", under load",
        Some(QuantityKind::AccelerationUpwards | QuantityKind::AccelerationDownwards) => {
            ", no load"
        }
        _ => return "",
    };
    if all.any(|kind| QuantityKind::OF_LOAD.contains(&kind)) {
        of_kind
    } else {
        ""
    }
}

/// A quantity as a row of a table.
pub(crate) struct QuantityRow {
    /// What it is.
    pub name: String,
    /// The number; "-" where the record does not determine it.
    pub value: String,
    /// The unit that people use.
    pub unit: String,
    /// Its interval, or that the record does not determine it; without intervals, how far other fits go apart.
    pub interval: String,
}

impl QuantityRow {
    /// "delay 21.60 ms (21.10 .. 22.04)".
    pub(crate) fn in_words(&self) -> String {
        let value = format!("{} {} {}", self.name, self.value, self.unit);
        match self.interval.is_empty() {
            true => value.trim_end().to_owned(),
            false => format!("{} ({})", value.trim_end(), self.interval),
        }
    }
}

/// The quantities of a servo as rows.
pub(crate) fn quantity_rows<'q>(
    all: &'q [Quantity],
    units: Units<'_>,
) -> Vec<(&'q Quantity, QuantityRow)> {
    let row = |quantity: &'q Quantity| {
        let load = under_load(quantity.kind(), all.iter().filter_map(Quantity::kind));
        let name = format!("{}{load}", quantity.name);
        let row = quantity_row(quantity, units);
        (quantity, QuantityRow { name, ..row })
    };
    all.iter().map(row).collect()
}

/// A quantity in the units that people use.
fn quantity_row(quantity: &Quantity, units: Units<'_>) -> QuantityRow {
    let (scale, unit) = scale_and_unit(quantity.unit, units);
    let width = |least: f64, most: f64| scale * (most - least);
    let known = quantity.interval.valid();
    let known = known.and_then(|found| found.lower.zip(found.upper));
    let fits = quantity.other_fits;
    let fits = fits.map(|Spread { least, most }| width(least, most));
    // How sure the last digits are is not known without an interval.
    let shown = |value: f64| match quantity.interval.valid() {
        Some(_) => digits_beside(scale * value, 4, known.map(|(low, high)| width(low, high))),
        None => digits_beside(scale * value, 3, fits),
    };
    let interval = quantity.interval.valid().map(|found: &Interval| {
        let end = |bound: Option<f64>| bound.map_or("-".to_owned(), shown);
        match (quantity.determined, found.lower, found.upper) {
            (false, None, None) => NOT_DETERMINED.to_owned(),
            (true, None, None) => String::new(),
            (true, lower, upper) => format!("{} .. {}", end(lower), end(upper)),
            (false, Some(lower), None) if lower <= 0.0 => NOT_DETERMINED.to_owned(),
            (false, Some(lower), None) => {
                let least = with_unit(shown(lower), &unit);
                format!("{NOT_DETERMINED}: {least} or more")
            }
            (false, lower, upper) => match lower.zip(upper) {
                Some((lower, upper)) if upper < WORTH_PRINTING * lower => {
                    let range = format!("{} .. {}", shown(lower), shown(upper));
                    format!("{NOT_DETERMINED}: {}", with_unit(range, &unit))
                }
                _ => NOT_DETERMINED.to_owned(),
            },
        }
    });
    let value = match quantity.determined {
        true => shown(quantity.value),
        false => "-".to_owned(),
    };
    let spread = quantity.other_fits.filter(|_| quantity.determined);
    let spread = spread
        .map(|Spread { least, most }| (shown(least), shown(most)))
        .map(|ends| match ends {
            (least, most) if least == most => "the same in other fits".to_owned(),
            (least, most) => format!("other fits {least} to {most}"),
        });
    QuantityRow {
        name: quantity.name.clone(),
        value,
        // A unit beside no number would read as one.
        unit: if quantity.determined {
            unit
        } else {
            String::new()
        },
        interval: interval
            .or(spread)
            .unwrap_or_default()
            .trim_end()
            .to_owned(),
    }
}

fn row(row: &QuantityRow, turn: Option<String>) -> String {
    let QuantityRow {
        name,
        value,
        unit,
        interval,
    } = row;
    let turn = turn.map(|turn| format!("  = {turn}"));
    let line = format!(
        "  {name:34} {value:>12} {unit:8} {interval}{}",
        turn.unwrap_or_default()
    );
    format!("{}\n", line.trim_end())
}

/// A speed that the record determines, as the time for 60 degrees, which data sheets give.
pub(super) fn per_60_degrees(quantity: &Quantity, units: Units<'_>) -> Option<String> {
    let is_speed = quantity.unit == Unit::OutputPerSecond && quantity.determined;
    is_speed.then(|| seconds_per_60_degrees(quantity.value, units))?
}

/// "0.148 s/60°" of a speed; `None` where the output is not known to be an angle.
pub(super) fn seconds_per_60_degrees(speed: f64, units: Units<'_>) -> Option<String> {
    turn_time_s(speed, units).map(|seconds| format!("{seconds:.3} s/60°"))
}

/// The time for 60 degrees \[s\]; `None` where the output is not known to be an angle.
pub(super) fn turn_time_s(speed: f64, units: Units<'_>) -> Option<f64> {
    let turn = sixty_degrees(units)?;
    (speed > 0.0).then(|| turn / speed)
}

/// 60 degrees in units of the output, where that is an angle.
fn sixty_degrees(units: Units<'_>) -> Option<f64> {
    match units.output? {
        "deg" | "°" | "degree" | "degrees" => Some(60.0),
        "rad" => Some(60f64.to_radians()),
        _ => None,
    }
}

/// The times of a stroke of 60 degrees up and down in whole milliseconds, where the model can say it.
pub(super) fn stroke_of_60_degrees_ms(model: &ServoModel, units: Units<'_>) -> Option<[String; 2]> {
    let times_s = model.stroke_times_s(sixty_degrees(units)?)?;
    Some(times_s.map(|time_s| format!("{:.0}", 1e3 * time_s)))
}

/// How long a whole stroke of 60 degrees takes, which people ask first.
fn whole_stroke(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let [up, down] = stroke_of_60_degrees_ms(model, units)?;
    let times = match up == down {
        true => format!("{up} ms"),
        false => format!("{up} ms upwards and {down} ms downwards"),
    };
    let recorded = 2.0 * model.commands?.amplitude() * model.parameters(0).gain.abs();
    let beyond = (recorded < sixty_degrees(units)?).then(|| {
        format!(
            " It is simulated: the recording has strokes of up to {} only.",
            with_unit(digits(recorded, 3), units.output.unwrap_or_default())
        )
    });
    Some(format!(
        "A stroke of 60 degrees takes {times}, with delay, acceleration and braking: from the change of the command until the servo stays within 2 % of the stroke from its end.{}",
        beyond.unwrap_or_default()
    ))
}

/// Factor to the unit that people use, and its name.
pub(super) fn scale_and_unit(unit: Unit, units: Units<'_>) -> (f64, String) {
    let output = units.output.unwrap_or("");
    let some_output = units.output.unwrap_or("units");
    match unit {
        Unit::Seconds => (1e3, "ms".to_owned()),
        Unit::Hertz => (1.0, "Hz".to_owned()),
        Unit::One => (1.0, String::new()),
        Unit::OutputPerCommand => (1.0, units.gain().unwrap_or_default()),
        Unit::Command => (1.0, units.input.unwrap_or("").to_owned()),
        Unit::Output => (1.0, output.to_owned()),
        Unit::OutputPerSecond => (1.0, format!("{some_output}/s")),
        Unit::OutputPerSecondSquared => (1.0, format!("{some_output}/s2")),
    }
}

fn rung(tried: &LadderRung) -> String {
    format!(
        "  {:7.2} % {:7.2} %  {}{}\n",
        tried.held_out_percent,
        tried.fit_percent,
        terms_in_words(tried.terms),
        if tried.chosen { "  <- chosen" } else { "" }
    )
}

/// "limit of the drive, friction, weight on a hanging arm"
pub(crate) fn terms_in_words(terms: Terms) -> String {
    let load = match terms.load {
        LoadKind::None => "",
        LoadKind::Constant => "constant load",
        LoadKind::Pendulum => "weight on a hanging arm",
        LoadKind::TiltedPendulum => "weight on a tilted arm",
        LoadKind::Air => "load of the air",
    };
    let all = [
        (terms.limit, "limit of the drive"),
        (terms.two_speeds, "two speeds"),
        (terms.dead_band, "dead band"),
        (terms.friction && !terms.friction_of_gears, "friction"),
        (terms.friction_of_gears, "friction of loaded gears"),
        (terms.load != LoadKind::None, load),
    ];
    let present: Vec<&str> = all
        .into_iter()
        .filter_map(|(there, word)| there.then_some(word))
        .collect();
    match present.is_empty() {
        true => "linear, of second order".to_owned(),
        false => present.join(", "),
    }
}

/// Powers of ten that are written out: of 0.00004347 nobody counts the zeros.
const POWERS: std::ops::Range<f64> = -4.0..9.0;

/// A number with four digits; one that nobody reads as digits, as a power of ten.
pub(crate) fn four_digits(value: f64) -> String {
    digits(value, 4)
}

/// A number with so many digits.
pub(crate) fn digits(value: f64, count: usize) -> String {
    digits_beside(value, count, None)
}

/// Digits of the width of an interval that are shown: what is smaller says nothing.
const OF_WIDTH: usize = 3;

/// A number with so many digits, or as many as distinguish it from the ends of its interval of this `width`, which is by half as many of the
/// width; none is small beside that.
pub(super) fn digits_beside(value: f64, count: usize, width: Option<f64>) -> String {
    let leading = |value: f64| Some(value.abs().log10().floor()).filter(|power| power.is_finite());
    let decimals = |power: f64, count: usize| count as i32 - 1 - power as i32;
    let width = width.and_then(leading);
    let [fewest, enough] = match width {
        Some(power) => [count / 2, OF_WIDTH].map(|count| decimals(power, count)),
        None => [i32::MIN, i32::MAX],
    };
    let Some(power) = leading(value) else {
        // A negative zero is 0.
        return format!("{:.0}", value + 0.0);
    };
    if !POWERS.contains(&power) && decimals(power, count) <= enough {
        return format!("{value:.0$e}", count - 1);
    }
    let decimals = (decimals(power, count).max(fewest).min(enough)).clamp(0, 9) as usize;
    // A small number of either sign may round to 0.
    let text = format!("{value:.decimals$}");
    let is_zero = text.chars().all(|letter| "-0.".contains(letter));
    match text.strip_prefix('-') {
        Some(zero) if is_zero => zero.to_owned(),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_negative_zero_is_zero() {
        assert_eq!([digits(-0.0, 4), digits(0.0, 4)], ["0", "0"]);
    }

    #[test]
    fn the_ends_of_a_narrow_interval_differ_from_the_value() {
        let shown = |width| [12.639, 12.641, 12.643].map(|value| digits_beside(value, 4, width));
        assert_eq!(shown(None), ["12.64", "12.64", "12.64"]);
        assert_eq!(shown(Some(0.004)), ["12.6390", "12.6410", "12.6430"]);
        assert_eq!(shown(Some(0.4)), ["12.64", "12.64", "12.64"]);
        assert_eq!(shown(Some(40.0)), ["12.6", "12.6", "12.6"]);
        assert_eq!(shown(Some(0.0)), ["12.64", "12.64", "12.64"]);
    }

    #[test]
    fn speeds_and_accelerations_say_which_load_they_are_for() {
        let names = |load: Option<&str>| -> Vec<String> {
            let all = ["top speed upwards", "acceleration upwards", "gain"];
            let all: Vec<Quantity> = (all.into_iter().chain(load))
                .map(|name| quantity(name, true, 390.0, 410.0))
                .collect();
            let rows = quantity_rows(&all, Units::default()).into_iter();
            rows.map(|(_, row)| row.name).collect()
        };
        let loaded = names(Some("load at the middle"));
        assert_eq!(
            loaded[..3],
            [
                "top speed upwards, under load",
                "acceleration upwards, no load",
                "gain"
            ]
        );
        assert_eq!(
            names(None),
            ["top speed upwards", "acceleration upwards", "gain"]
        );
    }

    #[test]
    fn stairs_are_not_advised_alone_where_dead_band_and_friction_are_alike() {
        let levels = [0.0, 5.0, -3.0, 1.0, 4.0];
        let input: Vec<f64> = (0..900).map(|k| levels[k / 60 % 5]).collect();
        let follow = |y: &mut f64, (k, u): (usize, &f64)| {
            *y += 0.2 * (u - *y);
            Some(*y + 0.01 * (0.7 * (k * k) as f64).sin())
        };
        let output: Vec<f64> = input.iter().enumerate().scan(0.0, follow).collect();
        let record = servoid_identification::Record::of_run(0.01, input, output).unwrap();
        let options = servoid_identification::servo_model::ServoModelOptions::default();
        let mut model = servoid_identification::servo_model::fit(&record, &options).unwrap();
        let advised =
            |model: &ServoModel| advice_on_servo_model(model).contains(&STAIRS_DO_NOT_SEPARATE);
        model.covariance = Bounds::Withdrawn(Reason::ErrorsNotNoise);
        assert!(!advised(&model));
        model.terms.friction = true;
        assert!(advised(&model));
        model.covariance = Bounds::Withdrawn(Reason::TravelEnd);
        assert!(!advised(&model));
    }

    fn quantity(name: &str, determined: bool, lower: f64, upper: f64) -> Quantity {
        Quantity {
            name: name.to_owned(),
            unit: Unit::OutputPerSecond,
            determined,
            value: 400.0,
            interval: Bounds::Valid(Interval::new(400.0, lower, upper)),
            other_fits: None,
        }
    }

    #[test]
    fn what_is_not_determined_has_no_senseless_interval_and_says_what_to_record() {
        let degrees = Units {
            input: Some("deg"),
            output: Some("deg"),
        };
        let absurd = quantity("damping ratio", false, 3e-19, 8e19);
        let row = quantity_row(&absurd, degrees);
        assert_eq!((row.value.as_str(), row.unit.as_str()), ("-", ""));
        assert_eq!(row.interval, "not determined by this recording");
        let open = quantity("top speed upwards", false, 210.0, f64::NAN);
        assert_eq!(
            quantity_row(&open, degrees).interval,
            "not determined by this recording: 210.0 deg/s or more"
        );
        let advice = what_to_record(&[absurd, open]);
        assert_eq!(advice.len(), 2);
        assert!(advice[0].contains("large strokes") && advice[1].contains("small quick strokes"));
        let known = quantity("top speed upwards", true, 390.0, 410.0);
        assert!(what_to_record(std::slice::from_ref(&known)).is_empty());
        assert_eq!(
            per_60_degrees(&known, degrees).as_deref(),
            Some("0.150 s/60°")
        );
        assert_eq!(per_60_degrees(&known, Units::default()), None);
    }
}
