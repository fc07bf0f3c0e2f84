//! The parameters of the servos in ArduPilot's simulation (SITL), as `libraries/SITL/ServoModel.cpp` of ArduPilot reads them.
//!
//! Such a servo delays the command by whole steps of the simulation, limits its rate, and filters it by a Butterworth filter of second
//! order. The filter is the one that lags as far behind a ramp as the servo does.

use super::difference::Difference;
use super::exported::ExportedServo;
use super::fixed_step::chosen_step_s;
use super::full_command::{FULL_DEG, FullCommand};
use super::rate_limit::{FACTOR, behind_in_larger_strokes, best_share};
use super::smooth_command::SmoothCommand;
use super::statement::{Comparison, Frame};
use super::subject::ServoExport;
use super::terms::Term;
use super::trial_command::Trial;
use super::worst_command::with_worst;
use crate::presentation::export::emulation::{DelayLine, SecondOrder};
use crate::presentation::export::error::ExportError;
use crate::presentation::export::target::Target;
use crate::presentation::export::text::{SCRIPT_STYLE, number};
use crate::presentation::summary::four_digits;
use crate::presentation::template::fill;
use servoid_identification::servo_model::{Load, ServoParameters};
use std::f64::consts::{PI, SQRT_2, TAU};

/// Steps of SITL in a second, unless SIM_RATE_HZ says otherwise.
const RATE_HZ: f64 = 1200.0;

/// The deflection that SIM_SERVO_SPEED is the time for \[deg\].
const SPEED_DEG: f64 = 60.0;

/// Highest cutoff as a part of the rate: a bilinear filter has none at half of it.
const HIGHEST_CUTOFF: f64 = 0.45;

/// What to do for the stops, which SITL has not.
const LIMIT_THE_COMMAND: &str = "limit the command to the stops, by the limits of its channel (SERVOn_MIN, SERVOn_MAX) or before it";

/// What SITL has not.
const LEFT_OUT: [Term; 15] = [
    Term::FullDrive,
    Term::SpeedInLoop,
    Term::TwoSpeeds,
    Term::DampingRatio,
    Term::DeadBand,
    Term::Play,
    Term::Friction,
    Term::FrictionOfGears,
    Term::FrictionAtRest,
    Term::ConstantLoad,
    Term::Weight,
    Term::Spring,
    Term::StiffeningLoad,
    Term::Stops,
    Term::PulseEnd,
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
    /// With the highest speed; `wait_s` is what the delay has beside that of the servo, and `full` is a full command.
    ///
    /// # Errors
    /// The chosen step is too long for the servo.
    fn of(export: &ServoExport<'_>, full: f64, wait_s: f64) -> Result<Self, ExportError> {
        let p = &export.parameters;
        let rate_hz = chosen_step_s(export)?.map_or(RATE_HZ, |step_s| (1.0 / step_s).round());
        // A line of n commands delays by n-1 steps, and a Butterworth filter by Tustin's rule is early by half a step.
        let line = ((p.delay_s.max(0.0) + wait_s) * rate_hz + 2.0).floor();
        // Both lag by c/k behind a ramp of unit speed.
        let cutoff = SQRT_2 * p.stiffness / p.damping / TAU;
        let time_s = |(up, down): (f64, f64)| speed(full) / ((up + down) / 2.0);
        Ok(Self {
            speed_s: export.top_speeds().map_or(0.0, time_s),
            // Half a step more, so that rounding does not cut a step off.
            delay_s: (line + 0.5) / rate_hz,
            filter_hz: cutoff.min(HIGHEST_CUTOFF * rate_hz),
            rate_hz,
        })
    }

    /// The speed \[units of the command/s\], where there is a limit.
    fn top(&self, full: f64) -> Option<f64> {
        (self.speed_s > 0.0).then(|| speed(full) / self.speed_s)
    }

    /// With this share of its speed; without a limit where there is none.
    fn slower(&self, share: Option<f64>) -> Self {
        Self {
            speed_s: share.map_or(0.0, |share| self.speed_s / share),
            ..*self
        }
    }

    /// The output at the beginning of each step, for commands as outputs.
    fn respond(&self, command: &[f64]) -> Vec<f64> {
        let first = command.first().copied().unwrap_or(0.0);
        let line = (self.delay_s * self.rate_hz).max(1.0) as usize;
        let mut late = DelayLine::new(line - 1, first);
        let most = if self.speed_s > 0.0 {
            speed(1.0) / self.speed_s / self.rate_hz
        } else {
            f64::INFINITY
        };
        // The cutoff is exact: Tustin's rule of a frequency that is bent accordingly.
        let bent = 2.0 * self.rate_hz * (PI * self.filter_hz / self.rate_hz).tan();
        let mut filter = SecondOrder::new(bent * bent, SQRT_2 * bent, 1.0 / self.rate_hz, first);
        let mut limited = first;
        let output = |command: &f64| {
            let command = late.pass(*command);
            limited = (limited + (command - limited).clamp(-most, most)).clamp(-1.0, 1.0);
            filter.pass(limited)
        };
        command.iter().map(output).collect()
    }
}

/// The change in the time of SIM_SERVO_SPEED, where a full command is this.
fn speed(full: f64) -> f64 {
    full * SPEED_DEG / FULL_DEG
}

/// A file of parameters.
pub(super) fn write(export: &ServoExport<'_>) -> Result<ExportedServo, ExportError> {
    let servo = &export.parameters;
    let command = FullCommand::of(export)?;
    let in_loop = &export.with_spring_in_loop();
    let full_speed = Parameters::of(in_loop, command.full, 0.0)?;
    let trial = Trial::of(export, 1.0 / full_speed.rate_hz, command.possible());
    let outputs = |commands: Vec<f64>| -> Vec<f64> {
        commands.into_iter().map(|u| command.output(u)).collect()
    };
    // What the header says of what is done with the output.
    let each = in_loop.parameters.gain * command.full;
    let positions = |outputs: &[f64], servo: &ServoParameters| -> Vec<f64> {
        let at_zero = servo.resting_output(command.zero);
        outputs
            .iter()
            .map(|output| at_zero + each * output)
            .collect()
    };
    let slower = |share, trial: &Trial| {
        let tried = outputs(trial.command());
        positions(&full_speed.slower(share).respond(&tried), servo)
    };
    let share = best_share(export, &trial, full_speed.top(command.full), slower).share;
    let parameters = full_speed.slower(share);
    let trial = with_worst(trial, export, |commands| {
        positions(&parameters.respond(&outputs(commands.to_vec())), servo)
    });
    // The trial has its commands at pulses, and no wait.
    let written = Parameters::of(in_loop, command.full, export.frame_s() / 2.0)?.slower(share);
    let smooth = SmoothCommand::of(export, &trial, written.top(command.full));
    let found = parameters.respond(&outputs(trial.command()));
    let of_loop = match servo.load {
        spring @ Load::Spring { .. } => spring,
        _ => Load::None,
    };
    let unloaded = export.parameters_with(of_loop).without_stops();
    let found = |servo: &ServoParameters| positions(&found, servo);
    let difference = Difference::of(export, trial, found, &unloaded);
    let rate = format!("{:.0}", parameters.rate_hz);
    let line = export.line(
        servo.resting_output(command.zero),
        each,
        "times the output of SITL's servo",
    );
    let mut about = about(
        export,
        (&rate, &command),
        rate_in_words(export, &parameters, &full_speed, command.full),
        &apply(export, &line, command.zero),
        &difference,
    );
    about.push(smooth.in_words(export, &|sine| {
        positions(&written.respond(&outputs(sine.command())), servo)
    }));
    let values = [
        ("about", SCRIPT_STYLE.comment(&about)),
        ("speed", number(written.speed_s)),
        ("delay", number(written.delay_s)),
        ("filter", number(written.filter_hz)),
        ("rate", rate),
    ];
    let text = fill(include_str!("../templates/servo_model/servo.parm"), &values);
    let remarks = [
        Some(format!("apply gain and offset yourself: {line}")),
        command.assumed(export),
        one_speed(
            export,
            written
                .top(command.full)
                .map(|top| top * each.abs() / command.full),
        ),
        behind_in_larger_strokes(share),
        limit_the_command(export),
    ];
    let remarks = remarks.into_iter().flatten();
    Ok(ExportedServo::new(text, difference)?
        .lacking(export, "ArduPilot", &LEFT_OUT)?
        .with(remarks.chain(export.without_play_and_dead_band())))
}

/// The same of a servo that has stops.
fn limit_the_command(export: &ServoExport<'_>) -> Option<String> {
    (!export.parameters.stops.are_none()).then(|| LIMIT_THE_COMMAND.to_owned())
}

/// Of the limit of these parameters beside the highest one.
fn rate_in_words(
    export: &ServoExport<'_>,
    parameters: &Parameters,
    full_speed: &Parameters,
    full: f64,
) -> String {
    let limit = parameters.top(full).map(|limit| [limit; 2]);
    let top = full_speed.top(full).unwrap_or_default();
    export.rate(limit, [top; 2])
}

/// That one speed of the position stands for two, where it is that of neither.
fn one_speed(export: &ServoExport<'_>, speed: Option<f64>) -> Option<String> {
    let speed = speed?;
    let (larger, smaller) = export.top_speeds()?;
    // Closer ones are as far apart as the speeds that are tried.
    let is_other = larger.min(smaller) < FACTOR * larger.max(smaller);
    let [up, down] = export.parameters.upwards_first([larger, smaller]);
    let of_position = |speed: f64| four_digits(export.parameters.gain.abs() * speed);
    let unit = export.output_unit();
    let load = export.parameters.load;
    let without = match load == export.load_of_loop() {
        true => "",
        false => ", without the load that is left out,",
    };
    is_other.then(|| {
        format!(
            "one speed stands for two: {} {unit}/s, where the model{without} has {} {unit}/s upwards and {} {unit}/s downwards",
            four_digits(speed),
            of_position(up),
            of_position(down)
        )
    })
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

fn about(
    export: &ServoExport<'_>,
    (rate, command): (&str, &FullCommand),
    rate_limit: String,
    apply: &str,
    difference: &Difference,
) -> Vec<String> {
    let lag_s = export.parameters.damping / export.parameters.stiffness;
    let mut about = export.statement(Target::Ardupilot);
    about.extend([
        start(export, command.zero),
        export.frame(Frame::InDelay("SIM_SERVO_DELAY")),
        format!(
            "In SITL: SIM_SERVO_SPEED is the time for {SPEED_DEG} degrees, or 0 for no limit. SIM_SERVO_DELAY is the delay and two steps more, at {rate} steps in a second (SIM_RATE_HZ): SITL delays by one step less than it is given and rounds down, and its filter is half a step early. SIM_SERVO_FILTER is the cutoff of the Butterworth filter (damping ratio 0.7071) that lags behind a ramp as this servo does, by {} ms. That suits commands that go on moving, as those of an autopilot do. A higher cutoff may be closer to the servo in strokes, and is early in such commands.",
            four_digits(1e3 * lag_s)
        ),
        rate_limit,
        "Time: the output that a step of SITL gives is that at the beginning of the step, when its command was given.".to_owned(),
        format!(
            "{} These parameters are those of all servos of the aircraft.",
            command.in_words(export)
        ),
        apply.to_owned(),
        export.left_out("ArduPilot's SITL", &LEFT_OUT),
    ]);
    about.extend(limit_the_command(export).map(|remark| format!("Stops: {remark}.")));
    about.push(export.difference(difference, Comparison::Emulation("ArduPilot's SITL")));
    about
}
