//! The response to sines of frequencies that somebody asks for: how much of one arrives, and how late.

use crate::data::model_metadata::ModelMetadata;
use crate::presentation::summary::wording::numbers::{
    WORTH_PRINTING, decimals, digits, fixed, head_of_bounds,
};
use crate::presentation::summary::wording::strokes::{of_one_size, stroke_in_words};
use servoid_identification::Error;
use servoid_identification::results::{
    Bounds, FrequencyResponse, Interval, Model, Reason, Withheld, with_unit,
};
use servoid_identification::servo_model::{QuantityKind, ServoModel};
use std::f64::consts::TAU;

/// Frequencies up to one that is asked for along which its phase is followed: a phase alone does not say how many turns it lacks.
const FOLLOWED: usize = 400;

/// A sine that is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AskedSine {
    /// Its frequency \[Hz\].
    pub hertz: f64,
    /// How far it goes to each side \[unit of the command\], which a servo that is limited depends on.
    pub amplitude: Option<f64>,
}

/// What becomes of a sine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainAndPhase {
    /// Amplitude of the motion over that of the command \[output per input\]; without ends where bounds are withdrawn.
    pub gain: Interval,
    /// Phase \[degrees\]; a lag is negative. Empty where the sine does not move the servo.
    pub phase_deg: Interval,
    /// Phase of the slowest sines \[degrees\], from which a lag counts: 0, or a half turn where the position goes against the command.
    pub phase_at_rest_deg: f64,
}

/// A motion of less than this part of that of a slow sine is the rounding of a simulation.
const ROUNDING: f64 = 1e-9;

impl GainAndPhase {
    /// Whether the sine does not move the servo at all, as one within its dead band: then it has no phase.
    #[must_use]
    pub fn stands_still(&self) -> bool {
        self.gain.value == Some(0.0)
    }

    /// How far the motion is behind \[degrees\].
    fn lag_deg(&self) -> Option<f64> {
        self.phase_deg
            .value
            .map(|phase| self.phase_at_rest_deg - phase)
    }
}

/// Gain and phase \[degrees\] of `model` at each frequency that is asked for, two lines of a table each, and of the servo as a machine at those
/// with an amplitude; nothing where none is asked for.
///
/// # Errors
/// The document of the model was changed by hand.
pub fn at_frequencies(
    model: &Model,
    servo: Option<&ServoModel>,
    of: &ModelMetadata,
    asked: &[AskedSine],
) -> Result<String, Error> {
    if asked.is_empty() {
        return Ok(String::new());
    }
    let machine = asked.iter().filter_map(|sine| {
        let amplitude = sine.amplitude?;
        servo.map(|servo| of_machine(servo, of, sine.hertz, amplitude))
    });
    let machine: String = machine.collect();
    let linear = of_linear_model(model, of, asked)?;
    // What is asked of an amplitude, the linear model of a servo that is not linear does not answer.
    let late = match of.pulse_frame_s {
        Some(_) => AT_PULSES,
        None if servo.is_some_and(|servo| servo.fit.waits_for_pulses.is_some()) => {
            MACHINE_AT_PULSES
        }
        None => AT_ROWS,
    };
    let of_one_size = of_one_size(model, of).map(|_| OF_ONE_SIZE);
    let is_of_sines = model.linear && of_one_size.is_none();
    Ok(match machine.is_empty() {
        true => linear + of_one_size.unwrap_or_default() + late,
        false if is_of_sines => linear + &machine + late,
        false => machine + &linear + OF_THE_AMPLITUDE + late,
    })
}

/// Said below the table of strokes of one size, which a servo that is limited follows as a linear one does.
const OF_ONE_SIZE: &str = "  Strokes of one size do not show whether the servo is linear. One that is limited in its drive or speed follows\n  small sines sooner and farther than this, and large quick ones less: record steps of several sizes, such as\n  random levels.\n";

/// Said below the tables of a servo that is not linear.
const OF_THE_AMPLITUDE: &str = "  What becomes of a sine of this amplitude, the servo model says: the linear model is of the motion that was recorded.\n";

/// Said below the table of a recording whose commands stand at their pulses.
const AT_PULSES: &str = "  Late: behind a smooth command that the servo gets as it is. One that is held for frames, as by a pulse every\n  20 ms, is half a frame later; more where limits of speed or drive are reached.\n";

/// The same of any other recording.
const AT_ROWS: &str = "  Late: behind a smooth command that is sent as those of this recording were. If these stood at their pulses, a\n  command that is held for frames of 20 ms is half a frame later, and more where limits of speed or drive are\n  reached; if they waited for pulses, that is included.\n";

/// The same where a servo model has its commands at pulses that they waited for.
const MACHINE_AT_PULSES: &str = "  Late: by the servo model, behind a smooth command that the servo gets as it is; one that waits for pulses is half\n  of the time between them later. By the linear model that wait is included.\n";

/// Of the servo as a machine, under a sine of this amplitude.
fn of_machine(servo: &ServoModel, of: &ModelMetadata, hertz: f64, amplitude: f64) -> String {
    let (found, withdrawn) = sine_of_machine(servo, of, hertz, amplitude, 0);
    let level = servo.covariance.as_ref().map(|own| own.level);
    let head = match (withdrawn, level) {
        // That of all of the model is said beside it.
        (Some(reason), Bounds::Valid(_)) => format!("no bounds: {}", reason.because()),
        _ => head_of_bounds(level),
    };
    let unit = of
        .units()
        .input
        .map(|unit| format!(" {unit}"))
        .unwrap_or_default();
    let name = format!("servo model, ±{amplitude}{unit}");
    let head = match found.stands_still() {
        true => "a sine of this size does not move it".to_owned(),
        false => head,
    };
    let open_deg = open_deg(of, hertz);
    let open = match withdrawn {
        Some(_) if open_deg > 0.0 && !found.stands_still() => format!(
            "  {:22} the times of the recording leave ±{} deg of it open\n",
            "",
            fixed(open_deg, 1)
        ),
        _ => String::new(),
    };
    let small = small_for_its_rests(servo, of, amplitude);
    let at_rest = servo.quantity(QuantityKind::Gain);
    let at_rest = at_rest
        .filter(|gain| gain.determined)
        .map(|gain| gain.value);
    format!("\n  {name:22} {:>10}       {head}\n", "value")
        + &lines(&found, of, hertz, at_rest)
        + &open
        + &small
}

/// Share of a sine by which rests that the model does not explain make it smaller to be said.
const NOTABLE: f64 = 0.1;

/// That rests under one command are apart in the recording by a part of this sine which the model has not.
fn small_for_its_rests(servo: &ServoModel, of: &ModelMetadata, amplitude: f64) -> String {
    let found = servo.unexplained_hysteresis();
    let lacks = found.and_then(|found| Some((found.shown?, found.explained)));
    let way = 2.0 * amplitude * servo.parameters(0).gain.abs();
    match lacks.filter(|(shown, explained)| shown - explained > NOTABLE * way) {
        Some((shown, explained)) => {
            let unit = of.units().output.unwrap_or_default();
            let [shown, explained] =
                [shown, explained].map(|apart| with_unit(digits(apart, 2), unit));
            format!(
                "  {:22} rests are {shown} apart in the recording, of which the model has {explained}:\n  {:22} the servo follows so small a sine less, and later\n",
                "", ""
            )
        }
        None => String::new(),
    }
}

/// By how much the times of the recording leave the phase open \[degrees\].
fn open_deg(of: &ModelMetadata, hertz: f64) -> f64 {
    360.0 * hertz * of.sensor_delay_uncertainty_s
}

/// The response of the servo as a machine, with the controller number `controller` (from 0), to a sine of this amplitude, and why it has no bounds, where
/// it has none. What the times of the recording leave open is in them.
#[must_use]
pub fn sine_of_machine(
    servo: &ServoModel,
    of: &ModelMetadata,
    hertz: f64,
    amplitude: f64,
    controller: usize,
) -> (GainAndPhase, Option<Reason>) {
    let found = servo.respond_to_sine(hertz, amplitude, controller);
    let open_deg = open_deg(of, hertz);
    let gain_at_rest = servo.parameters(controller).gain;
    let phase_at_rest_deg = match gain_at_rest < 0.0 {
        true => 180.0,
        false => 0.0,
    };
    let with = |gain, phase_deg| GainAndPhase {
        gain,
        phase_deg,
        phase_at_rest_deg,
    };
    match found.bounds {
        bounds if found.gain < ROUNDING * gain_at_rest.abs() => {
            let none = Interval::new(0.0, f64::NAN, f64::NAN);
            (with(none, Interval::default()), bounds.withdrawn())
        }
        Bounds::Valid([gain, phase]) => {
            let phase_deg = Interval {
                lower: phase.lower.map(|lower| lower - open_deg),
                upper: phase.upper.map(|upper| upper + open_deg),
                ..phase
            };
            (with(gain, phase_deg), None)
        }
        Bounds::Withdrawn(reason) => {
            let [gain, phase_deg] = [found.gain, found.phase_deg].map(|value| Interval {
                value: Some(value),
                ..Interval::default()
            });
            (with(gain, phase_deg), Some(reason))
        }
    }
}

/// The response of the linear model to a sine, without a hold of the command, or why it has none there.
///
/// # Errors
/// The document of the model was changed by hand.
pub fn sine_of_linear_model(
    model: &Model,
    hertz: f64,
) -> Result<Result<GainAndPhase, String>, Error> {
    if hertz > 0.5 / model.sample_period_s {
        return Ok(Err(
            "above half of the rows in a second: this recording does not show it".to_owned(),
        ));
    }
    let has_bounds = model.frequency.bounds.valid().is_some();
    let found = gain_and_phase(model, hertz)?;
    Ok(match (found, model.metrics.why_withheld()) {
        (None, _) => Err(outside_of_band(model)),
        // The frequency itself may be excited well.
        (Some(_), _) if !has_bounds && model.metrics.withheld == Some(Withheld::InputUnexcited) => Err(
            "withheld: where the reference leaves part of the response open, nothing says how far the linear model is off".to_owned(),
        ),
        (Some(_), Some(because)) if !has_bounds => Err(format!("withheld: {because}")),
        (Some(found), _) => Ok(found),
    })
}

/// Why a response in a band has none at another frequency.
fn outside_of_band(model: &Model) -> String {
    match model.band_hz() {
        Some([from, to]) => format!(
            "the response is known to a tenth from {from:.2} to {to:.1} Hz; less noise, a rest after the motion, more of the commands beyond, and more runs where several differ show more"
        ),
        None => "outside of the frequencies of the commands".to_owned(),
    }
}

fn of_linear_model(
    model: &Model,
    of: &ModelMetadata,
    asked: &[AskedSine],
) -> Result<String, Error> {
    let bounds = model.frequency.bounds.as_ref();
    let head = head_of_bounds(bounds.map(|bounds| bounds.level));
    // As the other figures of a servo that is not linear.
    let motion = match (bounds.valid().is_some(), model.linear) {
        (true, false) => ", of the recorded motion".to_owned(),
        // A servo that is limited follows a sine of that size otherwise.
        (true, true) => {
            stroke_in_words(of).map_or_else(String::new, |size| format!(", of strokes of {size}"))
        }
        (false, _) => String::new(),
    };
    let mut text = format!(
        "\n  {:22} {:>10}       {head}{motion}\n",
        "linear model", "value"
    );
    for (place, AskedSine { hertz, .. }) in asked.iter().copied().enumerate() {
        if asked.iter().take(place).any(|before| before.hertz == hertz) {
            continue;
        }
        text += &match sine_of_linear_model(model, hertz)? {
            Ok(found) => lines(&found, of, hertz, model.metrics.dc_gain.value),
            Err(why) => format!(
                "  {:22} {:>10}       {why}\n",
                format!("gain at {hertz} Hz"),
                "-"
            ),
        };
    }
    Ok(text)
}

/// Gain and phase, and the share of the gain `at_rest` that is left, where that is known.
fn lines(found: &GainAndPhase, of: &ModelMetadata, hertz: f64, at_rest: Option<f64>) -> String {
    let digits = decimals(found.gain.value.unwrap_or(1.0), 4);
    let unit = of.units().gain().unwrap_or_default();
    let late_ms = found.lag_deg().map(|degrees| degrees / 360.0 / hertz * 1e3);
    let behind = match found.phase_at_rest_deg {
        0.0 => "",
        _ => ", behind the command with its sign changed",
    };
    let late = late_ms.map_or_else(String::new, |late| {
        format!("  = {} ms late{behind}", fixed(late, 1))
    });
    let gain = line(&format!("gain at {hertz} Hz"), &found.gain, &unit, digits);
    let phase = line(&format!("phase at {hertz} Hz"), &found.phase_deg, "deg", 1);
    let share = found.gain.value.zip(at_rest);
    let share = share.map_or_else(String::new, |(gain, at_rest)| {
        format!(
            "  = {} % of that at rest",
            fixed(100.0 * gain / at_rest.abs(), 0)
        )
    });
    format!("  {gain}{share}\n  {phase}{late}\n")
}

fn line(name: &str, interval: &Interval, unit: &str, digits: usize) -> String {
    let number = |value: f64| fixed(value, digits);
    let value = interval.value.map_or_else(|| "-".to_owned(), number);
    let size = interval.value.unwrap_or_default().abs();
    let bounds = interval.ends();
    let bounds = bounds.map_or_else(String::new, |[lower, upper]| {
        match upper > WORTH_PRINTING * size {
            true if size > 0.0 => "not determined".to_owned(),
            _ => format!("{} .. {}", number(lower), number(upper)),
        }
    });
    format!("{name:22} {value:>10} {unit:5} {bounds}")
        .trim_end()
        .to_owned()
}

/// The response of the servo at `hertz`; `None` outside of the band that the commands excite, where it is known in a band alone.
fn gain_and_phase(model: &Model, hertz: f64) -> Result<Option<GainAndPhase>, Error> {
    let omega = TAU * hertz;
    if model.band().is_some() {
        return within_band(model, omega);
    }
    let below: Vec<f64> = (1..=FOLLOWED)
        .map(|k| omega * k as f64 / FOLLOWED as f64)
        .collect();
    let found = model.servo_response(&below)?;
    Ok(Some(point(&found, FOLLOWED - 1)))
}

/// From the two points of the model's own response on both sides of it: the interval holds those of both.
fn within_band(model: &Model, omega: f64) -> Result<Option<GainAndPhase>, Error> {
    let grid = &model.frequency.omega_rad_s;
    let above = grid.partition_point(|other| *other < omega);
    let (Some(below), Some(&right)) = (above.checked_sub(1), grid.get(above)) else {
        return Ok(None);
    };
    let Some(&left) = grid.get(below) else {
        return Ok(None);
    };
    let found = model.servo_response(grid)?;
    let part = (omega - left) / (right - left);
    let (a, b) = (point(&found, below), point(&found, above));
    let between = |a: Interval, b: Interval| Interval {
        value: (a.value.zip(b.value)).map(|(a, b)| a + part * (b - a)),
        lower: (a.lower.zip(b.lower)).map(|(a, b)| a.min(b)),
        upper: (a.upper.zip(b.upper)).map(|(a, b)| a.max(b)),
    };
    Ok(Some(GainAndPhase {
        gain: between(a.gain, b.gain),
        phase_deg: between(a.phase_deg, b.phase_deg),
        phase_at_rest_deg: a.phase_at_rest_deg,
    }))
}

/// Gain and phase at one of the frequencies of a response, the first of which is low.
fn point(found: &FrequencyResponse, k: usize) -> GainAndPhase {
    let of_decibels = |values: &Vec<f64>| values.get(k).map(|db| 10f64.powf(db / 20.0));
    let own = |values: &Vec<f64>| values.get(k).copied();
    let bounds = found.bounds.valid();
    let slowest = found.phase_deg.first().copied().unwrap_or_default();
    let gain = Interval {
        value: of_decibels(&found.magnitude_db),
        lower: bounds.and_then(|bounds| of_decibels(&bounds.magnitude_db_lower)),
        upper: bounds.and_then(|bounds| of_decibels(&bounds.magnitude_db_upper)),
    };
    let phase_deg = Interval {
        value: own(&found.phase_deg),
        lower: bounds.and_then(|bounds| own(&bounds.phase_deg_lower)),
        upper: bounds.and_then(|bounds| own(&bounds.phase_deg_upper)),
    };
    GainAndPhase {
        gain,
        phase_deg,
        phase_at_rest_deg: 180.0 * (slowest / 180.0).round(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_identification::{Options, Record, Run, identify};

    /// A first-order servo of 40 rad/s behind 10 ms, in rows of 2 ms, under levels that are held for .3 s; its gain is 1 or -1.
    fn model(gain: f64) -> Model {
        let (h, pole) = (0.002, (-0.08_f64).exp());
        let level = |k: usize| [0.0, 8.0, -6.0, 3.0, -9.0, 5.0, -2.0][(k / 150) * 3 % 7];
        let input: Vec<f64> = (0..6000).map(level).collect();
        let mut state = 0.0;
        let noise = |k: usize| 0.02 * ((k * k * 7919 % 1009) as f64 / 504.5 - 1.0);
        let output: Vec<f64> = (0..6000)
            .map(|k| {
                let command = if k < 6 { 0.0 } else { input[k - 6] };
                state = pole * state + (1.0 - pole) * command;
                gain * state + noise(k)
            })
            .collect();
        let record = Record::new(h, vec![Run::new(input, output).unwrap()]).unwrap();
        identify(&record, &Options::default()).unwrap()
    }

    #[test]
    fn gain_and_phase_are_those_of_the_servo_with_more_than_a_half_turn() {
        let model = model(1.0);
        for hertz in [0.5, 8.0, 25.0] {
            let found = gain_and_phase(&model, hertz).unwrap().unwrap();
            let omega = TAU * hertz;
            let truth = 1.0 / 1.0_f64.hypot(omega / 40.0);
            // A held command and the first sample behind its edge: a servo in continuous time answers one row sooner than the recursion.
            let lag = (omega / 40.0).atan() + omega * 0.010;
            let holds = |found: &Interval, truth: f64| {
                found.lower.unwrap() < truth && truth < found.upper.unwrap()
            };
            assert!(holds(&found.gain, truth), "{hertz}: {found:?}, {truth}");
            assert!(
                holds(&found.phase_deg, -lag.to_degrees()),
                "{hertz}: {found:?}, {}",
                -lag.to_degrees()
            );
        }
        let asked = [8.0, 251.0].map(|hertz| AskedSine {
            hertz,
            amplitude: None,
        });
        let said = at_frequencies(&model, None, &ModelMetadata::default(), &asked).unwrap();
        for line in [
            "gain at 8 Hz",
            "phase at 8 Hz",
            "ms late",
            "above half of the rows",
            "half a frame later",
        ] {
            assert_eq!(said.matches(line).count(), 1, "{line}: {said}");
        }
    }

    #[test]
    fn a_servo_against_its_command_is_as_late_as_one_that_goes_with_it() {
        let hertz = 8.0;
        let truth = (TAU * hertz / 40.0).atan() + TAU * hertz * 0.010;
        for gain in [1.0, -1.0] {
            let found = gain_and_phase(&model(gain), hertz).unwrap().unwrap();
            // The interval is of a degree.
            let off = found.lag_deg().unwrap() - truth.to_degrees();
            assert!(off.abs() < 2.0, "{gain}: {found:?}");
        }
        let sine = AskedSine {
            hertz,
            amplitude: None,
        };
        let of = ModelMetadata::default();
        let said = at_frequencies(&model(-1.0), None, &of, &[sine]).unwrap();
        assert!(
            said.contains("behind the command with its sign changed"),
            "{said}"
        );
    }
}
