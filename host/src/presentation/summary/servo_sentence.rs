//! The servo as a machine, in a sentence or two.

use super::layout::listed_words;
use super::servo_model::{OF_LIMIT, digits, four_digits, seconds_per_60_degrees, turn_time_s};
use crate::data::units::Units;
use servoid_identification::results::{Bounds, Reason};
use servoid_identification::servo_model::{LinearKind, LoadKind, Quantity, ServoModel};
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
    let speeds = top_speeds(model);
    let (what, doubt) = match model.covariance {
        Bounds::Valid(_) => (what_is_known(model, speeds, units), String::new()),
        Bounds::Withdrawn(reason) => (
            what_was_seen(model, speeds, units),
            format!(
                " Its figures have no intervals and may be off: {}{}.",
                reason.because(),
                match reason {
                    Reason::ErrorsNotNoise =>
                        ", so the servo or the recording has something that the model lacks",
                    _ => "",
                }
            ),
        ),
    };
    let doubts = [
        speeds.and_then(|[up, _]| unlikely_speed(model, up, units)),
        hidden_by_noise(model),
        better_linear(model),
    ];
    format!(
        "This servo {}. A model of it as a machine predicts parts of the recording that it has not seen to {:.1} %.{doubt}{}",
        listed_words(&what),
        model.prediction_percent(),
        doubts.into_iter().flatten().collect::<String>()
    )
}

/// What the model says of the servo, where its intervals hold.
fn what_is_known(
    model: &ServoModel,
    speeds: Option<[&Quantity; 2]>,
    units: Units<'_>,
) -> Vec<String> {
    let parts = [
        Some(limited_to(model, speeds, units).unwrap_or_else(|| kind(model).to_owned())),
        below_any_limit(model, units),
        resting_error(model, units),
        load(model).map(str::to_owned),
        delay(model),
    ];
    parts.into_iter().flatten().collect()
}

/// What the recording shows whether or not the model is right: of a servo that does more than its model, terms and figures stand for
/// what the model lacks (a load for a sagging supply, a delay for a slow profile generator).
fn what_was_seen(
    model: &ServoModel,
    speeds: Option<[&Quantity; 2]>,
    units: Units<'_>,
) -> Vec<String> {
    let kind = match speeds {
        Some(_) => "is limited in its speed",
        None => kind(model),
    };
    std::iter::once(kind.to_owned())
        .chain(moved_at(model, units))
        .collect()
}

/// How fast the servo moved in the recording.
fn moved_at(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let reached = model.reached?;
    let [up, down] = [reached.upwards, reached.downwards]
        .map(|speed| speed_in_words(model, (speed, digits(speed, 2)), units));
    let upwards = upwards(model);
    Some(format!(
        "moved at up to {up} {upwards} and {down} downwards in this recording"
    ))
}

/// The same where the model has no limit, which it may have beyond.
fn below_any_limit(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let moved = moved_at(model, units).filter(|_| !model.terms.limit)?;
    Some(format!("{moved} without reaching a limit"))
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

/// "is limited to 331 deg/s (0.181 s/60°)", where the record determines that.
fn limited_to(
    model: &ServoModel,
    speeds: Option<[&Quantity; 2]>,
    units: Units<'_>,
) -> Option<String> {
    let [up, down] =
        speeds?.map(|found| speed_in_words(model, (found.value, four_digits(found.value)), units));
    Some(match up == down {
        true => format!("is limited to {up}"),
        false => format!("is limited to {up} {} and {down} downwards", upwards(model)),
    })
}

/// Upwards, and what that is where the position goes against the command.
fn upwards(model: &ServoModel) -> &'static str {
    match model.parameters(0).gain < 0.0 {
        true => "upwards (the position grows, the command falls)",
        false => "upwards",
    }
}

/// "331 deg/s (0.181 s/60°)", of a speed and its figure.
fn speed_in_words(model: &ServoModel, (speed, figure): (f64, String), units: Units<'_>) -> String {
    let unit = with_space(units.output);
    format!("{figure}{unit}/s{}", turn(model, speed, units))
}

/// What kind of servo it is, without figures.
fn kind(model: &ServoModel) -> &'static str {
    match model.covariance {
        _ if model.terms.limit && shows_limit(model) => "is limited in its drive",
        // Terms of the drive stand for what a linear servo of higher order has, too.
        _ if model.terms.limit && linear_is_as_good(model) => "is much like a linear one",
        // Friction comes with a limit that the record may not reach.
        _ if model.terms.limit => "is not linear",
        Bounds::Valid(_) => "is linear",
        Bounds::Withdrawn(_) => "is much like a linear one",
    }
}

/// Whether the linear model beside it predicts unseen parts as well.
fn linear_is_as_good(model: &ServoModel) -> bool {
    let linear = model.linear_models.as_ref();
    let percent = linear.and_then(|found| {
        Some((
            found.percent_of(LinearKind::Linear)?,
            found.servo_model_percent,
        ))
    });
    percent.is_some_and(|(linear, servo)| linear >= servo)
}

/// Whether the record determines anything that a limit of the drive brings about.
fn shows_limit(model: &ServoModel) -> bool {
    let is_of_limit = |found: &&Quantity| OF_LIMIT.iter().any(|name| found.name.starts_with(name));
    let mut of_limit = model.quantities.iter().filter(is_of_limit);
    of_limit.any(|found| found.determined)
}

/// " (0.181 s/60°)", or what that is if the output is in degrees.
fn turn(model: &ServoModel, speed: f64, units: Units<'_>) -> String {
    let stated = seconds_per_60_degrees(speed, units);
    let assumed = || {
        let seconds = seconds_per_60_degrees(speed, assumed_units(model, units)?)?;
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
        format!(
            "comes to rest up to {}{command} off by friction",
            digits(error.value, 2)
        )
    })
}

/// The load, where the record shows that there is one: unequal drives may make the same motion.
fn load(model: &ServoModel) -> Option<&'static str> {
    let (name, words) = match model.terms.load {
        LoadKind::None => return None,
        LoadKind::Constant => (
            "load at the middle",
            "works as if against a constant load (a drive that is weaker to one side looks the same)",
        ),
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

/// Whether a quantity has one sign in its interval.
fn is_one_sided(quantity: &Quantity) -> bool {
    let interval = quantity.interval.valid();
    let ends = interval.and_then(|interval| interval.lower.zip(interval.upper));
    ends.is_some_and(|(lower, upper)| lower * upper > 0.0)
}

fn delay(model: &ServoModel) -> Option<String> {
    let delay = determined(model, "delay")?.value;
    Some(match delay < AT_ONCE * model.sample_period_s {
        true => "answers at once".to_owned(),
        false => format!("answers {} ms late", four_digits(1e3 * delay)),
    })
}

/// A delay of so many samples does not show.
const AT_ONCE: f64 = 0.01;

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
