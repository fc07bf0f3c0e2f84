//! The servo as a machine, in a sentence or two.

use super::clauses::{
    agreed, below_any_limit, delay, limited_to, load, moved_at, play, resting_error, stalled,
    stopped,
};
use super::doubts::{
    better_linear, changing_speed, hidden_by_noise, hysteresis, unlikely_speed, without_intervals,
};
use super::kind_of_servo::KindOfServo;
use super::linear_beside::{LinearBeside, may_lack_a_stop};
use super::measured_limits::limits_in_words;
use super::top_speeds::{is_never_reached, top_speeds};
use crate::data::units::Units;
use crate::presentation::summary::wording::layout::listed_words;
use servoid_identification::results::{Bounds, Model};
use servoid_identification::servo_model::{Quantity, ServoModel};

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
        (model.covariance.withdrawn()).map(|reason| without_intervals(model, reason, units)),
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
            limited_to(model, speeds, units, ("is limited to", 4))
                .unwrap_or_else(|| KindOfServo::of(model, linear).in_words().to_owned()),
        ),
        never_reached.and_then(|_| moved_at(model, units)),
        below_any_limit(model, units),
        play(model, units),
        resting_error(model, units),
        stalled(model, units),
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
            "is limited in its speed: its larger strokes go at about {limits} in this recording, and the limit is that or more"
        );
        return std::iter::once(limited)
            .chain(stopped(model, units))
            .collect();
    }
    // One that was never reached may be anything, where nothing shows what the model has it from.
    let agreed = speeds.filter(|speeds| !is_never_reached(model, speeds));
    let agreed = agreed.and_then(|speeds| self::agreed(model, speeds));
    let kind =
        limited_to(model, agreed, units, ("moves as if limited to", 3)).unwrap_or_else(|| {
            match speeds {
                // The speed that follows is not to be read as the limit.
                Some(speeds) if is_never_reached(model, &speeds) => "shows no top speed".to_owned(),
                Some(_) => "is limited in its speed".to_owned(),
                // A stop in the travel looks like a drive that a load holds.
                None if may_lack_a_stop(model) => "is not linear".to_owned(),
                None => KindOfServo::of(model, linear).in_words().to_owned(),
            }
        });
    // A limit that was reached says how fast the servo moved.
    let moved = moved_at(model, units).filter(|_| agreed.is_none());
    let parts = [Some(kind), stopped(model, units), moved];
    parts.into_iter().flatten().collect()
}
