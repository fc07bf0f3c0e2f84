//! The servo as a machine, in a sentence or two.

use super::layout::listed_words;
use super::servo_model::{OF_LIMIT, digits, four_digits, seconds_per_60_degrees, turn_time_s};
use crate::data::units::Units;
use servoid_identification::servo_model::{LoadKind, Quantity, ServoModel, Spread};
use servoid_identification::thresholds::POOR_PREDICTION_PERCENT;

/// What kind of servo this is, in a sentence or two; and that the linear model is the one to use, where it predicts better.
#[must_use]
pub fn servo_sentence(model: &ServoModel, units: Units<'_>) -> String {
    if !model.predicts() {
        let noise = (model.reachable_percent())
            .map(|percent| format!(", where noise alone would leave {percent:.1} %"));
        return format!(
            "The servo model does not predict this recording: simulated from the command, it fits it to {:.1} %{}. What it says \
             of the servo is not to be relied on.{}",
            model.prediction_percent(),
            noise.unwrap_or_default(),
            better_linear(model).unwrap_or_default()
        );
    }
    let is_sure = model.covariance.valid().is_some();
    let speeds = top_speeds(model);
    let parts = [
        Some(kind(model, speeds, units)),
        resting_error(model, units),
        load(model).map(str::to_owned),
        delay(model),
    ];
    let all: Vec<String> = parts.into_iter().flatten().collect();
    let doubts = [
        speeds.and_then(|[up, _]| unlikely_speed(model, up, units)),
        hidden_by_noise(model),
        better_linear(model),
    ];
    format!(
        "This servo {}. A model of it as a machine predicts parts of the recording that it has not seen to {:.1} %.{}{}",
        listed_words(&all),
        model.prediction_percent(),
        match is_sure {
            true => "",
            false =>
                " No intervals can be given: figures are the least and the most of fits to parts of this recording, and another \
                 recording may give others.",
        },
        doubts.into_iter().flatten().collect::<String>()
    )
}

/// The quantity of this name, where the record determines it.
fn determined<'a>(model: &'a ServoModel, name: &str) -> Option<&'a Quantity> {
    let mut named = model.quantities.iter().filter(|found| found.name == name);
    named.next().filter(|found| found.determined)
}

fn top_speeds(model: &ServoModel) -> Option<[&Quantity; 2]> {
    let [up, down] =
        ["top speed upwards", "top speed downwards"].map(|name| determined(model, name));
    Some([up?, down?])
}

/// "is limited to 331 deg/s (0.181 s/60°)"
fn kind(model: &ServoModel, speeds: Option<[&Quantity; 2]>, units: Units<'_>) -> String {
    let output = with_space(units.output);
    let speed = |found: &Quantity| {
        format!(
            "{}{output}/s{}",
            figure(found, 1.0),
            turn(model, found, units)
        )
    };
    let kind = match speeds {
        Some([up, down]) if up.value == down.value && up.other_fits == down.other_fits => {
            return format!("is limited to {}", speed(up));
        }
        Some([up, down]) => {
            let (up, down) = (speed(up), speed(down));
            return format!("is limited to {up} upwards and {down} downwards");
        }
        None if model.terms.limit && shows_limit(model) => "is limited in its drive",
        // Friction comes with a limit that the record may not reach.
        None if model.terms.limit => "is not linear",
        None if model.covariance.valid().is_some() => "is linear",
        None if determined(model, "bandwidth at small signals").is_none() => {
            "is much like a linear one whose bandwidth does not show"
        }
        None => "is much like a linear one",
    };
    kind.to_owned()
}

/// Whether the record determines anything that a limit of the drive brings about.
fn shows_limit(model: &ServoModel) -> bool {
    let is_of_limit = |found: &&Quantity| OF_LIMIT.iter().any(|name| found.name.starts_with(name));
    let mut of_limit = model.quantities.iter().filter(is_of_limit);
    of_limit.any(|found| found.determined)
}

/// " (0.181 s/60°)", or what that is if the output is in degrees.
fn turn(model: &ServoModel, speed: &Quantity, units: Units<'_>) -> String {
    let stated = seconds_per_60_degrees(speed.value, units);
    let assumed = || {
        let seconds = seconds_per_60_degrees(speed.value, assumed_units(model, units)?)?;
        Some(format!("{seconds} if that is degrees"))
    };
    let seconds = stated.or_else(assumed);
    seconds.map_or_else(String::new, |seconds| format!(" ({seconds})"))
}

/// " deg"; nothing of an unknown unit.
fn with_space(unit: Option<&str>) -> String {
    unit.map(|unit| format!(" {unit}")).unwrap_or_default()
}

fn resting_error(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let error = determined(model, "resting error by friction")?;
    (error.value > 0.0).then(|| {
        let command = with_space(units.input);
        format!("rests within {}{command} of its target", figure(error, 1.0))
    })
}

/// The load, where the record shows that there is one: unequal drives may make the same motion.
fn load(model: &ServoModel) -> Option<&'static str> {
    let (name, words) = match model.terms.load {
        LoadKind::None => return None,
        LoadKind::Constant => ("load at the middle", "works against a constant load"),
        LoadKind::Pendulum | LoadKind::TiltedPendulum => {
            ("load of a level arm", "carries a weight")
        }
        LoadKind::Air => (
            "load at the middle",
            "works against a load that stiffens to one side",
        ),
    };
    let is_shown = |load: &&Quantity| {
        is_one_sided(load) && load.value.abs() * model.radians_per_command < LARGEST_LOAD
    };
    determined(model, name).filter(is_shown).map(|_| words)
}

/// A load that holds a servo further off its command is none \[rad\]: in small strokes a weight is much like a softer drive behind a larger gain.
const LARGEST_LOAD: f64 = 1.0;

/// Whether a quantity has one sign in its interval, or in other fits.
fn is_one_sided(quantity: &Quantity) -> bool {
    let ends = match (quantity.interval.valid(), quantity.other_fits) {
        (Some(interval), _) => interval.lower.zip(interval.upper),
        (None, Some(Spread { least, most })) => Some((least, most)),
        (None, None) => Some((quantity.value, quantity.value)),
    };
    ends.is_some_and(|(least, most)| least * most > 0.0)
}

fn delay(model: &ServoModel) -> Option<String> {
    let delay = determined(model, "delay")?;
    let most_s = delay.other_fits.map_or(delay.value, |spread| spread.most);
    Some(match most_s < AT_ONCE * model.sample_period_s {
        true => "answers at once".to_owned(),
        false => format!("answers {} ms late", figure(delay, 1e3)),
    })
}

/// A delay of so many samples does not show.
const AT_ONCE: f64 = 0.01;

/// A quantity times `scale`, to as many digits as are known; without an interval, from the least to the most of other fits.
fn figure(quantity: &Quantity, scale: f64) -> String {
    let two_digits = |value: f64| digits(scale * value, 2);
    match quantity.other_fits {
        None if quantity.interval.valid().is_some() => four_digits(scale * quantity.value),
        // Of a file from before other fits were kept.
        None => format!("about {}", two_digits(quantity.value)),
        Some(Spread { least, most }) => {
            let (least, most) = (two_digits(least), two_digits(most));
            match least == most {
                true => format!("about {least}"),
                false => format!("{least}-{most}"),
            }
        }
    }
}

/// " Noise alone would leave ...": that a poor fit is that of noise, and what it means.
fn hidden_by_noise(model: &ServoModel) -> Option<String> {
    let reachable = model.reachable_percent()?;
    (model.prediction_percent() < POOR_PREDICTION_PERCENT).then(|| {
        format!(
            " Noise alone would leave {reachable:.1} %: it may hide friction, limits and load, so this is what shows through it."
        )
    })
}

/// " The linear model predicts better: ..."
fn better_linear(model: &ServoModel) -> Option<String> {
    // Of a linear model that does not predict either, nobody should hear that it is better.
    let percent = (model.better_linear_percent())
        .filter(|percent| *percent >= POOR_PREDICTION_PERCENT || model.predicts())?;
    let found = model.linear_models.as_ref()?;
    Some(format!(
        " The linear model predicts better: use it. On the {} samples that both predict, it reaches {percent:.1} %, and the model \
         as a machine {:.1} %.",
        found.samples_used, found.servo_model_percent
    ))
}

/// Degrees, where no unit is known and the model takes the command for them.
fn assumed_units(model: &ServoModel, units: Units<'_>) -> Option<Units<'static>> {
    let degrees = Some("deg");
    let assumed = Units {
        input: degrees,
        output: degrees,
    };
    (units == Units::default() && model.radians_per_command == 1f64.to_radians()).then_some(assumed)
}

/// Times for 60 degrees that R/C servos have \[s\]: the fastest for the rotors of helicopters take 0.03 s, winches a second.
const USUAL_TURNS_S: std::ops::RangeInclusive<f64> = 0.025..=1.5;

/// " That is faster than ...": that no servo turns at this speed.
fn unlikely_speed(model: &ServoModel, speed: &Quantity, units: Units<'_>) -> Option<String> {
    let units = assumed_units(model, units).unwrap_or(units);
    let turn_s = turn_time_s(speed.value, units)?;
    let how = match turn_s {
        turn_s if USUAL_TURNS_S.contains(&turn_s) => return None,
        turn_s if turn_s < *USUAL_TURNS_S.start() => "faster",
        _ => "slower",
    };
    Some(format!(
        " That is {how} than R/C servos turn ({} to {} s/60°): make sure that the time between samples is {:.4} s, and the unit of the output right.",
        USUAL_TURNS_S.start(),
        USUAL_TURNS_S.end(),
        model.sample_period_s
    ))
}

#[cfg(test)]
mod tests {
    use super::super::servo_model::quantity_row;
    use super::*;
    use servoid_identification::results::{Bounds, Interval, Reason};
    use servoid_identification::servo_model::Unit;

    #[test]
    fn a_figure_without_an_interval_is_how_far_other_fits_go_apart() {
        let mut speed = Quantity {
            name: "top speed upwards".to_owned(),
            unit: Unit::OutputPerSecond,
            determined: true,
            value: 400.0,
            interval: Bounds::Valid(Interval::new(400.0, 390.0, 410.0)),
            other_fits: None,
        };
        assert_eq!(figure(&speed, 1.0), "400.0");
        speed.interval = Bounds::Withdrawn(Reason::ErrorsNotNoise);
        let (least, most) = (371.4, 421.7);
        speed.other_fits = Some(Spread { least, most });
        assert_eq!(figure(&speed, 1.0), "371-422");
        let row = quantity_row(&speed, Units::default());
        assert_eq!(
            (row.value.as_str(), row.interval.as_str()),
            ("400", "other fits 371 to 422")
        );
        speed.other_fits = Some(Spread {
            least: 399.6,
            most: 400.4,
        });
        assert_eq!(figure(&speed, 1.0), "about 400");
        speed.other_fits = None;
        assert_eq!(figure(&speed, 1.0), "about 400");
    }
}
