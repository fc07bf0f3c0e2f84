//! What speaks against the figures of a servo model, each in a sentence.

use super::clauses::with_space;
use super::top_speeds::top_speeds;
use crate::data::units::Units;
use crate::presentation::summary::wording::numbers::digits;
use crate::presentation::summary::wording::sixty_degrees::turn_time_s;
use crate::presentation::summary::wording::speed_words::assumed_units;
use servoid_identification::results::{Reason, with_unit};
use servoid_identification::servo_model::ServoModel;
use servoid_identification::thresholds::POOR_PREDICTION_PERCENT;

/// " Its figures have no intervals ...".
pub(super) fn without_intervals(model: &ServoModel, reason: Reason, units: Units<'_>) -> String {
    let size = model.fit.lacking.map_or_else(String::new, |lacking| {
        let size = with_unit(digits(lacking, 2), units.output.unwrap_or_default());
        format!(", up to about {size} rms,")
    });
    let not_noise = match model.fit.servo_changed {
        true => format!(
            ", but those of each run by itself are: the servo changed from run to run{}",
            size.trim_end_matches(',')
        ),
        false => {
            format!(
                ", as where the servo or the recording has something{size} that the model lacks"
            )
        }
    };
    let more = match reason {
        Reason::ErrorsNotNoise => &not_noise,
        Reason::QuantisationAboveNoise => {
            ", and limits, loads and friction of the model may stand for them, or it lacks something of the servo, which does not show beside them; a finer sensor shows which"
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
pub(super) fn changing_speed(model: &ServoModel) -> Option<String> {
    let change = model.speed_limits.change?;
    let how = if change < 0.0 { "slower" } else { "quicker" };
    Some(format!(
        " Its strokes get {how} along this recording, by {} % from the first to the last, as where a supply sags or a motor gets warm: no speed here is that \
         of all of it.",
        digits(100.0 * change.abs(), 2)
    ))
}

/// " Rests under one command ...": that they depend on the direction of approach by more than the model shows why.
pub(super) fn hysteresis(model: &ServoModel, units: Units<'_>) -> Option<String> {
    let found = model.unexplained_hysteresis()?;
    let unit = with_space(units.output);
    let Some(shown) = found.shown else {
        let mean = model
            .hysteresis
            .and_then(|of| Some([of.value?, of.lower?, of.upper?].map(|number| digits(number, 2))));
        let mean = mean.map_or_else(String::new, |[mean, lower, upper]| {
            format!(", by {mean}{unit} in the mean ({lower} .. {upper})")
        });
        return Some(format!(
            " Where it rests under one command depends on from where it comes{mean}, and how far its rests are apart at the most this recording does not show: play in the gears, a dead band and friction do that."
        ));
    };
    let why = match found.explained {
        explained if explained >= shown => {
            "friction, a dead band or play of the model does that, and it may be another of these"
                .to_owned()
        }
        explained if explained > 0.0 => format!(
            "friction, a dead band or play of the model makes {}{unit} of that, and what the rest of it is, is not known",
            digits(explained, 2)
        ),
        _ => "play in the gears, a dead band and friction do that, and the model has none of them"
            .to_owned(),
    };
    Some(format!(
        " Rests under one command are as much as {}{unit} apart: {why}.",
        digits(shown, 3)
    ))
}

/// " Noise alone would leave ...": that a poor fit is that of noise, and what it means.
pub(super) fn hidden_by_noise(model: &ServoModel) -> Option<String> {
    let reachable = model.reachable_percent()?;
    (model.prediction_percent() < POOR_PREDICTION_PERCENT).then(|| {
        format!(
            " Noise alone would leave {reachable:.1} %: it may hide friction, limits and load, so this is what shows through it."
        )
    })
}

/// " The linear model predicts better: ..."
pub(super) fn better_linear(model: &ServoModel) -> Option<String> {
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
