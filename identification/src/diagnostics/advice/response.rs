//! Findings on the response: whether it is over, and which part of it was left out.

use crate::data::{Record, usual_hold};
use crate::diagnostics::advice::evidence::{Evidence, two_digits};
use crate::diagnostics::{Misfit, rests_within, rise_at_end, time_until_rest};
use crate::numerics::four_digits;
use crate::options::Frequencies;
use crate::results::{Advice, Bounds, Check, Reason, SelectedBy, Withheld};
use crate::selection::{Choice, hidden_end};
use crate::thresholds::{
    DETECTION, EXPLAINED_BY_LAG, GAIN_DRIFT_PERCENT, HIDDEN_TAIL, LAG_BESIDE_SETTLING,
    LONGEST_SETTLING, MARGIN, POOR_PREDICTION_PERCENT, ROWS_PER_SAMPLE, SLOW_END_SIGNIFICANCE,
    STILL_RISING,
};

/// The choice of the settling time, unless it was overruled because the errors are not noise.
fn trusted_choice<'a>(evidence: &Evidence<'a>) -> Option<&'a Choice> {
    let choice = evidence.explanation.settling.as_ref();
    choice.filter(|_| evidence.misfit().is_none())
}

/// The usual hold, where the settling times that were tried are longer and the servo is not linear.
fn hold_that_is_outlasted(evidence: &Evidence<'_>, choice: &Choice) -> Option<usize> {
    let record = evidence
        .recorded
        .filter(|_| evidence.errors_follow_motion())?;
    Some(usual_hold(record)).filter(|hold| *hold < choice.longest)
}

/// That a response which goes on behind the usual `hold` may be no response.
fn after_holds(evidence: &Evidence<'_>, choice: &Choice, hold: usize) -> Advice {
    Advice::new(
        Check::Settled,
        format!(
            "What this response does after {:.3} s, for which the command is usually held, may be no answer to one step: the servo is not linear, and \
             how it answers the steps that follow passes for a late part. The final value is not certain.",
            hold as f64 * evidence.model.sample_period_s
        ),
        choice.detected as f64,
        hold as f64,
        "Record runs with their levels in other orders, or steps of one size that are held until the servo rests.",
    )
}

/// Until when a response moves that is seen to rest before, and the samples within which it does.
fn moves_after_rest(evidence: &Evidence<'_>, choice: &Choice) -> Option<(usize, usize)> {
    let record = evidence.recorded?;
    let seen = (choice.moved_until).or((!choice.settled).then_some(choice.detected));
    let until = seen?;
    Some((
        until,
        time_until_rest(record, until.min(usual_hold(record)))?,
    ))
}

/// That a response which moves `until` later than the servo rests, `within` samples after a command, is no response.
fn after_rest(evidence: &Evidence<'_>, choice: &Choice, (until, within): (usize, usize)) -> Advice {
    let seconds = |samples: usize| samples as f64 * evidence.model.sample_period_s;
    let remedy = match choice.within_holds {
        true => {
            "Record runs with their levels in other orders, which show what the answer depends on."
                .to_owned()
        }
        false => format!(
            "State a settling time of {within} samples, within which it rests; runs with their levels in other orders show what the answer depends on."
        ),
    };
    // Where neither the errors nor its motion show which, a slow end is as likely.
    let slow_end = match choice.moved_until {
        Some(_) => "",
        None => "a slow end, or ",
    };
    let left_out = match choice.within_holds {
        true => {
            "That is left out here, and levels and final value are a mean over what came before."
        }
        false => "The final value is not certain.",
    };
    Advice::new(
        Check::Settled,
        format!(
            "The linear response that fits best moves until {:.3} s, but the output is at rest {:.3} s after a command: what moves later is {slow_end}no answer to one step, but to \
             the steps before it, as where play, a dead band or friction leave the servo on the side from which it came. {left_out}",
            seconds(until),
            seconds(within)
        ),
        until as f64,
        within as f64,
        remedy,
    )
}

pub(super) fn settled(evidence: &Evidence<'_>) -> Option<Advice> {
    let choice = trusted_choice(evidence)?;
    if let Some(rest) = moves_after_rest(evidence, choice) {
        return Some(after_rest(evidence, choice, rest));
    }
    if choice.settled {
        return None;
    }
    if let Some(hold) = hold_that_is_outlasted(evidence, choice) {
        return Some(after_holds(evidence, choice, hold));
    }
    let period = evidence.model.sample_period_s;
    let longest = choice.longest as f64 * period;
    let moving = choice.detected as f64 * period;
    let repeated = match evidence.has_runs_of_one_order() {
        true => {
            " Runs of one order do not distinguish that from what a servo that is not linear does at later steps."
        }
        false => "",
    };
    let bounds = match evidence.has_bounds() {
        true => "The bounds hold up to there; the",
        false => "The",
    };
    let seen = match choice.detected < choice.longest {
        _ if is_at_the_cap(choice) => format!(
            "The response moves until {moving:.3} s, and {longest:.3} s are the longest time that is looked at where none is stated ({LONGEST_SETTLING} samples), \
             which is too short to say that it is over."
        ),
        true => format!(
            "The response moves until {moving:.3} s, and this recording shows too little after that, up to {longest:.3} s, to say that it is \
             over."
        ),
        false => format!(
            "The response still moves at {longest:.3} s, the longest time that this recording shows."
        ),
    };
    // A longer recording shows a longer time, in which the response may still move: twice what would show this time alone.
    let (hold, in_all) = (MARGIN * longest, 2.0 * 7.0 * MARGIN * longest);
    Some(Advice::new(
        Check::Settled,
        format!("{seen}{repeated} {bounds} final value is not certain."),
        choice.detected as f64,
        choice.longest as f64 / MARGIN,
        match choice.repeats_after {
            _ if is_at_the_cap(choice) => format!(
                "{}{}, record holds of up to {hold:.2} s, and at least {in_all:.1} s in all.",
                match repeated.is_empty() {
                    true => "",
                    false =>
                        "First state the input before the runs (at rest), if it is known, or give each run its levels in another order. ",
                },
                stated(choice.longest)
            ),
            Some(_) => format!(
                "Record holds of different lengths, up to {hold:.2} s, and at least {in_all:.1} s in all: where all are equal, longer ones \
                 show little more."
            ),
            None => format!(
                "Record with holds of at least {hold:.2} s and at least {in_all:.1} s in all."
            ),
        },
    ))
}

/// Whether no time up to the longest that is tried by itself is long enough, which a longer recording would not change.
fn is_at_the_cap(choice: &Choice) -> bool {
    choice.longest >= LONGEST_SETTLING
}

/// What to state where no settling time up to `longest` is enough, and that a recording may be too short for it.
fn stated(longest: usize) -> String {
    format!(
        "State a settling time of {} samples, and a longer one where the response goes on beyond that; where that is too much for this recording",
        2 * longest + 1
    )
}

/// A servo that does not follow any more from some time on.
pub(super) fn servo_stopped(evidence: &Evidence<'_>) -> Option<Advice> {
    let found = evidence.validity.stopped?;
    Some(Advice::new(
        Check::Stopped,
        format!(
            "No bounds can be given, because the servo stops: {}",
            found.in_words()
        ),
        found.at_s,
        0.0,
        "Cut the recording there and identify what is before, or mend the servo and record again.",
    ))
}

/// The first or the second stop within the range of the commands.
pub(super) fn travel_end(evidence: &Evidence<'_>, which: usize) -> Option<Advice> {
    let found = evidence.validity.travel_ends[which]?;
    let (from, to) = found.commands;
    let (first, last) = (four_digits(from), evidence.input(four_digits(to)));
    let rest = evidence.output(four_digits(found.rest));
    if !found.is_shown {
        return Some(Advice::new(
            Check::TravelEnd,
            format!(
                "The output falls short of the outermost commands of this recording: commanded {last} it ends at {rest}. One command does not show whether that is \
                 a stop, a load that the drive cannot overcome, or what a dead band or friction leaves; the linear model has none of these.",
            ),
            found.rest,
            from,
            "Record further commands on both sides of this one, each visited twice and held until the servo rests: at a stop all beyond it end at one angle, and a \
             dead band leaves all short by as much.",
        ));
    }
    if !found.is_of_several_commands() {
        return Some(Advice::new(
            Check::TravelEnd,
            format!(
                "The output falls short of one command of this recording: commanded {last} it ends at {rest}, though it follows the others. One command does not show \
                 whether that is a stop, a load that the drive cannot overcome, or a gain that falls there; the linear model has none of these.",
            ),
            found.rest,
            from,
            "Record further commands on both sides of this one, each visited twice and held until the servo rests: at a stop all beyond it end at one angle. Or \
             record without it. A servo model ('--servo-model') has a stop here where it predicts better with one, which this command alone shows.",
        ));
    }
    let commands = format!(
        "commands from {first} to {last} all end about there ({} of them)",
        found.count
    );
    Some(Advice::new(
        Check::TravelEnd,
        format!(
            "The output stops at {}: {commands}, though it follows others. That is a stop, or a load that the drive cannot overcome; the linear model has neither.",
            rest,
        ),
        found.rest,
        from,
        "Record again with commands that end short of it, or take the stop or the load away. A servo model ('--servo-model') has a stop here where it \
         predicts better with one, and else a load, and so have those of its exports that can; beside the linear model a simulator needs this angle.",
    ))
}

/// A servo that is slower than the longest settling time, or the integral of its input.
pub(super) fn slow_servo(evidence: &Evidence<'_>) -> Option<Advice> {
    let found = evidence.validity.slow_servo?;
    let explained = 100.0 * found.explained;
    let Some(seconds) = found.time_constant_s else {
        return Some(Advice::new(
            Check::SlowServo,
            format!(
                "No bounds can be given, because the output does not come to rest under a command: over this recording it is the integral of the input, \
                 which sets its speed ({} of the output a second for each unit of the input; that explains {explained:.1} % of its changes). Or it is \
                 slower than this recording shows.",
                two_digits(found.speed_per_input.abs())
            ),
            explained,
            100.0 * EXPLAINED_BY_LAG,
            "If the input is a speed, take the speed of the output as the output: its change from row to row over the time between them, in rows so far \
             apart that the change exceeds the noise. If it is a position, record holds in which the output comes to rest.",
        ));
    };
    // A lag is over after four time constants, and the settling time that is chosen has a margin.
    let settling = MARGIN * LAG_BESIDE_SETTLING * seconds;
    let period = evidence.model.sample_period_s;
    let rows = (settling / (period * LONGEST_SETTLING as f64)).ceil();
    Some(Advice::new(
        Check::SlowServo,
        format!(
            "No bounds can be given, because the servo is slow: a time constant of about {} s explains {explained:.1} % of the changes of its output, and its \
             response goes on beyond the longest settling time that this recording allows.",
            two_digits(seconds)
        ),
        explained,
        100.0 * EXPLAINED_BY_LAG,
        format!(
            "Record holds of different lengths, some of {} s or more, for {:.0} s in all, {}.",
            two_digits(LAG_BESIDE_SETTLING * seconds),
            ROWS_PER_SAMPLE as f64 * settling,
            match rows > 1.0 {
                // Rows left out of a file move its commands to other rows.
                true => format!(
                    "in rows {} ms apart or more, since the settling time has at most {LONGEST_SETTLING} of them, and with commands that change at these rows",
                    two_digits(1e3 * rows * period)
                ),
                false => "in rows as these".to_owned(),
            }
        ),
    ))
}

/// A gain that changes along the record.
pub(super) fn gain_drift(evidence: &Evidence<'_>) -> Option<Advice> {
    let found = evidence.validity.gain_drift?;
    let direction = if found.change > 0.0 { "rises" } else { "falls" };
    let course = match found.at_s {
        Some(seconds) => format!("at about {seconds:.1} s of a run"),
        None => "from the beginning to the end of a run".to_owned(),
    };
    Some(Advice::new(
        Check::GainDrift,
        format!(
            "No bounds can be given, because the servo changes along the recording: its gain {direction} by {} % {course} (p = {:.0e}). The response is \
             that of its mean.",
            two_digits(100.0 * found.change.abs()),
            found.p.max(1e-12)
        ),
        100.0 * found.change,
        GAIN_DRIFT_PERCENT,
        "Look at the supplies of servo and sensor, whether one gets warm, and whether a load grows, as that of the air with its speed. Record again where none of them changes.",
    ))
}

/// "12 % of its value"; of a value that is next to nothing no share means anything.
fn share_of_value(share: f64) -> String {
    match share < 1.0 {
        true => format!("{:.0} % of its value", 100.0 * share),
        false => "more than its value".to_owned(),
    }
}

/// An integrator, or a record that is too short for its servo.
pub(super) fn still_rising(evidence: &Evidence<'_>) -> Option<Advice> {
    // A step response that the reference does not determine has no end to speak of.
    let is_determined = evidence.validity.withheld != Some(Withheld::InputUnexcited);
    let rise = rise_at_end(&evidence.model.step.value).filter(|_| is_determined)?;
    // Where the servo is seen to rest, what goes on is the description of a servo that is not linear.
    let rests = |record: &Record| rests_within(record, usual_hold(record));
    if evidence.recorded.is_some_and(rests) {
        return None;
    }
    let seconds = evidence.model.step.value.len() as f64 * evidence.model.sample_period_s;
    Some(Advice::new(
        Check::StillRising,
        format!(
            "The step response has no end: it still rises by {} in the last quarter of {seconds:.3} s. That happens where the input \
             sets how fast the output turns and not where it stops, and where holds are far too short.",
            share_of_value(rise)
        ),
        rise,
        STILL_RISING,
        format!(
            "If the input is a speed, take the speed of the output as the output. If it is a position, record holds of several times \
             {seconds:.1} s."
        ),
    ))
}

pub(super) fn slow_end(evidence: &Evidence<'_>) -> Option<Advice> {
    let end = evidence
        .explanation
        .slow_end
        .filter(|_| evidence.misfit().is_none())?;
    let seconds = end.beyond as f64 * evidence.model.sample_period_s;
    let bounds = match evidence.has_bounds() {
        true => "the bounds are approximate",
        false => "no bounds can be given",
    };
    let holds = format!(
        "holds of several times {seconds:.1} s, and at least {:.0} s in all.",
        14.0 * seconds
    );
    let (time, remedy) = match &evidence.explanation.settling {
        Some(choice) => (
            "slowly beyond the longest time that can be judged",
            match is_at_the_cap(choice) {
                true => format!("{}, record {holds}", stated(choice.longest)),
                false => format!("Record {holds}"),
            },
        ),
        None => (
            "beyond the settling time that was given",
            match end.beyond >= LONGEST_SETTLING {
                // What is tried by itself is no longer.
                true => format!("Give a longer one, such as {} samples.", 2 * end.beyond + 1),
                false => {
                    format!("Give a longer settling time; where that does not help, record {holds}")
                }
            },
        ),
    };
    Some(Advice::new(
        Check::SlowEnd,
        format!(
            "The response goes on {time}, {seconds:.3} s (p = {:.0e}), so {bounds}.",
            end.p.max(1e-12)
        ),
        end.p,
        SLOW_END_SIGNIFICANCE,
        remedy,
    ))
}

pub(super) fn repeats(evidence: &Evidence<'_>) -> Option<Advice> {
    let settling = evidence.explanation.settling.as_ref()?;
    let period = evidence.model.sample_period_s;
    let repeats = settling.repeats_after? as f64 * period;
    let consequence = match evidence.validity.level {
        Bounds::Valid(_) => " The bounds contain a slow end as far as the earlier ones show it.",
        Bounds::Withdrawn(Reason::EndUnseen) => {
            " A slow end would look like another response that is over, so no bounds can be given."
        }
        Bounds::Withdrawn(_) => "",
    };
    Some(Advice::new(
        Check::Repeats,
        format!(
            "Parts of the response after {repeats:.3} s cannot be separated from earlier ones, because the reference repeats itself \
             then.{consequence}"
        ),
        repeats,
        settling.longest as f64 * period,
        "Use holds of different lengths, as a staircase or random steps have, to see later parts of the \
         response.",
    ))
}

/// What may be left of the end of the response after N. Without bounds, its standard deviation is not known.
pub(super) fn hidden_tail(evidence: &Evidence<'_>) -> Option<Advice> {
    trusted_choice(evidence).filter(|choice| choice.settled && choice.detected > 1)?;
    let step = &evidence.model.step;
    let size = step.value.last()?.abs();
    let (_, before_end) = step.bounds.valid()?.sd.split_last()?;
    let sd = before_end.iter().copied().fold(0.0, f64::max);
    let visible = DETECTION * sd / size;
    let hidden = hidden_end(sd / size, MARGIN);
    if hidden <= HIDDEN_TAIL {
        return None;
    }
    let percent = 100.0 * visible;
    // Where errors grow with the motion, more motion would bring more of them.
    let (finding, remedy) = match evidence.errors_follow_motion() {
        true => (
            format!(
                "A slow end or a ringing of the response below {percent:.0} % of the final value cannot be seen: the \
                 errors that follow the motion hide it."
            ),
            "Record steps of one size that are held until the servo rests.",
        ),
        false => (
            format!(
                "A slow end or a ringing of the response below {percent:.0} % of the final value cannot be seen, \
                 because the noise is large for this input; after the settling time it may still amount to \
                 {hidden:.1} standard deviations. The bounds may hold less often than their level."
            ),
            "Record longer, or use larger steps with sharper edges.",
        ),
    };
    Some(Advice::new(
        Check::HiddenTail,
        finding,
        hidden,
        HIDDEN_TAIL,
        remedy,
    ))
}

pub(super) fn responds(evidence: &Evidence<'_>) -> Option<Advice> {
    let choice = trusted_choice(evidence).filter(|choice| choice.detected <= 1)?;
    let gain = &evidence.model.metrics.dc_gain;
    let has_sign = |(lower, upper): (f64, f64)| lower * upper > 0.0;
    const BELONG: &str = "Check that input and output belong together, and use larger steps.";
    let (finding, remedy) = if gain.lower.zip(gain.upper).is_some_and(has_sign) {
        (
            "The course of the response is not known: the output follows the input in its gain, but no moment of the \
             response exceeds the noise.",
            "Record steps, or other commands with sharp edges, and larger ones.",
        )
    } else if evidence.has_bounds() {
        (
            "The output shows no response to the input above the noise.",
            BELONG,
        )
    } else {
        ("No moment of the response exceeds the noise.", BELONG)
    };
    Some(Advice::new(
        Check::Response,
        finding,
        choice.detected as f64,
        1.0,
        remedy,
    ))
}

/// What the frequencies were chosen for, and what more of them are good for.
fn chosen_for(misfit: Option<&Misfit>) -> (&'static str, &'static str) {
    let best = misfit.and_then(|misfit| misfit.candidates.first());
    match best.map(|best| best.cross_validated_percent >= POOR_PREDICTION_PERCENT) {
        Some(true) => (
            " that predict best",
            "Nothing needs to be done for prediction; ask for more frequencies to look at detail.",
        ),
        Some(false) => (
            " that predict best",
            "More of them predict parts not seen no better; ask for more to look at detail.",
        ),
        None => (
            " of this model",
            "Ask for more frequencies to look at detail.",
        ),
    }
}

pub(super) fn truncated(evidence: &Evidence<'_>) -> Option<Advice> {
    let model = evidence.model;
    let structure = &model.structure;
    let basis = model.basis().ok()?;
    // What was left out beyond any bound has been said.
    let is_said = evidence.validity.left_out_above_hz.is_some() || model.band().is_some();
    if basis.has_all_frequencies() || is_said {
        return None;
    }
    let highest = basis.highest_hz(model.sample_period_s);
    let misfit = evidence.misfit();
    // The choice for prediction leaves out what does not help it, whether the input has it or not.
    let by_prediction = misfit.is_some_and(|misfit| misfit.unexcited_above_hz.is_none());
    let misses_metrics = model.metrics.withheld == Some(Withheld::FrequenciesLeftOut);
    let (chosen, detail) = chosen_for(misfit);
    let reach = |which: &str| {
        format!(
            "The {} frequencies{which} reach up to {highest:.1} Hz only",
            structure.frequencies
        )
    };
    let (finding, remedy) = match evidence.options.frequencies {
        Frequencies::Auto if by_prediction && misses_metrics => (
            reach(chosen)
                + ", so delay, rise time, overshoot and the other metrics are left out: nothing bounds what the others change in the step response",
            detail,
        ),
        Frequencies::Auto if by_prediction => (reach(chosen), detail),
        // From where on the reference lacks power has been said; the model may end before that.
        Frequencies::Auto if evidence.validity.unexcited_above_hz.is_some() => (
            match highest > 0.0 {
                true => reach(" of this model"),
                false => "This model has nothing of the response but a gain".to_owned(),
            },
            "Use a reference with sharp edges, without a filter before the servo.",
        ),
        Frequencies::Auto => (
            match highest > 0.0 {
                true => format!(
                    "The input has too little power above {highest:.1} Hz to determine the response there"
                ),
                false => "The input moves too slowly to determine more of the response than a gain"
                    .to_owned(),
            },
            "Use a reference with sharp edges, without a filter before the servo.",
        ),
        _ => (
            reach(""),
            "Take more frequencies, or leave their number to the automatic choice.",
        ),
    };
    let (finding, value, threshold) = match model.step.bounds.valid() {
        Some(bounds) => {
            let bias = bounds.truncation_bias;
            let decade = if structure.selected_by == SelectedBy::Narrow {
                40
            } else {
                20
            };
            let allowance = format!(
                "The bounds contain {} for what is left out, which holds if the response falls by at least {decade} \
                 dB/decade above",
                two_digits(bias)
            );
            (
                format!("{finding}. {allowance}."),
                bias,
                bounds.mean_half_widths().0 - bias,
            )
        }
        None => (
            format!("{finding}."),
            structure.frequencies as f64,
            structure.settling_samples as f64,
        ),
    };
    Some(Advice::new(
        Check::Truncation,
        finding,
        value,
        threshold,
        remedy,
    ))
}

#[cfg(test)]
mod tests {
    use super::share_of_value;

    #[test]
    fn a_share_of_next_to_nothing_is_no_percent() {
        assert_eq!(share_of_value(0.123), "12 % of its value");
        assert_eq!(share_of_value(30_978.85), "more than its value");
    }
}
