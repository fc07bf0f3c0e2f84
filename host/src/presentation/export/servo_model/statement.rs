//! The comment at the top of every export of a servo model.

use super::difference::Difference;
use super::exported::ExportedServo;
use super::rate_limit::FACTOR;
use super::subject::ServoExport;
use super::trial_command::{FINER_WHERE_EXACT, Held, REVERSALS, Trial};
use crate::data::unitless_command::UnitlessCommand;
use crate::presentation::export::doubts;
use crate::presentation::export::frame_hold::WHEN_TO_STATE;
use crate::presentation::export::statement::units_in_words;
use crate::presentation::export::target::Target;
use crate::presentation::export::text::number;
use crate::presentation::export::unseen_limit::no_limit;
use crate::presentation::summary;
use crate::presentation::summary::recorded::{self, beside};
use crate::presentation::summary::{digits, four_digits};
use servoid_identification::results::{Bounds, six_digits};
use servoid_identification::servo_model::{Load, LoadKind, QuantityKind};

/// How the difference of an export from the servo model was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Comparison {
    /// By the same steps as the file takes.
    SameSteps,
    /// By an emulation of what the program, named here, does.
    Emulation(&'static str),
}

/// What a file does about the pulse frame, in which a servo gets one command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Frame {
    /// It takes the command once in a frame.
    InFile,
    /// Who runs it can hold the command.
    BeforeFile,
    /// This parameter has the mean wait, as there is no more in the program.
    InDelay(&'static str),
}

impl ServoExport<'_> {
    /// The limits of the numbers, a sentence each.
    #[must_use]
    pub fn warnings(&self, target: Target) -> Vec<String> {
        let mut found = Vec::new();
        if !self.model.predicts() {
            found.push(format!(
                "this servo model does not predict its own recording, which it fits to {:.1} %: what follows is not to be relied on",
                self.model.prediction_percent()
            ));
        }
        if let Bounds::Withdrawn(reason) = &self.model.covariance {
            let because = reason.because();
            found.push(format!(
                "no intervals can be given, as {because}: this file has none"
            ));
            found.push(self.left_errors());
        }
        found.extend(self.unknown_speed());
        found.extend(self.unexplained_hysteresis());
        found.extend(self.held_without_evidence());
        found.extend(self.missed_rests());
        let stall = summary::stall_in_words(self.model, self.metadata.units());
        found.extend(stall.map(|stall| format!("by {stall}")));
        found.extend(self.metadata.frame_warning(Some(self.parameters.delay_s)));
        found.extend(doubts::of_units(
            self.model.commands,
            Some(self.model),
            self.metadata.units(),
        ));
        found.extend(self.unseen_load());
        found.extend(self.guessed_angle(target));
        let findings = self.of_sensor.iter();
        // What follows in a finding is no limit of a number, and a warning has its own stop.
        let first = findings.map(|finding| summary::first_sentence(finding));
        found.extend(first.map(|finding| finding.trim_end_matches('.').to_owned()));
        found
    }

    /// The size of the errors that are left in the recording, of a model whose errors no interval contains.
    fn left_errors(&self) -> String {
        let fit = &self.model.fit;
        let unit = self.output_unit();
        let rms = format!("{} {unit} rms", four_digits(fit.rmse));
        let size = match fit.largest_residual {
            Some(largest) => format!("up to {} {unit} ({rms})", four_digits(largest)),
            None => rms,
        };
        format!(
            "this servo model leaves errors of {size} in its own recording; motion that the recording has not, such as strokes that turn round before the servo rests, may have larger ones and was not tested: 'servoid validate' tests another recording"
        )
    }

    /// That positions of rest depend on the direction of approach by more than this servo has of it.
    fn unexplained_hysteresis(&self) -> Option<String> {
        let found = self.model.unexplained_hysteresis()?;
        let unit = self.output_unit();
        let explained = four_digits(found.explained);
        Some(match found.shown {
            Some(shown) if found.explained >= shown => format!(
                "rests under one command are as much as {} {unit} apart in the recording, which this servo model has by a dead band, friction or play that may be another of these: strokes of that size may be quite different",
                four_digits(shown)
            ),
            Some(shown) => format!(
                "rests under one command are as much as {} {unit} apart in the recording, of which this servo model explains {explained} {unit}: what makes the rest of it makes strokes of that size quite different",
                four_digits(shown)
            ),
            None => format!(
                "rests under one command depend on the direction of approach, how far at the most the recording does not show; friction, dead band and play of this servo model make up to {explained} {unit}"
            ),
        })
    }

    /// That small strokes may not move the file, where nothing in the recording shows that.
    fn held_without_evidence(&self) -> Option<String> {
        let held = four_digits(self.model.held_without_evidence()?);
        let unit = self.output_unit();
        Some(format!(
            "friction, dead band and play of this servo model may hold the shaft against strokes of up to {held} {unit}, and nothing in the recording shows that: its rests are closer together than half of it; record strokes as small as that"
        ))
    }

    /// That positions at the ends of the commands are not those of the recording.
    fn missed_rests(&self) -> Option<String> {
        let missed =
            summary::missed_rests_in_words(self.model, self.metadata.units(), "this file")?;
        Some(format!(
            "{missed}: a stop there, or a load, is not in this file, and larger commands may be farther off"
        ))
    }

    /// That larger or quicker strokes than the recorded ones are not known, where that is so.
    fn unknown_speed(&self) -> Option<String> {
        if self.top_speeds().is_none() {
            let (commands, reached) = (self.model.commands, self.model.reached);
            return Some(no_limit(commands, reached, self.metadata.units()));
        }
        (!self.top_speed_is_known()).then(|| {
            let unit = (self.metadata.units().output).unwrap_or("units of the position");
            let recorded = (self.reached_by(1.0, unit))
                .map(|speeds| format!(" ({speeds})"))
                .unwrap_or_default();
            format!(
                "the recording does not determine the top speed: strokes that are faster than the recorded motion{recorded}, large or quickly turned round, may be far too \
                 slow or too quick in this file"
            )
        })
    }

    /// That the load may be none.
    fn unseen_load(&self) -> Option<String> {
        let is_unseen = self.model.terms.load != LoadKind::None && !summary::shows_load(self.model);
        is_unseen.then(|| {
            "the load of this servo model is one that no interval shows: it may stand for something else that the model lacks, as may unequal speeds that come of it".to_owned()
        })
    }

    /// That an angle was guessed for a target whose servos turn by angles, where neither column says in what it is.
    fn guessed_angle(&self, target: Target) -> Option<String> {
        let units = self.metadata.units();
        let is_angle = |unit: Option<&str>| matches!(unit, Some("deg" | "rad"));
        let takes_angles = target.needs_servo_model();
        let is_pulse = self.unitless() == Some(UnitlessCommand::PulseWidth);
        let is_known = is_angle(units.output) || (is_pulse && target == Target::Ardupilot);
        let guessed = takes_angles && units.input.is_none() && !is_known;
        let column = if is_pulse { "position" } else { "command" };
        let unit = match self.model.radians_per_command < 1.0 {
            true => "degrees",
            false => "radians",
        };
        guessed.then(|| format!(
            "the unit of the {column} is not known: here it is taken for {unit}, by the size of the commands alone; name the columns with their units (u_deg, u_rad) and identify again"
        ))
    }

    /// "40 deg/s upwards and 38 deg/s downwards", in a `unit` of which there are `each` to one of the position.
    fn reached_by(&self, each: f64, unit: &str) -> Option<String> {
        recorded::speeds_in_words(self.model.reached?, each, unit)
    }

    /// "from -20.0 to 60.0 deg", the commands of the recording.
    fn recorded_range(&self) -> Option<String> {
        let range = self.model.commands?;
        Some(recorded::range_in_words(range, self.metadata.units()))
    }

    /// Which of the two models of the file this is, and why.
    fn which_model() -> &'static str {
        "The model file has a linear model and a servo model: this is the servo model, because it was asked for, or because nothing else can be written \
         for this target."
    }

    /// Origin, warnings, equation, units and parameters, a paragraph each.
    pub(super) fn statement(&self, target: Target) -> Vec<String> {
        let mut paragraphs = vec![format!(
            "{}: the servo as a machine, a nonlinear servo model, exported by servoid {} from {}.",
            self.name,
            env!("CARGO_PKG_VERSION"),
            self.source
        )];
        paragraphs.push(Self::which_model().to_owned());
        let warnings = self.warnings(target).into_iter();
        paragraphs.extend(warnings.map(|warning| format!("WARNING: {warning}.")));
        paragraphs.extend([
            self.equation(),
            self.units_and_signs(),
            PER_INERTIA.to_owned(),
            self.identified(),
        ]);
        let offset = summary::run_offsets_in_words(self.model, self.metadata.units());
        paragraphs.extend(offset.map(|sentence| format!("Offset: {sentence}")));
        paragraphs.extend(self.pulse_end());
        paragraphs.extend(self.metadata.open_delay());
        paragraphs.push(self.quality());
        paragraphs.extend(self.motion_interval());
        paragraphs
    }

    /// That the file has one delay for all pulses, where the servo has not.
    fn pulse_end(&self) -> Option<String> {
        let end = self.parameters.pulse_end?;
        let neutral = four_digits(end.neutral);
        let unit = self.command_unit();
        let largest_s = self.model.commands.map(|range| {
            let ends = [range.least, range.largest].map(|command| end.later_s(command).abs());
            ends[0].max(ends[1])
        });
        let far = largest_s.map_or_else(String::new, |s| {
            format!(
                ", which is up to {} ms off within the recorded commands",
                digits(1e3 * s, 2)
            )
        });
        Some(format!(
            "Pulses: the recorded servo knows a pulse at its end, so a longer one acts later by what it is longer. This file has the delay of {neutral} {unit} for all{far}. In quick reversals that is most of its error: \
             hand each command over that much later, or sooner, where these count, to a file whose steps are shorter than that (--step-ms)."
        ))
    }

    /// The equation, with what few servos have.
    fn equation(&self) -> String {
        let Some(limit) = self.parameters.speed_limit else {
            return EQUATION.to_owned();
        };
        let [up, down] = limit.both_ways().map(four_digits);
        let unit = self.command_unit();
        format!(
            "{EQUATION} Where omega is {up} {unit}/s, or -{down} {unit}/s, it goes no further: the speed is cut off there, and B is 0."
        )
    }

    fn units_and_signs(&self) -> String {
        let theta = match self.parameters.gain < 0.0 {
            true => "smaller theta, as the gain is negative",
            false => "larger theta",
        };
        format!(
            "Units and signs: {}, theta is in units of the command, times are in seconds. Upwards is where the position grows, towards {theta}. A positive load turns towards smaller theta. The offset that was identified is the position at rest under command 0, with load and dead band, and in the middle of what friction holds; that of the parameters is the position at phi = 0. Of what was identified, offset, speeds and accelerations are of the position; dead band, resting error, error of full drive and loads are of the command.",
            units_in_words(self.metadata.units()),
        )
    }

    /// The quantities with their intervals, where bounds hold.
    fn identified(&self) -> String {
        let units = self.metadata.units();
        let rows = summary::quantity_rows(&self.model.quantities, units).into_iter();
        let (determined, open): (Vec<_>, Vec<_>) =
            rows.partition(|(quantity, _)| quantity.determined);
        let determined: Vec<String> = (determined.iter().map(|(_, row)| row.in_words())).collect();
        let open: Vec<String> = open.into_iter().map(|(_, row)| row.name).collect();
        let intervals = match &self.model.covariance {
            Bounds::Valid(covariance) => format!(
                "with intervals of {} %, which hold for other sets of terms that predict as well",
                summary::percent(covariance.level)
            ),
            Bounds::Withdrawn(_) => "without intervals (see the warning)".to_owned(),
        };
        let mut text = format!("Identified, {intervals}: {}.", determined.join(", "));
        if !open.is_empty() {
            text += &format!(
                " Not determined by the recording, so that the parameters below give one value among many: {}.",
                open.join(", ")
            );
        }
        let load = (self.model.quantity(QuantityKind::LoadAtMiddle)).filter(|load| load.determined);
        if load.is_some() {
            text += &format!(" Beside a load, {}.", summary::LOOKS_LIKE_A_LOAD);
        }
        if let (1.., Some(name)) = (self.controller, self.options.controller) {
            text += &format!(
                " All that is for the first controller; this file has the controller {name}, which differs in stiffness alone."
            );
        }
        text
    }

    fn quality(&self) -> String {
        let fit = &self.model.fit;
        format!(
            "It follows the recording to {:.2} %, and parts that it had not seen to {:.2} %, simulated from the command alone.",
            fit.simulation_percent, fit.held_out_percent
        )
    }

    /// What who uses the file has to do about the pulse frame, where there is one.
    #[must_use]
    pub fn hold_remark(&self, target: Target) -> Option<String> {
        let frame_s = self.frame_s();
        match target {
            _ if frame_s <= 0.0 => None,
            Target::Jsbsim => Some(format!(
                "this file holds each command for a frame of {} ms: with --frame-ms 0 it takes any at once, for whoever holds them before it",
                in_ms(frame_s)
            )),
            Target::Ardupilot => Some(format!(
                "SIM_SERVO_DELAY has the mean wait for a pulse, {} ms, which the largest difference above is without",
                in_ms(0.5 * frame_s)
            )),
            _ => Some(format!(
                "a servo gets a new command once in {} ms: put a sample and hold of that before the file; where steps do not divide it, commands are up to a step late (--step-ms)",
                in_ms(frame_s)
            )),
        }
    }

    /// What a file does about the pulse frame.
    pub(super) fn frame(&self, does: Frame) -> String {
        let frame = in_ms(self.frame_s());
        let unknown = match self.metadata.pulse_frame_s {
            None => format!(": state --frame-ms {WHEN_TO_STATE}"),
            Some(_) => String::new(),
        };
        if self.frame_s() == 0.0 {
            return format!("Frame: none is assumed, the command acts from any step on{unknown}.");
        }
        let here = match does {
            Frame::InFile => format!(
                "this file takes the command that stands at each multiple of {frame} ms, and holds it until the next"
            ),
            Frame::BeforeFile => format!(
                "this file takes it at any step. Put a sample and hold of {frame} ms before it; where the steps do not divide that, commands are up to a step late"
            ),
            Frame::InDelay(parameter) => format!(
                "here it is taken at any step, and {parameter} has the mean wait, {} s. The largest difference below is without that, as its command changes with the pulses",
                number((self.frame_s() * 5e6).round() / 1e7)
            ),
        };
        format!("Frame: a servo gets a new command once in {frame} ms only; {here}.")
    }

    /// How the limits of a rate were found, of these top speeds; both are of theta, towards larger and smaller. A target with one rate
    /// has both the same.
    pub(super) fn rate(&self, limits: Option<[f64; 2]>, tops: [f64; 2]) -> String {
        if self.top_speeds().is_none() {
            return "Rate: this file has no limit, as none was reached (see the warning)."
                .to_owned();
        }
        let Some(limits) = limits else {
            return "Rate: this file has no limit. The recording does not determine the top speed, and in strokes larger than the recorded ones the file is closer to the servo model without one.".to_owned();
        };
        let unit = self.command_unit();
        let is_mean = tops[0] == tops[1] && self.top_speeds().is_some_and(|(up, down)| up != down);
        let both = if is_mean {
            ", the mean of both directions"
        } else {
            ""
        };
        let of_top = |limit: f64, top: f64| {
            let [percent, limit, top] = [100.0 * (limit / top), limit, top].map(four_digits);
            format!(
                "{limit} {unit}/s, which is {percent} % of the model's top speed of {top} {unit}/s{both}"
            )
        };
        let [up, down] = (self.parameters)
            .upwards_first([(limits[0], tops[0]), (limits[1], tops[1])])
            .map(|(limit, top)| of_top(limit, top));
        // Of a loop that has the spring in it, which is another theta than that of the equation.
        let theta = match self.parameters.load {
            Load::Spring { .. } => "the position over its gain at rest",
            _ => "theta",
        };
        let limit = match up == down {
            true => format!("the limit of {theta} is {up}"),
            false => format!("the limit of {theta} upwards is {up}, and downwards {down}"),
        };
        let one = match is_mean {
            true => " One rate stands for both directions, as this program has one.",
            false => "",
        };
        let larger = match limits[0] < FACTOR * tops[0] {
            true => {
                " In larger strokes than the recorded ones the file falls behind the model, which reaches its top speed there."
            }
            false => "",
        };
        let gain = self.with_spring_in_loop().parameters.gain;
        let reached = self.reached_by(gain.abs().recip(), unit);
        let reached = reached.map(|speeds| format!(
            " In the recording {theta} reached {speeds} at least; the limit need not be that, as it acts from the beginning of a stroke to its end, while a servo builds up its speed and brakes."
        ));
        format!(
            "Rate: {limit}. Limits up to the top speed were tried, and with this one the file is closest to the servo in the staircase below, in the mean of squares.{one}{larger}{}",
            reached.unwrap_or_default()
        )
    }

    /// The position as a line of what a target gives: `at_zero` is where that is 0, and `each` is for each unit of it, which `what` names.
    pub(super) fn line(&self, at_zero: f64, each: f64, what: &str) -> String {
        format!(
            "position = {} {what}, in {}",
            line(at_zero, each),
            self.output_unit()
        )
    }

    /// The largest difference of a file from the servo model, what it is of the largest stroke, and its root mean square.
    #[must_use]
    pub fn share_of_stroke(&self, written: &ExportedServo) -> String {
        let trial = &written.trial;
        format!(
            "{} in {}, {} % in strokes that are held or broken off once; root mean square {} %",
            self.of_stroke(written.largest_difference, trial),
            reversals(trial),
            self.percent_of_stroke(written.largest_difference_in_strokes, trial),
            self.percent_of_stroke(written.root_mean_square_difference, trial)
        )
    }

    /// The largest difference of a file in percent of the largest stroke.
    pub(super) fn percent_of_largest(&self, written: &ExportedServo) -> String {
        self.percent_of_stroke(written.largest_difference, &written.trial)
    }

    /// The same in strokes that are held or broken off once.
    pub(super) fn percent_of_strokes(&self, written: &ExportedServo) -> String {
        self.percent_of_stroke(written.largest_difference_in_strokes, &written.trial)
    }

    /// The strokes of a trial beside those of the recording.
    fn strokes(&self, trial: &Trial) -> String {
        let unit = of_column(self.metadata.units().input, "command");
        let stroke = trial.largest_stroke();
        let recorded = match self.recorded_range() {
            Some(range) => format!("the recording has commands {range}"),
            None => "which range the recording has, the model file does not say".to_owned(),
        };
        format!(
            "over strokes of up to {} {unit} ({recorded})",
            beside(stroke, stroke)
        )
    }

    fn of_stroke(&self, difference: f64, trial: &Trial) -> String {
        let unit = self.metadata.units().output;
        let short = unit.map(|unit| format!(" {unit}")).unwrap_or_default();
        let unit = of_column(unit, "position");
        let stroke = trial.largest_travel(&self.parameters);
        format!(
            "{} {unit}, {} % of its largest stroke ({}{short})",
            difference_text(difference),
            self.percent_of_stroke(difference, trial),
            beside(stroke, stroke)
        )
    }

    fn percent_of_stroke(&self, difference: f64, trial: &Trial) -> String {
        let stroke = trial.largest_travel(&self.parameters);
        four_digits(100.0 * difference / stroke)
    }

    /// The largest difference, and the command under which it was found.
    pub(super) fn difference(&self, found: &Difference, by: Comparison) -> String {
        let trial = &found.trial;
        let shown = |difference: f64| self.of_stroke(difference, trial);
        let largest = shown(found.largest);
        let without = (found.without_others.as_ref())
            .map(|(difference, others)| (shown(*difference), *difference, others))
            .filter(|(said, ..)| *said != largest)
            .map(|(said, difference, others)| {
                let why = match difference > found.largest {
                    true => ", more, since this file is fitted to the servo with that",
                    false => "",
                };
                format!(" From the same servo without {others} it is {said}{why}.")
            });
        let emulation = match by {
            Comparison::SameSteps => String::new(),
            Comparison::Emulation(program) => {
                format!(", by an emulation of what {program} does")
            }
        };
        format!(
            "Largest difference from servoid's own integrator with steps {FINER_WHERE_EXACT} times as fine as usual, under the command named below: {}, {}, with steps of {} ms{emulation}; root mean square {} %. {} In strokes that are held or broken off once it is {}{}.{} The command: {}",
            largest,
            self.strokes(trial),
            four_digits(1e3 * trial.step_s),
            self.percent_of_stroke(found.root_mean_square, trial),
            self.searched(trial),
            shown(found.largest_in_strokes),
            self.searched_once(trial),
            without.unwrap_or_default(),
            command(trial),
        )
    }

    /// In which strokes the difference is largest, a sentence.
    fn searched(&self, trial: &Trial) -> String {
        match trial.worst.is_empty() {
            true => format!(
                "It is that of repeated reversals, as a loop that swings has them, and of strokes that are held or broken off once; other commands may show several times as much, most of it where the servo just comes to rest{}; shorter steps show less.",
                self.at_stops(", and ")
            ),
            false => format!(
                "A search found the strokes in which it is largest, {}, among reversals and random strokes over the recorded range, with half-periods from 1/sqrt(k) to the time in which its largest stroke settles; other commands may be farther, as random ones by up to a fifth, and reversals with two half-periods in turn by up to two thirds.",
                reversals(trial)
            ),
        }
    }

    /// In which stroke, broken off once, a search found the difference largest.
    fn searched_once(&self, trial: &Trial) -> String {
        let [from, to, ..] = &trial.worst_broken_off[..] else {
            return String::new();
        };
        format!(
            ", the most of a search over strokes from rest between any levels, each broken off after 1/sqrt(k) or longer: here that from {} to {} after {} s{}",
            number(from.level),
            number(to.level),
            four_digits(to.steps as f64 * trial.step_s),
            self.at_stops("; shorter ones may be several times as far, ")
        )
    }

    /// Said of a servo with stops behind the words `before`: whether it meets one is a matter of less than any search tries.
    fn at_stops(&self, before: &str) -> String {
        match self.parameters.stops.are_none() {
            true => String::new(),
            false => format!(
                "{before}where the servo just reaches a stop, or just does not, some per cent of its largest stroke"
            ),
        }
    }
}

/// Seconds in milliseconds, to a tenth of a microsecond.
fn in_ms(seconds: f64) -> String {
    number((seconds * 1e7).round() / 1e4)
}

/// The command of a trial, in which each number stands.
fn command(trial: &Trial) -> String {
    let held = |steps: usize| {
        let seconds = four_digits(steps as f64 * trial.step_s);
        format!("{seconds} s ({steps} steps)")
    };
    let levels: Vec<String> = trial.levels.iter().copied().map(number).collect();
    let [least, largest] = trial.ends().map(number);
    let reversals: Vec<String> = trial.steps_of_reversals.iter().copied().map(held).collect();
    let search = match trial.worst.is_empty() {
        true => String::new(),
        false => format!(
            "{} for {}, and the strokes of the search: {}. Then {} for as long, and the stroke of the other search: {}. Then ",
            number(trial.middle()),
            held(trial.steps_per_level),
            strokes(&trial.worst),
            number(trial.middle()),
            strokes(&trial.worst_broken_off)
        ),
    };
    format!(
        "{}{}, each for {}, and all again for {}, which breaks strokes off (the staircase). Then {REVERSALS} strokes between {largest} and {least}, each held for {}, with {} at {} behind each such part. The first level is not compared.",
        search,
        levels.join(", "),
        held(trial.steps_per_level),
        held(trial.steps_of_broken_off),
        reversals.join(", then as many for "),
        held(trial.steps_per_level),
        number(trial.middle()),
    )
}

/// "reversals of 0.04 to 0.12 s", the half-periods of the strokes of the search.
fn reversals(trial: &Trial) -> String {
    let seconds = |steps: usize| four_digits(steps as f64 * trial.step_s);
    let steps = || trial.worst.iter().map(|held| held.steps);
    match (steps().min().map(seconds), steps().max().map(seconds)) {
        (Some(shortest), Some(longest)) if shortest == longest => {
            format!("reversals of {longest} s")
        }
        (Some(shortest), Some(longest)) => format!("reversals of {shortest} to {longest} s"),
        _ => "repeated reversals".to_owned(),
    }
}

/// The strokes of a search, in which each number stands.
fn strokes(found: &[Held]) -> String {
    if let [first, second, _, ..] = found
        && are_even(found)
    {
        return format!(
            "{} and {} in turn, {} strokes of {} steps each",
            number(first.level),
            number(second.level),
            found.len(),
            first.steps
        );
    }
    let held = |held: &Held| format!("{} for {} steps", number(held.level), held.steps);
    let all: Vec<String> = found.iter().map(held).collect();
    all.join(", ")
}

/// Whether strokes go to and fro between two levels, each as long as the others.
fn are_even(strokes: &[Held]) -> bool {
    let again = strokes.iter().zip(strokes.iter().skip(2));
    let both = strokes.iter().zip(strokes.iter().skip(1));
    let mut even = again.map(|(a, b)| a.level == b.level);
    let mut alike = both.map(|(a, b)| a.steps == b.steps);
    even.all(|is| is) && alike.all(|is| is)
}

/// "2.5 - 45", the numbers of a line that is `at_zero` at 0 and rises by `each`.
pub(super) fn line(at_zero: f64, each: f64) -> String {
    let sign = if each < 0.0 { '-' } else { '+' };
    // A negative zero is 0.
    let at_zero = six_digits(at_zero) + 0.0;
    format!("{at_zero} {sign} {}", six_digits(each.abs()))
}

/// "deg of the position", or "units of the position" where that is all that is known.
fn of_column(unit: Option<&str>, column: &str) -> String {
    format!("{} of the {column}", unit.unwrap_or("units"))
}

/// Four digits, with an exponent where they would be behind many zeros.
fn difference_text(difference: f64) -> String {
    match difference < 1e-5 {
        true => format!("{difference:.3e}"),
        false => four_digits(difference),
    }
}

const EQUATION: &str = "Equation: r(t) = u(t - d) is the command, late by d. The error e is r - theta beyond a dead band of w to each side, counted from its edge. The drive is k e - (c - B) omega, between -A- and A+, which is towards larger theta; where it is negative, k and c - B are A-/A+ times as large, but for a draw of limits that differ at one stiffness. omega' = drive - B omega - friction - load(theta), theta' = omega, position = gain phi + offset. phi is theta, or behind play stays where it is while theta is within b/2 of it. Friction is (C + mu |drive + load|) (1 + s / (1 + (omega/ws)^2)) against the motion, and holds the shaft at rest while less acts on it.";

const PER_INERTIA: &str = "Inertia: all accelerations are torques per unit of inertia. No torque, mass or current follows from the recording; with a known inertia, multiply by it.";
