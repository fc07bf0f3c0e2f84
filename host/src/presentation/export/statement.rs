//! The comment at the top of every export.

use super::doubts;
use super::frame_hold::WHEN_TO_STATE;
use super::model::Export;
use super::text::{Style, number};
use super::unseen_limit::no_limit;
use crate::data::units::Units;
use crate::presentation::summary::{self, recorded};
use servoid_identification::flight_model::FlightModel;
use servoid_identification::results::{Bounds, Interval, SelectedBy};

/// What of the servo's surroundings a file has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct InFile {
    /// The hold of a command for a pulse frame.
    pub hold: bool,
    /// The offset of the position.
    pub offset: bool,
}

impl Export<'_> {
    /// The limits of the numbers and their bounds, a sentence each.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let model = self.model;
        let mut found: Vec<String> = self.better_servo_model().into_iter().collect();
        let mut warn = |holds: bool, text: &str| {
            if holds {
                found.push(text.to_owned());
            }
        };
        if let Bounds::Withdrawn(reason) = model.level() {
            let because = reason.because();
            let text = match model.band() {
                Some(_) => format!("no bounds of the step response can be given, as {because}"),
                None => format!("no bounds can be given, as {because}: this file has none"),
            };
            warn(true, &text);
        } else {
            warn(
                !model.linear,
                "the servo is not linear: the bounds are those of the linear description that fits the reference best",
            );
        }
        warn(
            !model.is_consistent(),
            "the model contradicts itself: identify again",
        );
        warn(
            model.structure.selected_by == SelectedBy::Narrow,
            "high frequencies were left out (--frequencies narrow): the bounds hold only if the response falls by at least 40 dB/decade above the highest one",
        );
        warn(
            !model.converged,
            "the noise model did not come to rest: the bounds are approximate",
        );
        if let Some(reason) = model.metrics.withheld {
            warn(true, &format!("metrics are withheld: {}", reason.because()));
        }
        if let Some(text) = self.unknown_speed() {
            warn(true, &text);
        }
        for text in doubts::of_units(self.commands(), self.servo_model, self.metadata.units()) {
            warn(true, &text);
        }
        if let Some(text) = self.metadata.frame_warning(None) {
            warn(true, &text);
        }
        match &self.low_order {
            Ok(flight) => {
                let error = self.largest_error_percent(flight);
                let text = match flight.band_hz {
                    None => format!(
                        "the low-order model is an approximation: its step response differs from the identified one by up to {error:.2} % of the step, and both may differ from the servo"
                    ),
                    Some([from, to]) => format!(
                        "the low-order model is an approximation: from {from:.2} to {to:.1} Hz its frequency response differs from the identified one by up to \
                         {error:.2} % of that at {from:.2} Hz, and by how much it is off below and above, the gain at rest included, nothing shows"
                    ),
                };
                warn(flight.approximation, &text);
                if let Some([from, to]) = flight.band_hz {
                    let text = format!(
                        "the recording determines the response from {from:.2} to {to:.1} Hz alone: what the low-order model has below and above, its gain at rest \
                         included, rests on its order, and the step response of this file is a picture; simulate with the low-order model"
                    );
                    warn(!flight.approximation, &text);
                }
            }
            Err(reason) => warn(true, &format!("there is no low-order model: {reason}")),
        }
        found
    }

    /// That quicker strokes than the recorded ones are not known, where no servo model beside it has their limit.
    fn unknown_speed(&self) -> Option<String> {
        let units = self.metadata.units();
        let is_limited = self
            .servo_model
            .is_some_and(|servo| servo.terms.is_limited());
        let found = self.metadata.recorded.filter(|_| !is_limited)?;
        Some(no_limit(Some(found.commands), Some(found.reached), units))
    }

    /// That the servo model beside the linear one predicts better, so that this is not the model to fly with.
    fn better_servo_model(&self) -> Option<String> {
        let [linear, own] = self.servo_model?.beyond_linear_percent()?;
        // The percents are those of the response, which a band has as a picture of the recording; the low-order model is none.
        Some(match self.model.band() {
            Some(_) => format!(
                "this file is not that of the servo model, which predicts parts of the recording that it has not seen to {own:.1} %, and which \
                 --servo-model exports; how well the low-order model predicts them was not tested"
            ),
            None => format!(
                "this is the linear model, which predicts parts of the recording that it has not seen to {linear:.1} %; the servo model in \
                 the same file predicts them to {own:.1} %, and --servo-model exports it"
            ),
        })
    }

    /// What a reader must know of a response of this file where it is simulated; empty of a linear servo with bounds.
    pub(super) fn of_response(&self) -> String {
        match self.model.level().withdrawn() {
            Some(reason) => format!(
                "This response is a picture of the recording, without bounds, because {}: the servo may answer otherwise.",
                reason.because()
            ),
            None if !self.model.linear => {
                "The servo is not linear, and this response describes the recorded motion: the servo may answer another command otherwise."
                    .to_owned()
            }
            None => String::new(),
        }
    }

    /// Which of two models of the file this is, and why, where no warning says it.
    #[must_use]
    pub fn which_model(&self) -> Option<String> {
        let is_said = self.servo_model.is_none() || self.better_servo_model().is_some();
        (!is_said).then(|| {
            "The model file has a linear model and a servo model: this is the linear one, because the servo model was not asked for \
             (--servo-model)."
                .to_owned()
        })
    }

    /// Origin, warnings, units, sampling, hold, bounds and parameters, a paragraph each.
    pub(super) fn statement(&self, has: InFile) -> Vec<String> {
        let mut paragraphs = vec![format!(
            "{}: linear model of a servo, exported by servoid {} from {}.",
            self.name,
            env!("CARGO_PKG_VERSION"),
            self.source
        )];
        paragraphs.extend(self.which_model());
        let warnings = self.warnings().into_iter();
        paragraphs.extend(warnings.map(|warning| format!("WARNING: {warning}.")));
        let advice = self.model.advice.iter();
        paragraphs.extend(advice.map(|a| format!("Advice: {} {}", a.finding, a.remedy)));
        paragraphs.extend(self.strokes());
        paragraphs.extend(self.recorded());
        paragraphs.extend([
            self.units_and_signs(),
            self.sampling(has.offset),
            self.hold(has.hold),
            self.bounds(),
            self.parameters(),
        ]);
        if let Ok(flight) = &self.low_order {
            paragraphs.push(low_order(flight, self.largest_error_percent(flight)));
        }
        paragraphs
    }

    /// What the recording had, where the file says it.
    fn recorded(&self) -> Option<String> {
        let (found, units) = (self.metadata.recorded?, self.metadata.units());
        let unit = units.output.unwrap_or("units of the position");
        let moved = recorded::speeds_in_words(found.reached, 1.0, unit)
            .map(|speeds| format!(", and the position moved at more than {speeds}"));
        Some(format!(
            "Recorded: commands {}{}. This file has no limit of speed and travel: of larger and quicker strokes it is not known how right it is.",
            recorded::range_in_words(found.commands, units),
            moved.unwrap_or_default()
        ))
    }

    fn units_and_signs(&self) -> String {
        let units = self.metadata.units();
        let gain = match (units.gain(), units.common()) {
            (Some(unit), _) => format!("the gain is position per command, in {unit}"),
            (None, Some(_)) => "the gain is position per command, without a unit".to_owned(),
            (None, None) => "the gain is position per command".to_owned(),
        };
        format!(
            "Units and signs: {}, {gain}, times are in seconds, frequencies in rad/s. A response has the sign of the gain times that of the command; frequency responses are for exp(+jwt), so that a lag has a negative phase.",
            units_in_words(units),
        )
    }

    fn sampling(&self, with_offset: bool) -> String {
        let model = self.model;
        let offset = match with_offset {
            true => "is part of this file",
            false => "is left out of every response: add it to have the position itself",
        };
        format!(
            "Sampling: every {period} s. The command u(k) is held from {period} k to {period} (k+1) s, and y(k) is the position at {period} k + {phase} s. The model is y(k) = h(0) u(k) + ... + h(N-1) u(k-N+1) + offset with N = {taps}: after N samples a response is over, and what comes later is in the last of them. A step that returns a position returns y(k), which belongs to the beginning of the step of u(k); that of a servo model's export belongs to its end. The offset of {at_zero} {offset}.{of_motion}",
            period = number(model.sample_period_s),
            phase = number(model.sample_phase_s),
            taps = model.structure.settling_samples,
            at_zero = number(model.offset),
            of_motion = self.offset_of_motion().unwrap_or_default(),
        )
    }

    /// That the offset is no position of rest, of a servo that is not linear.
    fn offset_of_motion(&self) -> Option<String> {
        let machine = self.servo_model.filter(|servo| !servo.is_linear());
        (!self.model.linear || machine.is_some()).then(|| {
            let instead = match machine {
                Some(_) => ", which --servo-model exports,",
                None => "",
            };
            format!(
                " This servo is not linear: that is the mean of what this model is off over its recording, and no position of rest. The servo model{instead} has where it rests."
            )
        })
    }

    fn hold(&self, held: bool) -> String {
        let milliseconds = |seconds: f64| number((seconds * 1e7).round() / 1e4);
        let begin = self.metadata.open_delay().unwrap_or_else(|| "Delay: all of the servo's own delay, counted from the edge of the command as it was applied, is in the model.".to_owned());
        let frame = self
            .metadata
            .pulse_frame_s
            .map(milliseconds)
            .unwrap_or_default();
        let hold = match self.metadata.pulse_frame_s {
            None => format!(
                "How the command is held is not known, and no hold is assumed: state --frame-ms {WHEN_TO_STATE}."
            ),
            Some(0.0) => {
                "No frame hold is assumed: the command may change at any sample.".to_owned()
            }
            Some(_) if held => {
                format!(
                    "The hold of the command for a pulse frame of {frame} ms is part of this file: a smooth command is late by {} ms on average, as with \
                     the servo.",
                    milliseconds(self.frame_s() / 2.0)
                )
            }
            // A uniform delay between 0 and T has the mean T/2 and the standard deviation T/sqrt(12).
            Some(frame_s) => format!(
                "The frame hold is not: a servo gets a new pulse once in {frame} ms only. Put a sample and hold of {frame} ms before the model; a simulation without one must add {} ms of delay, and lacks a jitter of {} ms rms.",
                milliseconds(frame_s / 2.0),
                milliseconds(frame_s / 12f64.sqrt()),
            ),
        };
        format!("{begin} {hold}")
    }

    fn bounds(&self) -> String {
        let Bounds::Valid(bounds) = &self.model.step.bounds else {
            return match self.model.band() {
                Some(bounds) => format!(
                    "Bounds: level {} %. The frequency response, which is that of the excited band alone, has bounds that hold for each single frequency; step response and parameters have none (see the warning), and are not those of this frequency response.",
                    summary::percent(bounds.level)
                ),
                None => "Bounds: none can be given (see the warning).".to_owned(),
            };
        };
        let biases = [
            (bounds.truncation_bias, "left-out high frequencies"),
            (bounds.rounding_bias, "the steps of the sensor"),
        ];
        let biases = biases.into_iter().filter(|(bias, _)| *bias != 0.0);
        let biases = biases.map(|(bias, hidden_by)| {
            let bias = number(bias);
            format!(" {bias} of their half width is a bound of what {hidden_by} may hide.")
        });
        format!(
            "Bounds: level {} %. The step response has bounds that hold for each single point and, named simultaneous, for the whole curve; the frequency response for each single frequency. They are those of a linear servo: noise is in them and, from three runs on, what changes from run to run; saturation is not.{}",
            summary::percent(bounds.level),
            biases.collect::<String>(),
        )
    }

    fn parameters(&self) -> String {
        let structure = &self.model.structure;
        let [size, spread] = match self.model.bounds {
            Bounds::Valid(_) => [
                format!("; its covariance is {n} x {n}", n = structure.frequencies),
                ", and has the covariance A cov(theta) A'".to_owned(),
            ],
            Bounds::Withdrawn(_) => [String::new(), String::new()],
        };
        format!(
            "Parameters: theta = [G0, Re G1, Im G1, ...], {n} values, where Gl is the frequency response of the samples at l * 2 pi / (N Ts) rad/s{size}. With q = 2 pi l i / N, h(i) = (G0 + 2 sum (Re Gl cos q - Im Gl sin q)) / N: every response is a linear map A of theta{spread}. The hold of the samples is part of that response, of its magnitude and of its phase: it is what a loop that steps with the samples closes over. At w rad/s the servo alone has a phase that is greater by w (Ts/2 - p), where p is the time by which samples follow the edges of the command: for a continuous loop, and beside a data sheet, take that one, which tables and scripts have as the phase of the servo.",
            n = structure.frequencies
        )
    }
}

/// "the command is in us, the position is in deg"
pub(super) fn units_in_words(units: Units<'_>) -> String {
    let of = |what: &str, unit: Option<&str>| match unit {
        Some(unit) => format!("the {what} is in {unit}"),
        None => format!("the unit of the {what} is that of the recording, and not known"),
    };
    format!(
        "{}, {}",
        of("command", units.input),
        of("position", units.output)
    )
}

/// The parameters of a low-order model in the order of its covariance.
pub(super) fn parameters_of(flight: &FlightModel) -> &'static str {
    match flight.order {
        1 => "[K, L, ln T]",
        2 => "[K, L, ln w, ln zeta]",
        _ => "[K, L, ln w, ln zeta, ln T]",
    }
}

/// The covariance of a low-order model in one paragraph, for files that have no place for a matrix; `None`
/// where it has no bounds.
pub(super) fn low_order_covariance(flight: &FlightModel, style: &Style) -> Option<String> {
    let rows = flight.bounds.valid()?.covariance.iter();
    let rows: Vec<String> = rows.map(|row| format!("[{}]", style.short(row))).collect();
    let (parameters, rows) = (parameters_of(flight), rows.join(", "));
    Some(format!("Covariance of {parameters}: [{rows}]"))
}

/// What the largest error of a low-order model is of.
pub(super) fn of_error(flight: &FlightModel) -> String {
    match flight.band_hz {
        None => "of the step: of its step response from the identified one, which is not the servo"
            .to_owned(),
        Some([from, to]) => format!(
            "of the response at {from:.2} Hz: of its frequency response from the identified one, from {from:.2} to {to:.1} Hz"
        ),
    }
}

fn low_order(flight: &FlightModel, largest_error_percent: f64) -> String {
    let mut text = format!("Low-order model, continuous: {} with", flight.formula());
    for (name, unit, interval) in [
        ("K", "", Some(flight.gain)),
        ("L", " s", Some(flight.delay_s)),
        ("w", " rad/s", flight.omega_rad_s),
        ("zeta", "", flight.damping),
        ("T", " s", flight.lag_s),
    ] {
        let Some(Interval {
            value: Some(value),
            lower,
            upper,
        }) = interval
        else {
            continue;
        };
        let bound = |bound: Option<f64>| bound.map_or("-".to_owned(), |b| format!("{b:.6}"));
        let bounds = match (lower, upper) {
            (None, None) => String::new(),
            (Some(lower), None) => format!(" ({lower:.6} or more)"),
            _ => format!(" ({} to {})", bound(lower), bound(upper)),
        };
        text += &match name == "L" && value < 0.0 {
            // No program has a delay below zero.
            true => format!(
                " L = 0 s (estimated as {value:.6} s{bounds}, and this file is later by as much),"
            ),
            false => format!(" {name} = {value:.6}{unit}{bounds},"),
        };
    }
    let intervals = match &flight.bounds {
        Bounds::Valid(bounds) => format!("intervals of {} %", summary::percent(bounds.level)),
        Bounds::Withdrawn(_) => "of which no intervals can be given".to_owned(),
    };
    let is_earlier = flight.delay_s.value.is_some_and(|delay_s| delay_s < 0.0);
    let own = match (flight.approximation && flight.band_hz.is_none(), is_earlier) {
        (true, true) => {
            " As the fit compares both, with the delay that was estimated and by what the recording determines of a response: "
        }
        (true, false) => {
            " As the fit compares both, by what the recording determines of a response: "
        }
        (false, _) => " ",
    };
    let largest = match flight.band_hz {
        None => format!(
            "Largest difference of its step response from the identified one, at any sample: {largest_error_percent:.3} % of the step"
        ),
        Some([from, to]) => format!(
            "Largest difference of its frequency response from the identified one, from {from:.2} to {to:.1} Hz: {largest_error_percent:.3} % of that at {from:.2} Hz"
        ),
    };
    format!(
        "{text} {intervals}. {largest}; how far the identified one is from the servo, its bounds say, where there are any.{own}{}",
        flight.statement
    )
}
