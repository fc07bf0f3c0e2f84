//! The servo as a machine, in a sentence or two.

use super::layout::listed_words;
use super::measured_limits::{limits_in_words, measured_limits};
use super::numbers::{digits, four_digits};
use super::sixty_degrees::turn_time_s;
use super::speed_words::{assumed_units, reached_speed, speed_in_words, upwards};
use super::top_speeds::{determined, is_never_reached, top_speeds};
use crate::data::units::Units;
use servoid_identification::results::{Advice, Bounds, Model, Reason};
use servoid_identification::servo_model::{
    LinearKind, LoadKind, Quantity, QuantityKind, ServoModel, Spread,
};
use servoid_identification::thresholds::{POOR_PREDICTION_PERCENT, SERVO_MATERIAL_ADVANTAGE};

/// What kind of servo this is, in a sentence or two; and that the linear model is the one to use, where it predicts better. `linear` is that of
/// the same recording.
#[must_use]
pub fn servo_sentence(model: &ServoModel, linear: &Model, units: Units<'_>) -> String {
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
    let doubts = [
        model.covariance.withdrawn().map(without_intervals),
        changing_speed(model),
        unlikely_speed(model, units).map(|how| format!(" That is {how}.")),
        hysteresis(model, units),
        hidden_by_noise(model),
        better_linear(model),
    ];
    let predicts = format!(
        "predicts parts of the recording that it has not seen to {:.1} %.{}",
        model.prediction_percent(),
        doubts.into_iter().flatten().collect::<String>()
    );
    // What a servo of higher order does looks like a limit or a load to a machine of second order.
    match LinearBeside::of(model, linear) {
        Some(found) => {
            let moved = moved_at(model, units).map(|moved| format!(" The servo {moved}."));
            let moved = moved.unwrap_or_default();
            format!(
                "{}{moved} The model as a machine {predicts}",
                found.in_words()
            )
        }
        None => {
            let what = match model.covariance {
                Bounds::Valid(_) => what_is_known(model, linear, speeds, units),
                Bounds::Withdrawn(_) => what_was_seen(model, linear, speeds, units),
            };
            format!(
                "This servo {}. A model of it as a machine {predicts}",
                listed_words(&what)
            )
        }
    }
}

/// " Its figures have no intervals ...".
fn without_intervals(reason: Reason) -> String {
    let more = match reason {
        Reason::ErrorsNotNoise => {
            ", so the servo or the recording has something that the model lacks"
        }
        Reason::QuantisationAboveNoise => {
            ", and limits, loads and friction of the model may stand for them; a finer sensor, or larger strokes, would help"
        }
        Reason::NeverAtRest => " (holds in which it comes to rest would)",
        _ => "",
    };
    format!(
        " Its figures have no intervals and may be off: {}{more}.",
        reason.because()
    )
}

/// " Its strokes get slower ...".
fn changing_speed(model: &ServoModel) -> Option<String> {
    let change = model.speed_limits.change?;
    let how = if change < 0.0 { "slower" } else { "quicker" };
    Some(format!(
        " Its strokes get {how} along this recording, by {} % from the first to the last, as where a supply sags or a motor gets warm: no speed here is that \
         of all of it.",
        digits(100.0 * change.abs(), 2)
    ))
}

/// " Positions of rest ...": that they depend on the direction of approach by more than the model shows why.
fn hysteresis(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let found = model.unexplained_hysteresis()?;
    let unit = with_space(units.output);
    let explained = match found.explained > 0.0 {
        true if found.explained >= found.shown => {
            ", which the model explains by friction or a dead band".to_owned()
        }
        true => format!(
            ", of which the model explains {}{unit}",
            digits(found.explained, 2)
        ),
        false => String::new(),
    };
    Some(format!(
        " Positions of rest reached from above and from below are {}{unit} apart{explained}: play in the gears, of which the model has none, does that, as do a \
         dead band and friction. Play may be more than that, because a servo that overshoots comes to rest within it.",
        digits(found.shown, 3)
    ))
}

/// What a linear model beside a servo model that has more than a linear servo, and no intervals, makes of what that one says.
enum LinearBeside {
    /// The errors of the linear model are noise, and those of the servo model are not.
    Alone,
    /// The errors of the linear model are noise, and it predicts as well.
    AsGood,
    /// Nothing speaks against the linear model, which has no bounds but predicts as well.
    WithoutBounds,
    /// The same of strokes between two levels, whose answers a linear model learns by heart, whatever the servo does in others.
    HiddenByLevels,
    /// The command has noise that the servo may not have been sent: errors of any model follow the motion then.
    HiddenByCommand,
}

impl LinearBeside {
    /// `None` where the servo model is the one to speak of. Of a response in a band the linear model is a picture, which predicts little; the errors
    /// are those of the band.
    fn of(model: &ServoModel, linear: &Model) -> Option<Self> {
        let is_settled = model.is_linear() || model.covariance.valid().is_some();
        let is_limited = measured_limits(model).iter().any(Option::is_some);
        if is_settled || is_limited {
            return None;
        }
        let has_noise = linear.advice.iter().any(Advice::is_of_command_noise);
        if has_noise && lacks_something(model) {
            return Some(Self::HiddenByCommand);
        }
        if !linear.linear {
            return None;
        }
        let (lacks, as_good) = (lacks_something(model), linear_is_as_good(model));
        if as_good && model.covariance.withdrawn() == Some(Reason::FewLevels) {
            return Some(Self::HiddenByLevels);
        }
        match linear.bounds.valid() {
            Some(_) if as_good && lacks => Some(Self::Alone),
            Some(_) if as_good => Some(Self::AsGood),
            None if linear.band().is_some() && lacks => Some(Self::Alone),
            None if as_good => Some(Self::WithoutBounds),
            _ => None,
        }
    }

    /// A sentence.
    fn in_words(&self) -> &'static str {
        match self {
            Self::Alone => {
                "A linear servo describes this recording down to its noise, and a model of it as a machine does not."
            }
            Self::AsGood => {
                "A linear servo describes this recording down to its noise, as well as a model of it as a machine."
            }
            Self::WithoutBounds => {
                "A linear servo describes this recording as well as a model of it as a machine."
            }
            Self::HiddenByLevels => {
                "Strokes between two levels do not show whether this servo is linear: a linear one describes this recording as well as a model of it as a machine."
            }
            Self::HiddenByCommand => {
                "Noise in the column of the command hides whether this servo is linear."
            }
        }
    }
}

/// Whether the servo is called linear: by its linear model, and by what is said of it as a machine where that is to be relied on.
#[must_use]
pub fn is_called_linear(linear: &Model, servo: Option<&ServoModel>) -> bool {
    let speaks =
        servo.filter(|servo| servo.predicts() && LinearBeside::of(servo, linear).is_none());
    linear.linear && speaks.is_none_or(|servo| is_said_linear(servo, linear))
}

/// Whether the sentence on the servo as a machine calls it linear, or much like that. Of a top speed that was never reached the recording has nothing.
fn is_said_linear(model: &ServoModel, linear: &Model) -> bool {
    let is_limited = measured_limits(model).iter().any(Option::is_some);
    let lacks_a_stop = model.covariance.valid().is_none() && may_lack_a_stop(model);
    match top_speeds(model) {
        _ if is_limited || lacks_a_stop => false,
        Some(speeds) => is_never_reached(model, &speeds) && linear_is_as_good(model),
        None => KindOfServo::of(model, linear).is_linear(),
    }
}

/// Whether its errors show that the model lacks something of the servo, or would if the steps of the sensor were smaller.
fn lacks_something(model: &ServoModel) -> bool {
    matches!(
        model.covariance.withdrawn(),
        Some(Reason::ErrorsNotNoise | Reason::QuantisationAboveNoise)
    )
}

fn may_lack_a_stop(model: &ServoModel) -> bool {
    lacks_something(model) && model.terms.is_limited() && !is_nearly_linear(model)
}

/// What the model says of the servo, where its intervals hold.
fn what_is_known(
    model: &ServoModel,
    linear: &Model,
    speeds: Option<[&Quantity; 2]>,
    units: Units<'_>,
) -> Vec<String> {
    let never_reached = speeds.filter(|speeds| is_never_reached(model, speeds));
    let parts = [
        Some(
            limited_to(model, speeds, units, 4)
                .unwrap_or_else(|| KindOfServo::of(model, linear).in_words().to_owned()),
        ),
        never_reached.and_then(|_| moved_at(model, units)),
        below_any_limit(model, units),
        resting_error(model, units),
        load(model),
        delay(model),
    ];
    parts.into_iter().flatten().collect()
}

/// What the recording shows whether or not the model is right: of a servo that does more than its model, terms and figures stand for
/// what the model lacks (a load for a sagging supply, a delay for a filter of the command).
fn what_was_seen(
    model: &ServoModel,
    linear: &Model,
    speeds: Option<[&Quantity; 2]>,
    units: Units<'_>,
) -> Vec<String> {
    if let Some(limits) = limits_in_words(model, units) {
        let limited = format!(
            "is limited to about {limits} in this recording, the speed of its larger strokes"
        );
        return std::iter::once(limited)
            .chain(stopped(model, units))
            .collect();
    }
    let agreed = speeds.and_then(|speeds| agreed(model, speeds));
    let kind = limited_to(model, agreed, units, 3).unwrap_or_else(|| match speeds {
        // The speed that follows is not to be read as the limit.
        Some(speeds) if is_never_reached(model, &speeds) => "shows no top speed".to_owned(),
        Some(_) => "is limited in its speed".to_owned(),
        // A stop in the travel looks like a drive that a load holds.
        None if may_lack_a_stop(model) => "is not linear".to_owned(),
        None => KindOfServo::of(model, linear).in_words().to_owned(),
    });
    // A limit that was reached says how fast the servo moved.
    let at_limit = agreed.is_some_and(|speeds| !is_never_reached(model, &speeds));
    let moved = moved_at(model, units).filter(|_| !at_limit);
    let parts = [Some(kind), stopped(model, units), moved];
    parts.into_iter().flatten().collect()
}

/// "runs into a stop at 12.01 deg".
fn stopped(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let unit = with_space(units.output);
    let at = |output: f64| format!("{}{unit}", four_digits(output));
    match (model.stops.lower, model.stops.upper) {
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
fn moved_at(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let reached = model.reached?;
    let directions = [
        (reached.upwards, upwards(model)),
        (reached.downwards, "downwards"),
    ];
    // A recording may have no stroke in one direction.
    let moved = directions.iter().filter(|(speed, _)| *speed > 0.0);
    let each = moved.map(|(speed, direction)| {
        let speed = speed_in_words(model, reached_speed(*speed), units);
        format!("{speed} {direction}")
    });
    let each: Vec<String> = each.collect();
    (!each.is_empty()).then(|| {
        format!(
            "moved at more than {} in this recording",
            listed_words(&each)
        )
    })
}

/// The same where the model has no limit, which it may have beyond.
fn below_any_limit(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let moved = moved_at(model, units).filter(|_| !model.terms.is_limited())?;
    Some(format!("{moved} without reaching a limit"))
}

/// Other fits to the record whose top speeds are within this part of it of each other have one top speed: it is what counts as the same where
/// servos are compared.
const SAME_SPEED: f64 = 0.05;

/// Top speeds without intervals on which all fits agree, and which the servo has not surely exceeded: a limit that was exceeded is none. Where errors show that the model lacks something, speeds may stand for that.
fn agreed<'q>(model: &ServoModel, speeds: [&'q Quantity; 2]) -> Option<[&'q Quantity; 2]> {
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

/// "is limited to 331 deg/s (0.181 s/60°)", where the record determines that, with so many digits.
fn limited_to(
    model: &ServoModel,
    speeds: Option<[&Quantity; 2]>,
    units: Units<'_>,
    count: usize,
) -> Option<String> {
    let [up, down] = speeds?
        .map(|found| speed_in_words(model, (found.value, digits(found.value, count)), units));
    let limits = match up == down {
        true => up,
        false => format!("{up} {} and {down} downwards", upwards(model)),
    };
    Some(match is_never_reached(model, &speeds?) {
        true => format!("never reached its top speed of {limits}"),
        false => format!("is limited to {limits}"),
    })
}

/// What kind of servo it is, without figures.
#[derive(Clone, Copy, Debug, PartialEq)]
enum KindOfServo {
    Linear,
    MuchLikeLinear,
    /// To the model as a machine alone.
    LinearAsMachine,
    /// But for a stop.
    LinearToStop,
    /// By so little that nobody need care.
    NotQuiteLinear,
    /// Without a term that shows how.
    NotLinearUnshown,
    NotLinear,
    LimitedInSpeed,
    LimitedInDrive,
}

impl KindOfServo {
    /// One that the `linear` model shows not to be linear is not called so for want of a term.
    fn of(model: &ServoModel, linear: &Model) -> Self {
        let shown_not_linear = !linear.linear || linear.advice.iter().any(Advice::is_of_linearity);
        let nearly = is_nearly_linear(model);
        match model.covariance {
            Bounds::Withdrawn(_) if nearly && shown_not_linear => Self::NotQuiteLinear,
            Bounds::Withdrawn(_) if nearly => Self::MuchLikeLinear,
            _ if model.terms.speed_limit && shows_limit(model) => Self::LimitedInSpeed,
            _ if model.terms.limit && shows_limit(model) => Self::LimitedInDrive,
            Bounds::Withdrawn(_) if model.is_linear() && !model.stops.are_none() => {
                Self::LinearToStop
            }
            Bounds::Withdrawn(_) if shown_not_linear && model.is_linear() => Self::NotLinearUnshown,
            Bounds::Withdrawn(_) if shown_not_linear => Self::NotLinear,
            // Terms of the drive stand for what a linear servo of higher order has, too.
            _ if model.terms.is_limited() && !shown_not_linear && linear_is_as_good(model) => {
                Self::MuchLikeLinear
            }
            // Friction comes with a limit that the record may not reach.
            _ if model.terms.is_limited() => Self::NotLinear,
            Bounds::Valid(_) if shown_not_linear => Self::LinearAsMachine,
            Bounds::Valid(_) => Self::Linear,
            Bounds::Withdrawn(_) => Self::MuchLikeLinear,
        }
    }

    fn is_linear(self) -> bool {
        matches!(self, Self::Linear | Self::MuchLikeLinear)
    }

    /// What the servo does.
    fn in_words(self) -> &'static str {
        match self {
            Self::Linear => "is linear",
            Self::MuchLikeLinear => "is much like a linear one",
            Self::LinearAsMachine => "is as a linear one to a model of it as a machine",
            Self::LinearToStop => "is much like a linear one until it is stopped",
            Self::NotQuiteLinear => "is not quite linear",
            Self::NotLinearUnshown => {
                "is not linear, in a way that no term of a model of it as a machine shows,"
            }
            Self::NotLinear => "is not linear",
            Self::LimitedInSpeed => "is limited in its speed",
            Self::LimitedInDrive => "is limited in its drive",
        }
    }
}

/// Whether the linear model beside it predicts unseen parts as well, by what terms must take away to be taken.
fn linear_is_as_good(model: &ServoModel) -> bool {
    let left = |percent: f64| (100.0 - percent).powi(2);
    let linear = model.linear_models.as_ref();
    let percents = linear.and_then(|found| {
        Some((
            found.percent_of(LinearKind::Linear)?,
            found.servo_model_percent,
        ))
    });
    percents.is_some_and(|(linear, servo)| {
        left(servo) >= (1.0 - SERVO_MATERIAL_ADVANTAGE) * left(linear)
    })
}

/// Whether a linear servo of second order predicts all but a thousandth of parts not seen. Where the noise is as small, what terms take away beyond chance
/// is of no use to anybody, and may be that of a program that made the recording.
fn is_nearly_linear(model: &ServoModel) -> bool {
    model.fit.linear_held_out_percent > NEARLY_ALL_PERCENT
}

const NEARLY_ALL_PERCENT: f64 = 99.9;

/// Whether the record determines anything that a limit of the drive brings about.
pub(super) fn shows_limit(model: &ServoModel) -> bool {
    let determined = model.quantities.iter().filter(|found| found.determined);
    let mut kinds = determined.filter_map(Quantity::kind);
    kinds.any(|kind| QuantityKind::OF_LIMIT.contains(&kind))
}

/// " deg"; nothing of an unknown unit.
fn with_space(unit: Option<&str>) -> String {
    unit.map(|unit| format!(" {unit}")).unwrap_or_default()
}

fn resting_error(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let error = determined(model, QuantityKind::RestingError)?;
    (error.value > 0.0).then(|| {
        let command = with_space(units.input);
        let bounds = error.interval.valid();
        let bounds = bounds.and_then(|found| found.lower.zip(found.upper));
        // A number that may be twice as large, or none, is not said without its interval.
        let wide = bounds.filter(|(lower, upper)| upper - lower > error.value);
        let wide = wide.map_or_else(String::new, |(lower, upper)| {
            format!(" ({} to {})", digits(lower, 2), digits(upper, 2))
        });
        format!(
            "comes to rest up to {}{command} off{wide}, as by friction, a dead band or play",
            digits(error.value, 2)
        )
    })
}

/// What has the motion of a constant load as well.
pub(crate) const LOOKS_LIKE_A_LOAD: &str = "a drive that is weaker to one side looks the same";

/// The load, where the record shows that there is one: unequal drives may make the same motion.
fn load(model: &ServoModel) -> Option<String> {
    let (kind, words) = match model.terms.load {
        LoadKind::None => return None,
        LoadKind::Constant => (
            QuantityKind::LoadAtMiddle,
            format!("works as if against a constant load ({LOOKS_LIKE_A_LOAD})"),
        ),
        LoadKind::Pendulum | LoadKind::TiltedPendulum => {
            (QuantityKind::LoadOfLevelArm, "carries a weight".to_owned())
        }
        LoadKind::Air => (
            QuantityKind::LoadAtMiddle,
            "works against a load that stiffens to one side, as an end of its travel does"
                .to_owned(),
        ),
    };
    let is_shown = |load: &&Quantity| {
        is_one_sided(load) && load.value.abs() * model.radians_per_command < LARGEST_LOAD
    };
    determined(model, kind).filter(is_shown).map(|_| words)
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
    let found = determined(model, QuantityKind::Delay)?;
    let (delay, at_once) = (found.value, AT_ONCE * model.sample_period_s);
    let interval = found.interval.valid();
    let ends = interval.and_then(|interval| interval.lower.zip(interval.upper));
    Some(match ends {
        Some((lower, upper)) if upper - lower > VAGUE * delay && upper > at_once => {
            let upper = digits(1e3 * upper, 3);
            match lower < at_once {
                true => format!("answers at most {upper} ms late"),
                false => format!("answers {} to {upper} ms late", digits(1e3 * lower, 3)),
            }
        }
        _ if delay < at_once => "answers at once".to_owned(),
        _ => format!("answers {} ms late", four_digits(1e3 * delay)),
    })
}

/// A delay whose interval is wider than this part of it is said as that interval.
const VAGUE: f64 = 0.5;

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

/// Times for 60 degrees that R/C servos have \[s\]: the fastest for the rotors of helicopters take 0.03 s, winches a second.
const USUAL_TURNS_S: std::ops::RangeInclusive<f64> = 0.025..=1.5;

/// "faster than R/C servos turn ...", of a top speed that no servo has, and what may be wrong.
pub(crate) fn unlikely_speed(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let units = assumed_units(model, units).unwrap_or(units);
    let [upwards, _] = top_speeds(model)?;
    let turn_s = turn_time_s(upwards.value, units)?;
    let how = match turn_s {
        turn_s if USUAL_TURNS_S.contains(&turn_s) => return None,
        turn_s if turn_s < *USUAL_TURNS_S.start() => "faster",
        _ => "slower",
    };
    Some(format!(
        "{how} than R/C servos turn ({} to {} s/60°): make sure that the time between samples is {:.4} s, and the unit of the output right",
        USUAL_TURNS_S.start(),
        USUAL_TURNS_S.end(),
        model.sample_period_s
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presentation::summary::limited_servo::limited_servo;
    use servoid_identification::results::Interval;

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
            delay(&model).unwrap()
        };
        assert_eq!(words(0.0078, 0.0081), "answers 8.000 ms late");
        assert_eq!(words(0.0, 0.019), "answers at most 19.0 ms late");
        assert_eq!(words(0.0031, 0.019), "answers 3.10 to 19.0 ms late");
    }
}
