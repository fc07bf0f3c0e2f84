//! The comment at the top of every export of a servo model.

use super::exported::ExportedServo;
use super::subject::ServoExport;
use super::trial_command::{Difference, FINER, Trial};
use crate::presentation::export::statement::units_in_words;
use crate::presentation::export::text::number;
use crate::presentation::summary;
use crate::presentation::summary::four_digits;
use servoid_identification::results::{Bounds, six_digits};
use servoid_identification::servo_model::{Quantity, QuantityKind, ReachedSpeeds};

/// How the difference of an export from the servo model was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Comparison {
    /// By the same steps as the file takes.
    SameSteps,
    /// By an emulation of what the program, named here, does.
    Emulation(&'static str),
}

impl ServoExport<'_> {
    /// The limits of the numbers, a sentence each.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
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
        }
        found.extend(self.unknown_speed());
        found.extend(self.metadata.frame_warning());
        found.extend(self.guessed_angle());
        let findings = self.of_sensor.iter();
        found.extend(findings.map(|finding| finding.trim_end_matches('.').to_owned()));
        found
    }

    /// That larger or quicker strokes than the recorded ones are not known, where that is so.
    fn unknown_speed(&self) -> Option<String> {
        if self.parameters.limit.is_none() {
            return Some(format!(
                "no limit of the speed was reached{}, so this model has none: what it does in quicker motion is not known, and a servo has a limit",
                self.reached()
            ));
        }
        let speeds = [
            QuantityKind::TopSpeedUpwards,
            QuantityKind::TopSpeedDownwards,
        ];
        let is_open = |found: &Quantity| !found.determined;
        let is_open = |kind| self.model.quantity(kind).is_some_and(is_open);
        speeds.into_iter().any(is_open).then(|| {
            let recorded = (self.recorded_range())
                .map(|range| format!(" (commands {range})"))
                .unwrap_or_default();
            format!(
                "the recording does not determine the top speed, so larger strokes than its own{recorded} may be far slower in this file than they are, or far quicker: record steps over most of the travel"
            )
        })
    }

    /// That an angle was guessed, where neither column says in what it is.
    fn guessed_angle(&self) -> Option<String> {
        let units = self.metadata.units();
        let is_angle = |unit: Option<&str>| matches!(unit, Some("deg" | "rad"));
        let guessed = units.input.is_none() && !is_angle(units.output);
        let unit = match self.model.radians_per_command < 1.0 {
            true => "degrees",
            false => "radians",
        };
        guessed.then(|| format!(
            "the unit of the command is not known: for programs whose servos turn by angles, such as ArduPilot and MuJoCo, it is taken for {unit}, by the size of the commands alone: name the columns with their units (u_deg, u_rad) and identify again"
        ))
    }

    /// " up to 40 deg/s upwards and 38 deg/s downwards", where that is known.
    fn reached(&self) -> String {
        let unit = self
            .metadata
            .units()
            .output
            .unwrap_or("units of the position");
        let reached = |found: ReachedSpeeds| {
            let [up, down] =
                [found.upwards, found.downwards].map(|speed| summary::digits(speed, 2));
            format!(" up to {up} {unit}/s upwards and {down} {unit}/s downwards")
        };
        self.model.reached.map(reached).unwrap_or_default()
    }

    /// "from -20.0 to 20.0 deg": the commands of the recording, where they are known.
    fn recorded_range(&self) -> Option<String> {
        let range = self.model.commands?;
        let size = range.amplitude();
        let [least, largest] = [range.least, range.largest].map(|end| beside(end, size));
        let unit = self.metadata.units().input;
        let unit = unit.map(|unit| format!(" {unit}")).unwrap_or_default();
        Some(format!("from {least} to {largest}{unit}"))
    }

    /// Origin, warnings, equation, units and parameters, a paragraph each.
    pub(super) fn statement(&self) -> Vec<String> {
        let mut paragraphs = vec![format!(
            "{}: the servo as a machine, a nonlinear servo model, exported by servoid {} from {}.",
            self.name,
            env!("CARGO_PKG_VERSION"),
            self.source
        )];
        let warnings = self.warnings().into_iter();
        paragraphs.extend(warnings.map(|warning| format!("WARNING: {warning}.")));
        paragraphs.extend([
            EQUATION.to_owned(),
            self.units_and_signs(),
            PER_INERTIA.to_owned(),
            self.identified(),
        ]);
        let offset = summary::run_offsets_in_words(self.model, self.metadata.units());
        paragraphs.extend(offset.map(|sentence| format!("Offset: {sentence}")));
        paragraphs.push(self.quality());
        paragraphs
    }

    fn units_and_signs(&self) -> String {
        let theta = match self.parameters.gain < 0.0 {
            true => "smaller theta, as the gain is negative",
            false => "larger theta",
        };
        format!(
            "Units and signs: {}, theta is in units of the command, times are in seconds. Upwards is where the position grows, towards {theta}. A positive load turns towards smaller theta. The offset that was identified is the position at rest under command 0, with load and dead band, and in the middle of what friction holds; that of the parameters is the position at theta = 0. Of what was identified, offset, speeds and accelerations are of the position; dead band, resting error, error of full drive and loads are of the command.",
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

    /// Where the hold of the pulse frame is, in a file that `has_hold` or has not.
    pub(super) fn hold(&self, has_hold: bool) -> String {
        let frame = number((self.frame_s() * 1e7).round() / 1e4);
        match self.frame_s() {
            0.0 => "Hold: none is assumed, the command may change at any step.".to_owned(),
            _ if has_hold => format!(
                "Hold: that of the command for a pulse frame of {frame} ms is part of this file."
            ),
            _ => format!(
                "Hold: a servo gets a new pulse once in {frame} ms only, and that is not part of this file. Put a sample and hold of {frame} ms before it."
            ),
        }
    }

    /// How the limits of a rate were found, of these top speeds; both are of theta, towards larger and smaller. A target with one rate
    /// has both the same.
    pub(super) fn rate(&self, limits: [f64; 2], tops: [f64; 2]) -> String {
        if self.top_speeds().is_none() {
            return format!(
                "Rate: no limit was reached{}, so this model has none, and neither has this file.",
                self.reached()
            );
        }
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
                "{limit} {unit}/s, which is {percent} % of the top speed of {top} {unit}/s{both}"
            )
        };
        let [up, down] = (self.parameters)
            .upwards_first([(limits[0], tops[0]), (limits[1], tops[1])])
            .map(|(limit, top)| of_top(limit, top));
        let limit = match up == down {
            true => format!("the limit of theta is {up}"),
            false => format!("the limit of theta upwards is {up}, and downwards {down}"),
        };
        let reached = match is_mean {
            true => {
                "and is no smaller share of the top speed than the servo reached in the recording, in the direction in which that is larger. One rate stands for both directions, as this program has one: in the slower direction the servo is slower than this file, in the faster one quicker"
            }
            false => "and is not below what the servo reached in the recording",
        };
        format!(
            "Rate: {limit}. It comes closest to the servo under the command below, in the mean of squares, {reached}. In short strokes a servo does not reach its top speed."
        )
    }

    /// The position as a line of what a target gives: `at_zero` is where that is 0, and `each` is for each unit of it, which `what` names.
    pub(super) fn line(&self, at_zero: f64, each: f64, what: &str) -> String {
        let sign = if each < 0.0 { '-' } else { '+' };
        format!(
            "position = {} {sign} {} {what}, in {}",
            // A negative zero is 0.
            six_digits(at_zero) + 0.0,
            six_digits(each.abs()),
            self.output_unit()
        )
    }

    /// The largest difference of a file from the servo model, what it is of the largest stroke, and over which strokes.
    #[must_use]
    pub fn share_of_stroke(&self, written: &ExportedServo) -> String {
        format!(
            "{}, {}",
            self.of_stroke(written.largest_difference, &written.trial),
            self.strokes(&written.trial)
        )
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
        let stroke = trial.largest_stroke() * self.parameters.gain.abs();
        let percent = four_digits(100.0 * difference / stroke);
        format!(
            "{} {unit}, {percent} % of its largest stroke ({}{short})",
            difference_text(difference),
            beside(stroke, stroke)
        )
    }

    /// The largest difference, and the command under which it was found.
    pub(super) fn difference(&self, found: &Difference, by: Comparison) -> String {
        let trial = &found.trial;
        let shown = |difference: f64| self.of_stroke(difference, trial);
        let without = found.without_others.map(|(difference, others)| {
            format!(
                " From the same servo without {others} it is {}.",
                shown(difference)
            )
        });
        let emulation = match by {
            Comparison::SameSteps => String::new(),
            Comparison::Emulation(program) => {
                format!(", by an emulation of what {program} does")
            }
        };
        let levels: Vec<String> = trial.levels.iter().copied().map(number).collect();
        format!(
            "Largest difference from servoid's own integrator with steps {FINER} times as fine as usual: {}, {}, with steps of {} ms{emulation}.{} The command: {}, each for {} s ({} steps), and all again for {} s ({} steps), which breaks strokes off; the first level is not compared.",
            shown(found.largest),
            self.strokes(trial),
            four_digits(1e3 * trial.step_s),
            without.unwrap_or_default(),
            levels.join(", "),
            four_digits(trial.steps_per_level as f64 * trial.step_s),
            trial.steps_per_level,
            four_digits(trial.steps_of_broken_off as f64 * trial.step_s),
            trial.steps_of_broken_off,
        )
    }
}

/// "deg of the position", or "units of the position" where that is all that is known.
fn of_column(unit: Option<&str>, column: &str) -> String {
    format!("{} of the {column}", unit.unwrap_or("units"))
}

/// A number with the digits that count beside the size `size`: three of that.
fn beside(value: f64, size: f64) -> String {
    let decimals = 2 - size.abs().max(f64::MIN_POSITIVE).log10().floor() as i32;
    format!("{value:.*}", decimals.clamp(0, 12) as usize)
}

/// Four digits, with an exponent where they would be behind many zeros.
fn difference_text(difference: f64) -> String {
    match difference < 1e-5 {
        true => format!("{difference:.3e}"),
        false => four_digits(difference),
    }
}

const EQUATION: &str = "Equation: r(t) = u(t - d) is the command, late by d. The error e is r - theta beyond a dead band of w to each side, counted from its edge. The drive is k e - (c - B) omega, between -A- and A+, which is towards larger theta; where it is negative, k and c - B are A-/A+ times as large. omega' = drive - B omega - friction - load(theta), theta' = omega, position = gain theta + offset. Friction is (C + mu |drive + load|) (1 + s / (1 + (omega/ws)^2)) against the motion, and holds the shaft at rest while less acts on it.";

const PER_INERTIA: &str = "Inertia: all accelerations are torques per unit of inertia. No torque, mass or current follows from the recording; with a known inertia, multiply by it.";
