//! The parameters of the servos in ArduPilot's simulation (SITL), as `libraries/SITL/ServoModel.cpp` of ArduPilot reads them.
//!
//! Such a servo delays the command by whole steps of the simulation, limits its rate, and filters it by a Butterworth filter of second
//! order. The filter is the one that lags as far behind a ramp as the servo does.

use super::emulation::{DelayLine, SecondOrder};
use super::exported::ExportedServo;
use super::rate_limit::best_share;
use super::statement::{Comparison, Frame};
use super::subject::ServoExport;
use super::terms::Term;
use super::trial_command::{Difference, Trial};
use crate::presentation::export::error::ExportError;
use crate::presentation::export::text::{SCRIPT_STYLE, number};
use crate::presentation::summary::four_digits;
use crate::presentation::template::fill;
use servoid_identification::servo_model::{Load, ServoParameters};
use std::f64::consts::{PI, SQRT_2, TAU};

/// Steps of SITL in a second, unless SIM_RATE_HZ says otherwise.
const RATE_HZ: f64 = 1200.0;

/// The deflection that SITL takes for a full command \[deg\].
const FULL_DEG: f64 = 45.0;

/// The change of a pulse that SITL takes for an output of 1 \[us\].
const FULL_US: f64 = 500.0;

/// The deflection that SIM_SERVO_SPEED is the time for \[deg\].
const SPEED_DEG: f64 = 60.0;

/// Highest cutoff as a part of the rate: a bilinear filter has none at half of it.
const HIGHEST_CUTOFF: f64 = 0.45;

/// What to do for the stops, which SITL has not.
const LIMIT_THE_COMMAND: &str = "Limit the command to the stops, by the limits of its channel (SERVOn_MIN, SERVOn_MAX) or before it.";

/// What SITL has not.
const LEFT_OUT: [Term; 11] = [
    Term::FullDrive,
    Term::TwoSpeeds,
    Term::DampingRatio,
    Term::DeadBand,
    Term::Friction,
    Term::FrictionOfGears,
    Term::FrictionAtRest,
    Term::ConstantLoad,
    Term::Weight,
    Term::StiffeningLoad,
    Term::Stops,
];

/// The values of the parameters.
#[derive(Clone, Copy)]
struct Parameters {
    /// SIM_SERVO_SPEED \[s\]; 0 for no limit.
    speed_s: f64,
    /// SIM_SERVO_DELAY \[s\].
    delay_s: f64,
    /// SIM_SERVO_FILTER \[Hz\].
    filter_hz: f64,
    /// SIM_RATE_HZ.
    rate_hz: f64,
}

impl Parameters {
    fn of(export: &ServoExport<'_>, degrees_per_unit: f64) -> Self {
        let p = &export.parameters;
        let rate_hz = export
            .options
            .step_s
            .map_or(RATE_HZ, |step_s| (1.0 / step_s).round());
        // A line of n commands delays by n-1 steps, and a Butterworth filter by Tustin's rule is early by half a step.
        let line = (p.delay_s.max(0.0) * rate_hz + 2.0).floor();
        // Both lag by c/k behind a ramp of unit speed.
        let cutoff = SQRT_2 * p.stiffness / p.damping / TAU;
        let mean = |(up, down): (f64, f64)| degrees_per_unit * (up + down) / 2.0;
        let time_s = |speeds| SPEED_DEG / mean(speeds);
        Self {
            speed_s: export.top_speeds().map_or(0.0, time_s),
            // Half a step more, so that rounding does not cut a step off.
            delay_s: (line + 0.5) / rate_hz,
            filter_hz: cutoff.min(HIGHEST_CUTOFF * rate_hz),
            rate_hz,
        }
    }

    /// The speed \[units of the command/s\], where there is a limit.
    fn top(&self, degrees_per_unit: f64) -> Option<f64> {
        (self.speed_s > 0.0).then(|| SPEED_DEG / self.speed_s / degrees_per_unit)
    }

    /// With this share of its speed.
    fn slower(&self, share: f64) -> Self {
        Self {
            speed_s: self.speed_s / share,
            ..*self
        }
    }

    /// The deflection at the beginning of each step \[deg\], for such a command.
    fn respond(&self, command_deg: &[f64]) -> Vec<f64> {
        let first = command_deg.first().copied().unwrap_or(0.0);
        let line = (self.delay_s * self.rate_hz).max(1.0) as usize;
        let mut late = DelayLine::new(line - 1, first);
        let most = if self.speed_s > 0.0 {
            SPEED_DEG / self.speed_s / self.rate_hz
        } else {
            f64::INFINITY
        };
        // The cutoff is exact: Tustin's rule of a frequency that is bent accordingly.
        let bent = 2.0 * self.rate_hz * (PI * self.filter_hz / self.rate_hz).tan();
        let mut filter = SecondOrder::new(bent * bent, SQRT_2 * bent, 1.0 / self.rate_hz, first);
        let mut limited = first;
        let deflection = |command: &f64| {
            let command = late.pass(*command);
            limited = (limited + (command - limited).clamp(-most, most)).clamp(-FULL_DEG, FULL_DEG);
            filter.pass(limited)
        };
        command_deg.iter().map(deflection).collect()
    }
}

/// A file of parameters.
pub(super) fn write(export: &ServoExport<'_>) -> Result<ExportedServo, ExportError> {
    let degrees = export.radians_per_unit()?.to_degrees();
    let full_speed = Parameters::of(export, degrees);
    let trial = Trial::of(export, 1.0 / full_speed.rate_hz, FULL_DEG / degrees);
    let zero = command_of_zero(&trial, FULL_DEG / degrees);
    let turned: Vec<f64> = (trial.command().iter())
        .map(|u| degrees * (u - zero))
        .collect();
    // What the header says of what is done with the output.
    let gain = export.parameters.gain;
    let positions = |deflections: &[f64], servo: &ServoParameters| -> Vec<f64> {
        let at_zero = servo.resting_output(zero);
        let position = |deflection: &f64| at_zero + gain * deflection / degrees;
        deflections.iter().map(position).collect()
    };
    let servo = &export.parameters;
    let exact = trial.exact(servo);
    let slower = |share| positions(&full_speed.slower(share).respond(&turned), servo);
    let parameters =
        full_speed.slower(best_share(&trial, &exact, full_speed.top(degrees), slower).share);
    let deflections = parameters.respond(&turned);
    let unloaded = ServoExport::without_stops(export.parameters_with(Load::None));
    let found = |servo: &ServoParameters| positions(&deflections, servo);
    let difference = Difference::of(export, trial, found, &unloaded);
    let rate = format!("{:.0}", parameters.rate_hz);
    let beside = export.line(
        servo.resting_output(zero),
        gain * FULL_DEG / degrees,
        "times the output of SITL's servo",
    );
    let about = about(
        export,
        (&rate, degrees, zero),
        [&parameters, &full_speed].map(|found| SPEED_DEG / found.speed_s / degrees),
        &apply(export, &beside, zero),
        &difference,
    );
    let values = [
        ("about", SCRIPT_STYLE.comment(&about)),
        ("speed", number(parameters.speed_s)),
        ("delay", number(parameters.delay_s)),
        ("filter", number(parameters.filter_hz)),
        ("rate", rate),
    ];
    let text = fill(include_str!("../templates/servo_model/servo.parm"), &values);
    Ok(ExportedServo::new(text, difference)?.with(beside))
}

/// The command at which SITL's servo gives 0: that of 0 where a trial from there stays within the `farthest` command, which is a full one,
/// and else the middle of the trial.
fn command_of_zero(trial: &Trial, farthest: f64) -> f64 {
    let middle = trial.levels.first().copied().unwrap_or(0.0);
    let is_within = trial.levels.iter().all(|level| level.abs() <= farthest);
    if is_within { 0.0 } else { middle }
}

/// What is to be done beside the parameters, and where.
fn apply(export: &ServoExport<'_>, line: &str, zero: f64) -> String {
    let reversed = match export.parameters.gain < 0.0 {
        true => {
            ", and SERVOn_REVERSED, set opposite to that of the aircraft, turns it round, as this servo turns against its command"
        }
        false => "",
    };
    let unit = export.metadata.units().input;
    format!(
        "Apply beside the parameters the gain and the offset, which SITL's servo has not: {line}. The output is from -1 to 1, and 0 under the command {}{}. Apply them where your flight model takes the output: no parameter of ArduPilot comes behind the servo. Where the flight model cannot be changed, SERVOn_TRIM shifts the output{reversed}. The largest difference below is of the position so computed.",
        four_digits(zero),
        unit.map(|unit| format!(" {unit}")).unwrap_or_default()
    )
}

/// Where SITL's servo begins: its delay is filled with the first command, rate limit and filter begin at 0.
fn start(export: &ServoExport<'_>, zero: f64) -> String {
    format!(
        "Start: SITL's servo begins at the output 0, where the position is {} {}, and goes from there to its first command, for which there is no delay.",
        four_digits(export.parameters.resting_output(zero)),
        export.output_unit()
    )
}

/// What D is for the pulses of the recording.
fn full_command(export: &ServoExport<'_>, degrees: f64) -> String {
    match export.metadata.units().input {
        Some("us") => format!(
            "the command of the recording is in us, {} degrees each, so D is {}",
            four_digits(degrees),
            four_digits(FULL_US * degrees)
        ),
        _ => format!(
            "where the recorded pulses have P us for each degree (us_per_degree in the rig file), D is {FULL_US}/P, and with 10 us it is {}",
            FULL_US / 10.0
        ),
    }
}

fn about(
    export: &ServoExport<'_>,
    (rate, degrees, zero): (&str, f64, f64),
    [limit, top]: [f64; 2],
    apply: &str,
    difference: &Difference,
) -> Vec<String> {
    let lag_s = export.parameters.damping / export.parameters.stiffness;
    let mut about = export.statement();
    about.extend([
        start(export, zero),
        export.frame(Frame::InDelay("SIM_SERVO_DELAY")),
        format!(
            "In SITL: SIM_SERVO_SPEED is the time for {SPEED_DEG} degrees, or 0 for no limit, SIM_SERVO_DELAY the delay and the two steps that SITL and its filter are early by, at {rate} steps in a second (SIM_RATE_HZ), and SIM_SERVO_FILTER the cutoff of the Butterworth filter (damping ratio 0.7071) that lags behind a ramp as this servo does, by {} ms.",
            four_digits(1e3 * lag_s)
        ),
        export.rate([limit; 2], [top; 2]),
        format!(
            "An output of 1 stands for {FULL_DEG} degrees of the command here, as SITL's speed takes it. Where a full command is D degrees, multiply SIM_SERVO_SPEED, and what the output is multiplied by, by D/{FULL_DEG}. SITL's output of 1 is a pulse {FULL_US} us longer than 1500 us: {}. These parameters are those of all servos of the aircraft.",
            full_command(export, degrees)
        ),
        apply.to_owned(),
        export.left_out("ArduPilot's SITL", &LEFT_OUT),
    ]);
    about.extend((!export.parameters.stops.are_none()).then(|| LIMIT_THE_COMMAND.to_owned()));
    about.push(export.difference(difference, Comparison::Emulation("ArduPilot's SITL")));
    about
}
