//! What is said of a servo model beside the table of its quantities, by the terminal and by a page alike.

use super::clauses::shows_load;
use super::measured_limits::against_the_model;
use super::top_speeds::one_unreached;
use super::what_to_record::advice_on_servo_model;
use super::whole_stroke::whole_stroke;
use crate::data::model_file::ServoModelDocument;
use crate::data::neutral::neutral;
use crate::data::pulse_widths::is_pulse;
use crate::data::units::Units;
use crate::presentation::summary::wording::numbers::{digits, digits_beside, four_digits};
use servoid_identification::nonlinear::MissedRest;
use servoid_identification::results::{Bounds, with_unit};
use servoid_identification::servo_model::{Load, QuantityKind, ServoModel, Stall, Stops};

/// Sentences around the table of quantities.
pub(crate) struct ServoRemarks {
    /// What the intervals are of, the offsets of the runs, and stops, which are no quantities: before the table.
    pub(crate) before: Vec<String>,
    /// What the table means, and what to record: behind it.
    pub(crate) behind: Vec<String>,
}

impl ServoRemarks {
    /// Those of one servo.
    pub(crate) fn of(document: &ServoModelDocument, units: Units<'_>) -> Self {
        let model = &document.model;
        let before = [
            of_intervals(model, units),
            run_offsets_in_words(model, units),
            of_pulse_end(model, units),
            rest_at_neutral(model, units),
            rests_in_words(model, units),
            of_stops(model, units),
            stall_in_words(model, units).map(|stall| format!("By {stall}.")),
            of_missed_rests(model, units),
        ];
        let quantities = &model.quantities;
        let has_other_fits = quantities.iter().any(|found| found.other_fits.is_some());
        let behind = [
            has_other_fits.then(|| OTHER_FITS.to_owned()),
            at_the_middle(model, units),
            whole_stroke(model, units),
            against_the_model(model, units),
            one_unreached(model, units),
            behind_pulses(model),
            wait_in_the_delay(document),
            how_held_apart(model),
            where_strokes_end(model),
            friction_at_low_speed(model),
            whose_controller(document),
        ];
        let advice = advice_on_servo_model(document)
            .into_iter()
            .map(str::to_owned);
        Self {
            before: before.into_iter().flatten().collect(),
            behind: behind.into_iter().flatten().chain(advice).collect(),
        }
    }
}

/// Why there are no intervals, or that they hold for other servos as well.
fn of_intervals(model: &ServoModel, units: Units<'_>) -> Option<String> {
    if let Bounds::Withdrawn(reason) = &model.covariance {
        let lacking = model.fit.lacking.map_or_else(String::new, |lacking| {
            let size = with_unit(digits(lacking, 2), units.output.unwrap_or_default());
            match model.fit.servo_changed {
                true => format!(
                    ": beside noise, up to about {size} rms is what the servo changed by from run to run. Each run by itself leaves its model noise alone"
                ),
                false => format!(": beside noise, the model lacks up to about {size} rms"),
            }
        });
        return Some(format!(
            "No intervals can be given, because {}{lacking}.",
            reason.because()
        ));
    }
    let of_others = match model.alternatives.len() {
        0 => String::new(),
        others => format!(
            "{others} other sets of terms predict as well: the intervals hold for all of them. "
        ),
    };
    Some(format!("{of_others}{AS_RECORDED}"))
}

/// What intervals of a servo model are of: nothing in them is estimated from how far runs lie apart.
const AS_RECORDED: &str = "Intervals are of the servo as it was recorded: where supply, temperature or the zero of the sensor change from run to run, the next run, and the mean of \
    many, may lie outside.";

/// What stands in the place of intervals where none hold.
const OTHER_FITS: &str = "\"Other fits up to …\" is how far fits to parts of the recording and with other terms are from the figure. That is no interval: what the model lacks is \
    in all of them, and the figure may be off by less, or by several times as much.";

/// What a dead band is beside friction, of which servos have several kinds.
fn how_held_apart(model: &ServoModel) -> Option<String> {
    let is_known = |kind| model.quantity(kind).is_some_and(|found| found.determined);
    let has_both = is_known(QuantityKind::DeadBand) && is_known(QuantityKind::RestingError);
    (has_both && model.covariance.valid().is_some()).then(|| {
        "Dead band and resting error are those of a drive that begins with the error beyond the edge of the band. In a servo whose drive begins with the whole error there, the band is wider and the \
         friction less: their sum alone holds."
            .to_owned()
    })
}

/// What the resting error is where friction at rest is open.
fn where_strokes_end(model: &ServoModel) -> Option<String> {
    let is_determined = |kind| Some(model.quantity(kind)?.determined);
    let is_open = is_determined(QuantityKind::RestingError)?
        && !is_determined(QuantityKind::FrictionAtRest)?
        && model.covariance.valid().is_some();
    is_open.then(|| {
        "The resting error is the largest with which strokes end; most end closer. Friction at rest that is gone as soon as the shaft turns does not show in them: once at rest, it holds the shaft \
         farther off. Of simulated servos in which it is gone at lower speeds than in the equation, this error was up to 6 % larger, and outside some intervals; so were some simulated rests."
            .to_owned()
    })
}

/// What a speed of its own means at which friction at rest is gone.
fn friction_at_low_speed(model: &ServoModel) -> Option<String> {
    let share = model.own_friction_speed_share()?;
    Some(format!(
        "Friction at rest is half gone at {} % of the top speed here, since 5 %, as in most models, leaves more than noise. How it falls in between is assumed: neither it nor the offset has an \
         interval, which that would move.",
        digits(100.0 * share, 2)
    ))
}

/// Under which command speeds, accelerations and the load are stated, where the load changes with the angle.
fn at_the_middle(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let servo = model.parameters(0);
    let changes = servo.load.changes_with_angle() && shows_load(model);
    let commands = model.commands.filter(|_| changes)?;
    // Three digits of the recorded range are enough.
    let width = commands.largest - commands.least;
    let at = |value: f64, width: f64, unit: Option<&str>| {
        with_unit(
            digits_beside(value, 4, Some(width)),
            unit.unwrap_or_default(),
        )
    };
    let middle = commands.middle();
    let command = at(middle, width, units.input);
    let position = at(
        servo.gain * middle + servo.offset,
        width * servo.gain.abs(),
        units.output,
    );
    Some(format!(
        "Speeds and accelerations under load, and the load, are those of the shaft at {position}, where it would be under {command}, the middle of the recorded commands, without the load."
    ))
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

/// How exactly it comes to rest, as it was measured.
fn rests_in_words(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let apart = model.rests_apart?;
    let (value, [lower, upper]) = (apart.value?, apart.ends()?);
    let shown = |number: f64| digits_beside(number, 3, Some(upper - lower));
    Some(format!(
        "Its rests under one command are up to {} apart ({} .. {}), by the strokes that the recording makes again: play, a dead band or friction keep them so, and other strokes may leave them farther apart.",
        with_unit(shown(value), units.output.unwrap_or_default()),
        shown(lower),
        shown(upper)
    ))
}

/// That the commands waited for pulses, at which the model has them.
fn behind_pulses(model: &ServoModel) -> Option<String> {
    let waits = model.fit.waits_for_pulses?;
    let delay = model.quantity(QuantityKind::Delay);
    let has_interval =
        delay.is_some_and(|delay| delay.determined && delay.interval.valid().is_some());
    let contained = match has_interval {
        true => ", which the interval of the delay contains, and none narrower than that",
        false => "",
    };
    Some(format!(
        "The commands of this recording waited for pulses {}, on a clock of their own: the moments of these pulses were looked for and are those with which the model is closest. All of them may have come up to {:.2} ms sooner or later alike{contained}. The delay counts from the pulse, \
         and a command waits for that as well, half of the time between two pulses on average; times of the linear model have this wait in them.",
        waits.in_words(),
        1e3 * waits.delay_error_s
    ))
}

/// That the delay may have a wait in it that no interval contains.
fn wait_in_the_delay(document: &ServoModelDocument) -> Option<String> {
    let delay = document.model.quantity(QuantityKind::Delay)?;
    (document.common_wait_s > 0.0 && delay.determined).then(|| {
        format!(
            "Where pulses come on a clock of their own, commands wait for them: under these holds a wait is in the delay that another recording has otherwise, by up to {:.0} ms with frames of 20 ms, and no interval contains it \
             (--exact-command states that no command waits).",
            1e3 * document.common_wait_s
        )
    })
}

/// Where the model rests under the neutral pulse: the offset is where it would under a pulse of 0.
fn rest_at_neutral(model: &ServoModel, units: Units<'_>) -> Option<String> {
    if !is_pulse(units, model.commands) {
        return None;
    }
    let command = neutral(units, model.commands);
    let servo = model.parameters(0);
    // What a tenth of a microsecond makes.
    let fine = 0.1 * servo.gain.abs();
    let decimals = (-fine.log10()).ceil().clamp(0.0, 9.0) as usize;
    let in_words = |rest: f64| {
        let shown = format!("{rest:.decimals$}");
        with_unit(shown, units.output.unwrap_or_default())
    };
    let rest = servo.resting_output(command);
    let other_side = rest_with_load_to_the_other_side(model, command)
        .filter(|other| (other - rest).abs() > fine)
        .map_or_else(String::new, |other| {
            format!(
                ", or at {} with its load to the other side, which the recording does not exclude",
                in_words(other)
            )
        });
    Some(format!(
        "Under a pulse of {command:.0} us the model{} rests at {}{other_side}. {}.",
        match model.covariance.valid() {
            Some(_) => "",
            None => ", whose figures may be off,",
        },
        in_words(rest),
        match model.quantity(QuantityKind::Offset) {
            Some(_) => "The offset is that under a command of 0, which is no pulse",
            None =>
                "Under a load that changes with the angle no offset, which is that under a command of 0, makes a line of the rests with the gain",
        }
    ))
}

/// Where the model rests with as much of a constant load to the other side, where its interval or other fits hold no load at all: beside a dead band any load pushes the shaft to an edge.
fn rest_with_load_to_the_other_side(model: &ServoModel, command: f64) -> Option<f64> {
    let mut servo = model.parameters(0);
    let Load::Constant(load) = servo.load else {
        return None;
    };
    let found = model.quantity(QuantityKind::LoadAtMiddle)?;
    let of_fits = found.other_fits.map(|fits| [fits.least, fits.most]);
    let of_interval = || found.interval.valid()?.ends();
    let [least, most] = of_fits.or_else(of_interval)?;
    servo.load = Load::Constant(-load);
    (least <= 0.0 && 0.0 <= most).then(|| servo.resting_output(command))
}

/// From which commands on the load stalls the drive, where that is so.
pub(crate) fn stall_in_words(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let in_words = |(side, stall): (&str, Stall)| {
        let command = with_unit(digits(stall.command, 4), units.input.unwrap_or_default());
        let output = with_unit(digits(stall.output, 3), units.output.unwrap_or_default());
        format!("{side} a command of {command} at about {output}")
    };
    let stalls = ["below", "above"].into_iter().zip(model.stalls());
    let stalls = stalls.filter_map(|(side, stall)| Some(in_words((side, stall?))));
    let stalls: Vec<String> = stalls.collect();
    // A load may stand for what a model without intervals lacks.
    let by = match model.covariance.valid() {
        Some(_) => "the model, ",
        None => "the model, whose figures may be off, ",
    };
    (!stalls.is_empty()).then(|| {
        format!(
            "{by}the load stalls the drive {}: it drives the servo no farther, where what its speed carries it beyond comes back or is held by friction",
            stalls.join(", and ")
        )
    })
}

/// That longer pulses act later.
fn of_pulse_end(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let end = model.pulse_end?;
    let neutral = with_unit(four_digits(end.neutral), units.input.unwrap_or("us"));
    Some(format!(
        "The servo knows a pulse at its end: one that is 100 us longer acts 0.1 ms later. The delay is that of {neutral}, from the beginning of the pulse."
    ))
}

/// The stops of the model, and whether they are sure.
fn of_stops(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let stops = stops_in_words(model.stops, units)?;
    Some(match model.shows_its_stops() {
        true => format!("The servo has {stops}."),
        false => format!(
            "The servo may have {stops}: the model predicts better with that, but a load, friction or a gain that falls there looks the same \
             under these commands."
        ),
    })
}

/// Where the servo rests elsewhere than the model, at the ends of its commands.
fn of_missed_rests(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let missed = missed_rests_in_words(model, units, "the model")?;
    Some(format!(
        "The model is off at an end: {missed}. A stop, a linkage or a load there is not in it. Holds at two or more commands that far out, each until the servo \
         rests, show whether it is a stop."
    ))
}

/// "under a command of 50 deg the servo rests at 41.17 deg, and the model at 45.50 deg", of a model that is called so.
pub(crate) fn missed_rests_in_words(
    model: &ServoModel,
    units: Units<'_>,
    called: &str,
) -> Option<String> {
    let with =
        |number: f64, unit: Option<&str>| with_unit(four_digits(number), unit.unwrap_or_default());
    let rest = |missed: &MissedRest| {
        let [command, measured, modelled] = [
            with(missed.command, units.input),
            with(missed.measured, units.output),
            with(missed.modelled, units.output),
        ];
        format!(
            "under a command of {command} the servo rests at {measured}, and {called} at {modelled}"
        )
    };
    let rests: Vec<String> = model.missed_rests.iter().map(rest).collect();
    (!rests.is_empty()).then(|| rests.join("; "))
}

/// Where the servo stops.
pub(crate) fn stops_in_words(stops: Stops, units: Units<'_>) -> Option<String> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presentation::summary::servo::limited_servo::limited_servo;

    #[test]
    fn an_end_at_which_the_model_is_off_is_named_with_both_rests() {
        let mut model = limited_servo();
        assert_eq!(of_missed_rests(&model, Units::default()), None);
        model.missed_rests = vec![MissedRest {
            command: 50.0,
            measured: 41.18,
            modelled: 45.52,
        }];
        let degrees = Units {
            input: Some("deg"),
            output: Some("deg"),
        };
        let said = of_missed_rests(&model, degrees).unwrap();
        let rests = "under a command of 50.00 deg the servo rests at 41.18 deg, and the model at 45.52 deg.";
        assert!(said.contains(rests), "{said}");
    }
}
