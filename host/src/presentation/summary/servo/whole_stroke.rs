//! How long a whole stroke takes, which is longer than a data sheet says.

use super::measured_limits::limits_in_words;
use super::top_speeds::{has_unreached_top_speeds, top_speeds};
use crate::data::units::Units;
use crate::presentation::summary::wording::sixty_degrees::{both_ways, sixty_degrees};
use servoid_identification::servo_model::ServoModel;

/// A step of this part of a stroke is one of its size: the servo rests a little off its command.
const AS_LARGE: f64 = 0.95;

const NOT_SHOWN: &str = "How long a stroke of 60 degrees takes is not known: the recording has none so large, and no top speed; or by this model a load or a stop holds it before.";

/// How long a whole stroke of 60 degrees takes, which people ask first, or why that is not known.
pub(crate) fn whole_stroke(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let Some(times) = model.stroke_times_s(sixty_degrees(units)?) else {
        return model.predicts().then(|| NOT_SHOWN.to_owned());
    };
    let times = both_ways(times);
    let (commands, servo) = (model.commands?, model.parameters(0));
    let [least, most] = servo.range();
    let [low, high] = [commands.least, commands.largest].map(|end| end.max(least).min(most));
    let recorded = (high - low) * servo.gain.abs();
    let step = recorded.min(model.fit.largest_error * servo.gain.abs());
    let beyond = (step < AS_LARGE * sixty_degrees(units)?)
        .then_some(" It is simulated: the recording has no step so large.");
    let at_speed = match (has_unreached_top_speeds(model), limits_in_words(model, units)) {
        (true, _) => {
            "the one at top speed, which the servo is not shown to reach in this recording, so that it may be extrapolated".to_owned()
        }
        (false, Some(limits)) => format!("that of {limits}"),
        (false, None) if top_speeds(model).is_some() => "the one at top speed".to_owned(),
        (false, None) => "the one at top speed, which this recording does not show".to_owned(),
    };
    let from = match model.fit.waits_for_pulses {
        Some(_) => "the pulse with the command",
        None => "the change of the command",
    };
    let stroke = match model.covariance.valid() {
        Some(_) => "A stroke",
        None => "By this model, whose figures may be off, a stroke",
    };
    Some(format!(
        "{stroke} of 60 degrees takes {times}, with delay, acceleration and braking: from {from} until the servo stays within 2 % of the stroke from its end; no interval of that time is known.{} \
         Data sheets leave that out: hold their time for 60 degrees against {at_speed}.",
        beyond.unwrap_or_default()
    ))
}
