//! The parts of the sentence on a servo: its limit, where it stops, how fast it moved, where it rests, how late it answers.

use super::top_speeds::{determined, is_never_reached};
use crate::data::units::Units;
use crate::presentation::summary::wording::layout::listed_words;
use crate::presentation::summary::wording::numbers::{digits, digits_beside, four_digits};
use crate::presentation::summary::wording::speed_words::{
    reached_in_words, speed_in_words, speeds_between_in_words, upwards,
};
use servoid_identification::results::{Reason, with_unit};
use servoid_identification::servo_model::{
    LoadKind, Quantity, QuantityKind, ServoModel, Spread, Stops,
};

/// "runs into a stop at 12.01 deg", where the recording shows that.
pub(super) fn stopped(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let unit = with_space(units.output);
    let at = |output: f64| format!("{}{unit}", four_digits(output));
    let stops = match model.shows_its_stops() {
        true => model.stops,
        false => Stops::default(),
    };
    match (stops.lower, stops.upper) {
        (None, None) => None,
        (Some(one), None) | (None, Some(one)) => Some(format!("runs into a stop at {}", at(one))),
        (Some(lower), Some(upper)) => Some(format!(
            "runs into stops at {} and {}",
            at(lower),
            at(upper)
        )),
    }
}

/// How fast the servo moved in the recording at least.
pub(super) fn moved_at(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let reached = model.reached?;
    let directions = [
        (reached.upwards, upwards(model)),
        (reached.downwards, "downwards"),
    ];
    // A recording may have no stroke in one direction.
    let moved = directions.iter().filter(|(speed, _)| *speed > 0.0);
    let each = moved.map(|(speed, direction)| {
        let speed = reached_in_words(model, *speed, units);
        format!("{speed} {direction}")
    });
    let each: Vec<String> = each.collect();
    (!each.is_empty()).then(|| format!("moved at {} in this recording", listed_words(&each)))
}

/// The same where the model has no limit, which it may have beyond.
pub(super) fn below_any_limit(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let moved = moved_at(model, units).filter(|_| !model.terms.is_limited())?;
    Some(format!("{moved} without reaching a limit"))
}

/// Other fits to the record whose top speeds are within this part of it of each other have one top speed: it is what counts as the same where
/// servos are compared.
const SAME_SPEED: f64 = 0.05;

/// Top speeds without intervals on which all fits agree, and which the servo has not surely exceeded: a limit that was exceeded is none. Where errors show that the model lacks something, speeds may stand for that.
pub(super) fn agreed<'q>(
    model: &ServoModel,
    speeds: [&'q Quantity; 2],
) -> Option<[&'q Quantity; 2]> {
    let reason = model.covariance.withdrawn();
    if matches!(
        reason,
        Some(Reason::ErrorsNotNoise | Reason::NeverAtRest | Reason::QuantisationAboveNoise)
    ) {
        return None;
    }
    let reached = model.reached?;
    let of = |(found, reached): (&Quantity, f64)| {
        let fits = found.other_fits;
        let same = |fits: Spread| fits.most - fits.least <= SAME_SPEED * found.value;
        found.value >= reached && fits.is_some_and(same)
    };
    let all = speeds.into_iter().zip([reached.upwards, reached.downwards]);
    all.into_iter().all(of).then_some(speeds)
}

/// "is limited to 331 deg/s (0.181 s/60°)", where the record determines that: in these words, with so many digits.
pub(super) fn limited_to(
    model: &ServoModel,
    speeds: Option<[&Quantity; 2]>,
    units: Units<'_>,
    (how, count): (&str, usize),
) -> Option<String> {
    let [up, down] = speeds?.map(|found| {
        match ends(found).filter(|[lower, upper]| upper - lower > VAGUE * found.value) {
            Some(range) => speeds_between_in_words(range, units),
            None => speed_in_words(model, (found.value, digits(found.value, count)), units),
        }
    });
    let limits = match up == down {
        true => up,
        false => format!("{up} {} and {down} downwards", upwards(model)),
    };
    // Where the load helps, the servo is faster than that.
    let under = match model.terms.load {
        LoadKind::None => "",
        // Which may be none.
        _ if has_few_levels(model) || may_have_no_load(model) => "",
        LoadKind::Constant => " under its load",
        _ => " under the load at the middle of its commands",
    };
    Some(match is_never_reached(model, &speeds?) {
        true => format!("is not shown at its top speed of {limits}{under}"),
        false => format!("{how} {limits}{under}"),
    })
}

/// Whether the record goes to so few levels that terms of the model stand for each other.
fn has_few_levels(model: &ServoModel) -> bool {
    model.covariance.withdrawn() == Some(Reason::FewLevels)
}

/// " deg"; nothing of an unknown unit.
pub(super) fn with_space(unit: Option<&str>) -> String {
    unit.map(|unit| format!(" {unit}")).unwrap_or_default()
}

/// Where its load stalls it, by the model.
pub(super) fn stalled(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let at: Vec<String> = (model.stalls().into_iter().flatten())
        .map(|stall| with_unit(digits(stall.output, 3), units.output.unwrap_or_default()))
        .collect();
    (!at.is_empty()).then(|| format!("stalls against its load at about {}", at.join(" and ")))
}

/// The upper end of an interval over its value, from which a rest is not said in a sentence.
const MOST_OF_REST: f64 = 4.0;

/// Its play, where an interval shows that it has some.
pub(super) fn play(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let found = determined(model, QuantityKind::Play).filter(|found| is_one_sided(found))?;
    let width = ends(found).map(|[lower, upper]| upper - lower);
    let width = digits_beside(found.value, 3, width);
    Some(format!("has play of {width}{}", with_space(units.output)))
}

/// How far friction, a dead band and play leave it off its command, together.
pub(super) fn resting_error(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let by_friction = determined(model, QuantityKind::RestingError)?;
    let (value, bounds) = off_command(model);
    // Ends that are far apart say nothing of a servo, and alarm.
    let is_known = bounds.is_none_or(|[_, upper]| upper < MOST_OF_REST * value);
    // A number that may be a quarter larger or less is not said without its interval.
    let wide = bounds.filter(|[lower, upper]| upper - lower > value / 2.0);
    // A load moves the shaft to one edge of the dead band, and where it grows with the angle an error of the command moves the shaft by less: what is left is a position alone, whose interval is not known.
    let has_load = model.terms.load != LoadKind::None;
    let angle = value.min(model.held_at_rest());
    let position = digits(angle * model.parameters(0).gain.abs(), 2);
    let position = format!("{position}{}", with_space(units.output));
    let command = format!("{}{}", digits(value, 2), with_space(units.input));
    let off = match (
        has_load && !may_have_no_load(model),
        units.input == units.output,
    ) {
        (true, _) => format!("{position} off where its load holds it"),
        (false, true) => format!("{command} of the command off"),
        (false, false) => format!("{command} ({position}) off"),
    };
    let is_said = by_friction.value > 0.0 && is_known && !(has_load && wide.is_some());
    let wide = wide.map_or_else(String::new, |[lower, upper]| {
        format!(
            " ({} to {}{})",
            digits(lower, 2),
            digits(upper, 2),
            with_space(units.input)
        )
    });
    is_said.then(|| format!("comes to rest up to {off}{wide}, as by friction, a dead band or play"))
}

/// How far off the command it may rest, and the ends of the intervals of what makes that, where each has one \[command\]: what friction leaves begins at the edge of the dead band, and the output is half the play behind.
fn off_command(model: &ServoModel) -> (f64, Option<[f64; 2]>) {
    let half_of_play = 0.5 / model.parameters(0).gain.abs();
    let of = |kind, factor: f64| {
        let found = determined(model, kind)?;
        let ends = ends(found).map(|of| of.map(|end| factor * end));
        Some((factor * found.value, ends))
    };
    let all = [
        of(QuantityKind::RestingError, 1.0),
        of(QuantityKind::DeadBand, 1.0),
        of(QuantityKind::Play, half_of_play),
    ];
    // Gears under load hold the shaft farther than these, which are those without.
    let gears = determined(model, QuantityKind::FrictionOfGears);
    let gears_are_loaded =
        model.terms.load != LoadKind::None && gears.is_some_and(|found| found.value > 0.0);
    let value = match gears_are_loaded {
        true => model.held_at_rest(),
        false => all.iter().flatten().map(|(value, _)| value).sum(),
    };
    let bounds = all.into_iter().flatten().map(|(_, ends)| ends);
    let bounds = bounds.reduce(|a, b| Some([a?[0] + b?[0], a?[1] + b?[1]]));
    (value, bounds.flatten())
}

/// What has the motion of a constant load as well.
pub(crate) const LOOKS_LIKE_A_LOAD: &str = "a drive that is weaker to one side looks the same";

/// The load, where the record shows that there is one: unequal drives may make the same motion.
pub(super) fn load(model: &ServoModel) -> Option<String> {
    let words = match model.terms.load {
        LoadKind::None => return None,
        LoadKind::Constant => {
            format!("works as if against a constant load ({LOOKS_LIKE_A_LOAD})")
        }
        LoadKind::Spring => {
            "works against a load that grows with the angle, as a spring, the air or a weight makes".to_owned()
        }
        LoadKind::Pendulum | LoadKind::TiltedPendulum => {
            "works against a load that changes with the angle, as a spring, a weight or the air makes".to_owned()
        }
        LoadKind::Air => {
            "works against a load that stiffens to one side, as an end of its travel does"
                .to_owned()
        }
    };
    shows_load(model).then_some(words)
}

/// Whether the interval of the load holds none.
fn may_have_no_load(model: &ServoModel) -> bool {
    model.covariance.valid().is_some() && !shows_load(model)
}

/// Whether the interval of the load shows that there is one.
pub(crate) fn shows_load(model: &ServoModel) -> bool {
    let kind = match model.terms.load {
        LoadKind::None => return false,
        LoadKind::Constant | LoadKind::Air => QuantityKind::LoadAtMiddle,
        LoadKind::Spring => QuantityKind::SpringOfLoad,
        LoadKind::Pendulum | LoadKind::TiltedPendulum => QuantityKind::LoadOfLevelArm,
    };
    let radians = match kind {
        QuantityKind::SpringOfLoad => 1.0,
        _ => model.radians_per_command,
    };
    determined(model, kind)
        .is_some_and(|load| is_one_sided(load) && load.value.abs() * radians < LARGEST_LOAD)
}

/// A load that holds a servo further off its command is none \[rad\]: in small strokes a weight is much like a softer drive behind a larger gain.
const LARGEST_LOAD: f64 = 1.0;

/// Whether a quantity has one sign in its interval.
fn is_one_sided(quantity: &Quantity) -> bool {
    ends(quantity).is_some_and(|[lower, upper]| lower * upper > 0.0)
}

/// Both ends of its interval, where it has them.
fn ends(quantity: &Quantity) -> Option<[f64; 2]> {
    quantity.interval.valid()?.ends()
}

pub(super) fn delay(model: &ServoModel) -> Option<String> {
    let found = determined(model, QuantityKind::Delay)?;
    let (delay, at_once) = (found.value, AT_ONCE * model.sample_period_s);
    // Of commands that wait for pulses the wait comes before it.
    let late = match model.fit.waits_for_pulses {
        Some(_) => "behind its pulse",
        None => "late",
    };
    Some(match ends(found) {
        // An end that far off says nothing of the servo, and alarms.
        Some([lower, upper]) if lower < at_once && upper > FAR_OFF * delay && upper > at_once => {
            return None;
        }
        Some([lower, upper]) if upper - lower > VAGUE * delay && upper > at_once => {
            let upper = digits(1e3 * upper, 3);
            match lower < at_once {
                true => format!("answers at most {upper} ms {late}"),
                false => format!("answers {} to {upper} ms {late}", digits(1e3 * lower, 3)),
            }
        }
        _ if delay < at_once => "answers at once".to_owned(),
        ends => {
            let width = ends.map(|[lower, upper]| 1e3 * (upper - lower));
            format!("answers {} ms {late}", digits_beside(1e3 * delay, 3, width))
        }
    })
}

/// A delay whose interval is wider than this part of it is said as that interval, and so is a speed.
const VAGUE: f64 = 0.25;

/// The upper end of an interval that begins at once, over its value, from which a delay is not said in a sentence.
const FAR_OFF: f64 = 8.0;

/// A delay of so many samples does not show.
const AT_ONCE: f64 = 0.01;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presentation::summary::servo::limited_servo::limited_servo;
    use servoid_identification::results::{Bounds, Interval};
    use servoid_identification::servo_model::{Covariance, Unit};

    fn quantity(name: &str, value: f64, half_width: f64) -> Quantity {
        let interval = Interval::new(value, value - half_width, value + half_width);
        Quantity {
            name: name.to_owned(),
            unit: Unit::Command,
            determined: true,
            value,
            interval: Bounds::Valid(interval),
            other_fits: None,
        }
    }

    /// Under a load the sum of resting error and dead band is no distance between rests: the load keeps the shaft at one edge of the band.
    #[test]
    fn how_far_off_it_rests_is_a_position_alone_under_a_load() {
        let mut model = limited_servo();
        model.terms.load = LoadKind::None;
        let load = quantity("load at the middle", 4.0, 0.1);
        model.quantities = vec![
            quantity("resting error by friction", 3.0, 0.1),
            quantity("dead band, to each side", 2.0, 0.1),
            load,
        ];
        let us_and_degrees = Units {
            input: Some("us"),
            output: Some("deg"),
        };
        let said = |model: &ServoModel| resting_error(model, us_and_degrees).unwrap();
        let without = said(&model);
        assert!(
            without.contains("up to 5.0 us (") && without.contains(" deg) off,"),
            "{without}"
        );
        model.covariance = Bounds::Valid(Covariance {
            level: 0.99,
            rows: Vec::new(),
        });
        model.terms.load = LoadKind::Constant;
        let under_load = said(&model);
        assert!(
            under_load.contains(" deg off where its load holds it"),
            "{under_load}"
        );
        assert!(!under_load.contains("us"), "{under_load}");
        // A wide interval of the command says nothing of the position.
        model.quantities[0] = quantity("resting error by friction", 3.0, 2.0);
        assert_eq!(resting_error(&model, us_and_degrees), None);
    }

    #[test]
    fn a_delay_is_said_as_well_as_it_is_known() {
        let model = limited_servo();
        let words = |lower: f64, upper: f64| {
            let mut model = model.clone();
            let kind = Some(QuantityKind::Delay);
            let found = model
                .quantities
                .iter_mut()
                .find(|found| found.kind() == kind);
            let found = found.unwrap();
            (found.value, found.determined) = (0.008, true);
            found.interval = Bounds::Valid(Interval::new(0.008, lower, upper));
            delay(&model)
        };
        let said = |words: &str| Some(words.to_owned());
        assert_eq!(words(0.0078, 0.0081), said("answers 8.00 ms late"));
        assert_eq!(words(0.007, 0.0093), said("answers 7.00 to 9.30 ms late"));
        assert_eq!(words(0.0, 0.019), said("answers at most 19.0 ms late"));
        assert_eq!(words(0.0031, 0.019), said("answers 3.10 to 19.0 ms late"));
        assert_eq!(words(0.0, 0.1), None);
    }
}
