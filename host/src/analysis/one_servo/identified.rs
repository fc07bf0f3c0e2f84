//! The linear model of a data set, with the advice that its files ask for.

use crate::analysis::command_times::command_edges::{CommandEdges, command_edges};
use crate::analysis::command_times::pulse_frames::has_equal_holds;
use crate::analysis::duration_in_words::in_words;
use crate::analysis::recording_advice::angle_units::{advice_on_gain, advice_on_travel};
use crate::analysis::recording_advice::no_step;
use crate::analysis::recording_advice::sample_period::unlikely_period;
use crate::analysis::recording_advice::short_of_command;
use crate::analysis::recording_advice::travel;
use crate::data::dataset::Dataset;
use crate::data::dataset::suggested_columns::quoted;
use crate::data::sensor_preset::is_of_data_sheet;
use crate::presentation::summary::percent;
use anyhow::{Context, Result};
use servoid_identification::results::{Advice, Check, Interval, Model, Reason, pointwise_critical};
use servoid_identification::servo_model::{ServoModel, WaitsForPulses};
use servoid_identification::{Identification, Options, identify_explained};
use servoid_protocol::hello::INTERNAL_CLOCK_ERROR;
use std::ops::RangeInclusive;

/// Identifies data; its advice becomes the model's.
///
/// # Errors
/// That of the identification, behind the `name` of the data.
pub fn identified(data: &Dataset, name: &str, options: &Options) -> Result<Identification> {
    let found = identify_explained(&data.record, options);
    let mut found = found.with_context(|| name.to_owned())?;
    let advice = &mut found.model.advice;
    if advice.iter().any(Advice::is_of_exchange) {
        advice.retain(|item| !item.follows_from_exchange());
    }
    found.model.advice.extend(data.about.advice.iter().cloned());
    found.model.advice.extend(several_controllers(data));
    // What follows from these is not to be read before them.
    found
        .model
        .advice
        .sort_by_key(|item| !item.explains_others());
    travel::withdraw_at_stops(data, &mut found.model);
    let doubtful = unlikely_period(data.record.sample_period_s());
    let doubtful = doubtful.or_else(|| unlikely_duration(&found.model));
    let doubtful = doubtful.or_else(|| unlikely_wait(&found.model));
    let mixed = advice_on_gain(&found.model, data.about.units());
    let mixed = mixed.into_iter().chain(advice_on_travel(data));
    let off = travel::advice(data, &found.model);
    let off = off.or_else(|| short_of_command::advice(data, &found.model));
    name_planned_command(data, &mut found.model.advice);
    found
        .model
        .advice
        .splice(0..0, doubtful.into_iter().chain(mixed).chain(off));
    let in_frames = match command_edges(data, &found, options) {
        Some(CommandEdges::BetweenRows(advice)) => {
            found.model.withdraw_times(Reason::CommandsBetweenRows);
            // Errors that follow the motion are its consequence.
            found
                .model
                .advice
                .retain(|item| !item.is_of_errors_in_motion());
            Advice::name_waits_of_runs(&mut found.model.advice);
            found.model.advice.insert(0, advice);
            None
        }
        Some(CommandEdges::AsStated) => {
            explained_by_waits(&mut found.model);
            None
        }
        Some(CommandEdges::WithPulses(advice)) => {
            explained_by_waits(&mut found.model);
            Some(advice)
        }
        Some(CommandEdges::InFrames(advice)) => Some(advice),
        None => {
            name_pulses(data, &mut found.model.advice);
            name_logger(data, &mut found.model);
            None
        }
    };
    let of_data = in_frames
        .into_iter()
        .chain(no_step::advice(data, &found.model))
        .chain(against_command(data, &found.model));
    let of_data: Vec<Advice> = of_data.chain(rough_scale(data, &found.model)).collect();
    found.model.advice.extend(of_data);
    Advice::name_unlike_runs(&mut found.model.advice);
    if data.about.inexact_clock {
        let [slow, fast] = INTERNAL_CLOCK_ERROR;
        found.model.metrics = found.model.metrics.with_clock_error(slow, fast);
    }
    let delay_error_s = data.about.sensor_delay_uncertainty_s;
    found.model = found.model.with_delay_error(delay_error_s);
    if data.about.moving_command {
        found.model = found.model.with_command_between_samples();
    }
    Ok(found)
}

/// That the linear model is one of runs that are stated to have had different controllers.
fn several_controllers(data: &Dataset) -> Option<Advice> {
    let names: Vec<String> = data
        .controllers
        .names()
        .iter()
        .map(f64::to_string)
        .collect();
    (names.len() > 1).then(|| {
        Advice::new(
            Check::UnlikeRuns,
            format!(
                "The runs had the controllers {}, and the linear model mixes them: it is that of none.",
                names.join(", ")
            ),
            names.len() as f64,
            1.0,
            "Take the servo model, which keeps them apart ('--servo-model'), or identify the runs of each controller alone.",
        )
    })
}

/// Of an input that follows the output: that the file has another column of commands, where it does, and that commands may have waited.
fn name_planned_command(data: &Dataset, advice: &mut [Advice]) {
    let column = data.about.other_input.as_ref().map(|column| {
        format!(
            " The file has a column {column:?}, too: where that was planned before, --input {} gives the response of servo and controller together.",
            quoted(column)
        )
    });
    for found in advice.iter_mut().filter(|found| found.is_of_feedback()) {
        found.remedy += column.as_deref().unwrap_or_default();
        if data.about.commands_may_wait() {
            found.remedy += BY_WAITS;
        }
    }
}

/// What makes a command that nothing feeds back look so.
const BY_WAITS: &str = " A smooth command that was planned before and waited for pulses on a clock of their own may look so, too: 'servoid identify --servo-model' looks for these pulses.";

/// Errors that follow the motion are those of commands that came at other times than their rows, about a mean that the response contains:
/// nothing else says that the servo is not linear. Where they took the bounds, they are larger than that.
fn explained_by_waits(model: &mut Model) {
    if model.bounds.valid().is_some() {
        model.linear = true;
        model.advice.retain(|item| !item.is_of_errors_in_motion());
        Advice::name_waits_of_runs(&mut model.advice);
    }
}

/// The same of pulses that a `servo` model found: the linear one has each command in its row, has no bounds for that reason where it has none, and whether it `is_linear` a linear model of the commands at their pulses says.
pub(super) fn explained_by_pulses(model: &mut Model, servo: &ServoModel, is_linear: bool) {
    let waits = servo.fit.waits_for_pulses;
    let Some(waits) = waits.filter(|_| !model.advice.iter().any(Advice::is_of_waits)) else {
        return;
    };
    model.linear = is_linear;
    let is_of_waits = |item: &Advice| item.is_of_errors_in_motion() || item.is_of_feedback();
    model.advice.retain(|item| !is_of_waits(item));
    Advice::name_waits_of_runs(&mut model.advice);
    model.advice.insert(0, by_pulses(waits));
    let by_waits = [Reason::ErrorsNotNoise, Reason::InputFollowsOutput].map(Some);
    if by_waits.contains(&model.bounds.withdrawn()) {
        *model = model.clone().withdrawn_for(Reason::CommandsWait);
    }
}

/// That a linear model has commands in their rows that waited for pulses.
pub(crate) fn by_pulses(waits: WaitsForPulses) -> Advice {
    Advice::new(
        Check::CommandEdges,
        format!(
            "Commands waited for pulses {}, and in the linear model each is in force from its row on: errors that follow the motion are of these waits, and of what is not linear in the servo.",
            waits.in_words()
        ),
        waits.frame_s,
        0.0,
        "Take the servo model, which has each command at its pulse. For a linear model without these waits, write each command at the pulse with which it begins.",
    )
}

/// Of errors that follow the motion in a file of another program: that commands may have waited for pulses. Under holds of one length such waits creep from command to
/// command, and nothing shows that they are of a clock.
fn name_pulses(data: &Dataset, advice: &mut [Advice]) {
    if !(data.about.commands_may_wait() && has_equal_holds(&data.record)) {
        return;
    }
    for found in advice.iter_mut().filter(|found| found.is_of_linearity()) {
        found.remedy += " Commands that wait for pulses on a clock of their own make a linear servo look so, too, and under holds of one length nothing shows it: change \
                         them with the pulses, or hold them for different times.";
    }
}

/// Of a servo that is not linear, in a file of another program: what its times are counted from. Its answers scatter by themselves, so that they do not
/// [show](command_edges) a logger with a clock of its own.
fn name_logger(data: &Dataset, model: &mut Model) {
    if !data.about.commands_at_rows || data.about.exact_command || model.bounds.valid().is_none() {
        return;
    }
    let half_row = in_words(0.5 * model.sample_period_s);
    let not_linear = model.advice.iter_mut();
    for found in not_linear.filter(|found| found.is_of_linearity()) {
        found.remedy += &format!(
            " Times count from the row in which a command changes. If the logger looked for the command once in a row, by a clock of its own and not that of the pulses, say --polled: without it all times are {half_row} too early, \
             which no interval here contains, and the answers of such a servo do not show it."
        );
    }
}

/// That the servo turns the other way, where command and position are both degrees.
fn against_command(data: &Dataset, model: &Model) -> Option<Advice> {
    let units = data.about.units();
    let gain = model.metrics.dc_gain;
    let highest = gain.upper.or(gain.value)?;
    (units.input == Some("deg") && units.output == units.input && highest < 0.0).then(|| {
        Advice::new(
            Check::Calibration,
            format!(
                "The position goes against the command: the gain is {:.2}.",
                gain.value.unwrap_or(highest)
            ),
            highest,
            0.0,
            "If it should follow, change the sign of one of them: of us_per_degree or degrees_per_count in the rig file ('servoid calibrate' finds both), \
             or of a column.",
        )
    })
}

/// What makes a scale surer that a calibration found, where it is not as sure as the gain.
const MORE_ANGLES: &str = "It was calibrated. More positions, and positions nearer to the ends of the travel ('servoid calibrate --pulses'), make \
     it surer, and so do angles that are read more closely. Where the gain is not used, nothing needs to be done.";

/// That the scale of the sensor is not known as well as the gain.
fn rough_scale(data: &Dataset, model: &Model) -> Option<Advice> {
    let sd_percent = data
        .about
        .calibrations
        .iter()
        .map(|found| found.scale_sd_percent);
    let sd_percent = sd_percent.fold(0.0, f64::max);
    // A model without bounds has a gain as well, and the servo model beside it may have bounds.
    let level = model.level().into_valid();
    let gain = model.metrics.dc_gain;
    let half_percent = match (level, gain.ends()) {
        (Some(_), Some([lower, upper])) => 50.0 * ((upper - lower) / gain.value?).abs(),
        _ if is_of_data_sheet(sd_percent) => 0.0,
        _ => return None,
    };
    let level = level.unwrap_or(Options::default().level);
    let scale_percent = pointwise_critical(level) * sd_percent;
    (scale_percent > half_percent).then(|| {
        Advice::new(
            Check::Calibration,
            format!(
                "The scale of the sensor is known to ±{scale_percent:.1} % only ({} % confidence), which no interval here contains: the gain, \
                 speeds and positions may all be off by that. Times and shares do not depend on it.",
                percent(level)
            ),
            scale_percent,
            half_percent,
            match is_of_data_sheet(sd_percent) {
                false => MORE_ANGLES,
                true => {
                    "Calibrate ('servoid calibrate') before the gain is used, with angles as far apart as the travel allows."
                }
            },
        )
    })
}

/// Times after which an R/C servo stays at its end, and after which it is half way there \[s\]. Slow winches and the fastest servos of
/// gyros lie within them by a factor of two.
const SETTLING_S: RangeInclusive<f64> = 5e-3..=5.0;
const HALF_WAY_S: RangeInclusive<f64> = 1e-3..=1.0;

/// That no servo takes as long, or as short, as this response.
fn unlikely_duration(model: &Model) -> Option<Advice> {
    let metrics = &model.metrics;
    if model.may_answer_later_steps() {
        return None;
    }
    let settled = (metrics.settling_time_s, SETTLING_S, "is at its end");
    let half_way = (metrics.t50_s, HALF_WAY_S, "is half way");
    let mut both = [settled, half_way].into_iter();
    let (found, usual, what) = both.find(|(found, ..)| found.value.is_some())?;
    // The end of a response without bounds may be that of errors: a wrong time between samples moves all of it.
    let has_bounds = metrics.bounds.valid().is_some();
    let is_half_way = |time: f64| HALF_WAY_S.contains(&time);
    if !has_bounds && metrics.t50_s.value.is_some_and(is_half_way) {
        return None;
    }
    let time = found.value?;
    if may_be_within(found, &usual, has_bounds) {
        return None;
    }
    let (limit, which, other_cause) = match time > *usual.end() {
        true => (
            *usual.end(),
            "longer than any R/C servo takes",
            " If it is, the input may be a speed, which sets how fast the output turns and not where it stops: then take the speed of the output \
             as the output.",
        ),
        false => (
            *usual.start(),
            "shorter than any R/C servo can",
            " If it is, a controller may compute the input from the output of the same sample: then this describes the controller, turned \
             round, and not the servo.",
        ),
    };
    Some(Advice::new(
        Check::Duration,
        format!("The response {what} after {}, {which}.", in_words(time)),
        time,
        limit,
        format!(
            "Make sure that the time between samples is {}, as it was taken to be: all times and frequencies follow from it.{other_cause}",
            in_words(model.sample_period_s)
        ),
    ))
}

/// Whether a time may be a usual one, as far as it is known.
fn may_be_within(found: Interval, usual: &RangeInclusive<f64>, has_bounds: bool) -> bool {
    let [lower, upper] = match has_bounds {
        true => [
            found.lower.unwrap_or(0.0),
            found.upper.unwrap_or(f64::INFINITY),
        ],
        false => [found.value; 2].map(Option::unwrap_or_default),
    };
    lower <= *usual.end() && upper >= *usual.start()
}

/// The longest that a servo waits \[s\]: a pulse frame, what it computes, and the way through a radio or a network are a tenth of a second at the most.
const LONGEST_WAIT_S: f64 = 0.25;

/// That the response begins later than that of any servo, and then goes half way in less time than it waited: a slow servo takes its time
/// for the way as well.
fn unlikely_wait(model: &Model) -> Option<Advice> {
    let metrics = &model.metrics;
    let (wait, half_way) = (metrics.delay_s.value?, metrics.t50_s.value?);
    (wait > LONGEST_WAIT_S && wait > half_way - wait).then(|| {
        Advice::new(
            Check::Duration,
            format!(
                "The response begins {} after the command, and no servo waits as long.",
                in_words(wait)
            ),
            wait,
            LONGEST_WAIT_S,
            format!(
                "Make sure that the columns of command and position begin at the same moment, that one clock wrote both, and that the time between samples is \
                 {}: all times from the command on follow from that. Else look for what holds the command back on its way to the servo.",
                in_words(model.sample_period_s)
            ),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presentation::summary::{limited_record, limited_servo};
    use servoid_identification::identify;

    /// A planned command that waited for pulses passed for one that follows the output.
    #[test]
    fn pulses_that_were_found_stand_for_feedback() {
        let record = limited_record();
        let feedback = Advice::new(Check::Feedback, "It follows.".to_owned(), 1.0, 0.0, "");
        let looped = || {
            let mut model = identify(&record, &Options::default()).unwrap();
            model.advice.insert(0, feedback.clone());
            model.withdrawn_for(Reason::InputFollowsOutput)
        };
        let servo = limited_servo();
        let mut without = looped();
        explained_by_pulses(&mut without, &servo, true);
        assert_eq!(without.bounds.withdrawn(), Some(Reason::InputFollowsOutput));
        assert!(without.advice.contains(&feedback));
        let found = servo.behind_pulses(WaitsForPulses {
            frame_s: 0.02,
            delay_error_s: 1e-4,
            length_is_open: false,
        });
        let mut model = looped();
        explained_by_pulses(&mut model, &found, true);
        assert_eq!(model.bounds.withdrawn(), Some(Reason::CommandsWait));
        assert!(!model.advice.contains(&feedback));
        assert!(model.advice.first().is_some_and(Advice::is_of_waits));
    }
}
