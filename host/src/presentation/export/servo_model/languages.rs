//! The equation as a module, a function or a header: the steps that servoid itself takes, in steps of one length.

use super::difference::Difference;
use super::exported::ExportedServo;
use super::fixed_step::{DelayInSteps, respond, step_s};
use super::statement::{Comparison, Frame};
use super::subject::{NO_LIMIT, ServoExport};
use super::trial_command::Trial;
use super::worst_command::with_worst;
use crate::presentation::export::error::ExportError;
use crate::presentation::export::target::Target;
use crate::presentation::export::text::{
    C_STYLE, MATLAB_STYLE, PYTHON_STYLE, SCRIPT_STYLE, Style, identifier, number, plain, quoted,
};
use crate::presentation::template::fill;
use servoid_identification::servo_model::Load;

/// A language.
struct Language {
    comment: Style,
    template: &'static str,
    /// A parameter as a line: its name in small letters, its value and its meaning.
    parameter: fn(id: &str, name: &str, value: &str, meaning: &str) -> String,
    /// The name of a parameter in the equation.
    name: fn(id: &str, name: &str) -> String,
    /// The load of a weight, and that of the air, of such names.
    weight: &'static str,
    air: &'static str,
    /// What a sine needs at the top of the file.
    sine: &'static str,
    /// The name of the servo within a string.
    quoted_name: fn(&str) -> String,
}

/// A C99 header.
pub(super) fn c(export: &ServoExport<'_>) -> Result<ExportedServo, ExportError> {
    export.in_language(&Language {
        comment: C_STYLE,
        template: include_str!("../templates/servo_model/servo.h"),
        parameter: |id, name, value, meaning| {
            format!("static const {id}_real {id}_{name} = {value}; /* {meaning} */")
        },
        name: |id, name| format!("{id}_{name}"),
        weight: "{{gravity}} * ({{id}}_real)sin((double)((angle + {{from}}) * {{radians}}))",
        air: "{{constant}} + ({{beyond}} ? {{stiffening}} * (angle - {{from}}) * (angle - {{from}}) : 0)",
        sine: "#include <math.h> /* sin: link with -lm */\n",
        // A question mark could begin a trigraph.
        quoted_name: |name| quoted(name, &['"', '?']),
    })
}

/// A Julia module.
pub(super) fn julia(export: &ServoExport<'_>) -> Result<ExportedServo, ExportError> {
    export.in_language(&Language {
        comment: SCRIPT_STYLE,
        template: include_str!("../templates/servo_model/servo.jl"),
        parameter: |_, name, value, meaning| {
            format!("const {} = {value} # {meaning}", name.to_ascii_uppercase())
        },
        name: |_, name| name.to_ascii_uppercase(),
        weight: "{{gravity}} * sin((angle + {{from}}) * {{radians}})",
        air: "{{constant}} + ({{beyond}} ? {{stiffening}} * (angle - {{from}})^2 : 0.0)",
        sine: "",
        // A dollar would put the value of an expression in.
        quoted_name: |name| quoted(name, &['"', '$']),
    })
}

/// A MATLAB function, which Octave runs too.
pub(super) fn matlab(export: &ServoExport<'_>) -> Result<ExportedServo, ExportError> {
    export.in_language(&Language {
        comment: MATLAB_STYLE,
        template: include_str!("../templates/servo_model/servo.m"),
        parameter: |_, name, value, meaning| format!("p.{name} = {value}; % {meaning}"),
        name: |_, name| format!("p.{name}"),
        weight: "{{gravity}} * sin((angle + {{from}}) * {{radians}})",
        air: "{{constant}} + {{stiffening}} * (angle - {{from}})^2 * ({{beyond}})",
        sine: "",
        quoted_name: |name| plain(name).replace('\'', "''"),
    })
}

/// A Python module.
pub(super) fn python(export: &ServoExport<'_>) -> Result<ExportedServo, ExportError> {
    export.in_language(&Language {
        comment: PYTHON_STYLE,
        template: include_str!("../templates/servo_model/servo.py"),
        parameter: |_, name, value, meaning| {
            format!("{} = {value}  # {meaning}", name.to_ascii_uppercase())
        },
        name: |_, name| name.to_ascii_uppercase(),
        weight: "{{gravity}} * math.sin((angle + {{from}}) * {{radians}})",
        air: "{{constant}} + ({{stiffening}} * (angle - {{from}}) ** 2 if {{beyond}} else 0.0)",
        sine: "import math\n\n",
        quoted_name: |name| quoted(name, &['"']),
    })
}

impl ServoExport<'_> {
    fn in_language(&self, language: &Language) -> Result<ExportedServo, ExportError> {
        let step_s = step_s(self)?;
        let trial = Trial::of(self, step_s, [f64::NEG_INFINITY, f64::INFINITY]);
        // Of the equation itself a search finds nothing but the moments in which a motion hangs in the balance.
        let trial = match self.parameters.pulse_end {
            None => trial,
            Some(_) => with_worst(trial, self, |commands| respond(self, step_s, commands)),
        };
        let positions = respond(self, step_s, &trial.command());
        let difference = Difference::of(self, trial, |_| positions.clone(), &self.parameters);
        let delay = DelayInSteps::new(self.parameters.delay_s, step_s);
        let id = identifier(self.name);
        // All languages are alike in it.
        let mut about = self.statement(Target::C);
        about.push("Start: at rest under the command that it is begun with, in the middle of what friction and dead band hold; commands before count as that one.".to_owned());
        about.push(self.frame(Frame::BeforeFile));
        about.push(format!(
            "Steps: {} ms each, by the scheme of servoid's own integrator: half a step of the angle, a step of the speed, half a step of the angle. A step is taken in two parts where the delayed command changes within it. The position that it returns is that of its end; an export of the linear model returns that of the beginning.",
            number(1e3 * step_s)
        ));
        about.extend(self.stops_in_words("this file"));
        about.push(match self.parameters.pulse_end {
            None => "Left out: nothing; the equation is here with all of its terms.".to_owned(),
            Some(_) => "Left out: that longer pulses act later; the equation is here with all of its terms but that.".to_owned(),
        });
        about.push(self.difference(&difference, Comparison::SameSteps));
        let name = |name: &str| (language.name)(&id, name);
        let sine = matches!(self.parameters.load, Load::Pendulum { .. });
        let values = [
            ("about", language.comment.comment(&about)),
            ("name", (language.quoted_name)(self.name)),
            ("step", number(step_s)),
            ("delay_steps", delay.whole.to_string()),
            (
                "parameters",
                self.parameter_lines(language, &id, delay.fraction),
            ),
            ("load", load(&self.parameters.load, language, &id, name)),
            ("sine", language.sine.repeat(usize::from(sine))),
            ("ID", id.to_ascii_uppercase()),
            ("id", id),
        ];
        let file = ExportedServo::new(fill(language.template, &values), difference)?;
        let why = match self.parameters.pulse_end {
            None => "its steps are too long for it: choose a shorter --step-ms",
            Some(_) => {
                "longer pulses act later in the servo, and not in the file: hand each command over as much later, or sooner, as the file says under \"Pulses\""
            }
        };
        let file = file.that_follows(self, || format!("as {why}"))?;
        let file = file.warned_where_far(self, || why.to_owned());
        Ok(file.with([format!(
            "one step of the file is {} ms, one command each: repeat a command that is held for longer, or choose another step with --step-ms",
            number(1e3 * step_s)
        )]))
    }

    /// The parameters of the equation, a line each; terms that the servo does not have get values without effect.
    fn parameter_lines(&self, language: &Language, id: &str, fraction: f64) -> String {
        let p = &self.parameters;
        let friction = p.friction;
        let at_rest = friction.and_then(|friction| friction.at_rest);
        let limit = p.drive_limit();
        let [lowest_speed, highest_speed] = self.speed_limits();
        let mut lines = vec![
            (
                "delay_fraction",
                fraction,
                "of a step, beside the whole steps of the delay",
            ),
            ("stiffness", p.stiffness, "k, 1/s^2"),
            ("damping", p.damping, "c, 1/s, that of motor and loop"),
            (
                "motor_damping",
                limit.map_or(0.0, |l| l.motor_damping),
                "B, 1/s",
            ),
            (
                "full_drive",
                limit.map_or(NO_LIMIT, |l| l.up),
                "A+; 1e30: no limit",
            ),
            ("down_to_up", limit.map_or(1.0, |l| l.down_to_up), "A-/A+"),
            (
                "loop_down_to_up",
                limit.map_or(1.0, |l| l.loop_down_to_up()),
                "stiffness and damping of the loop where the drive is negative, to those where it is positive",
            ),
            (
                "lowest_speed",
                lowest_speed,
                "omega is cut off there; -1e30: no limit",
            ),
            (
                "highest_speed",
                highest_speed,
                "omega is cut off there; 1e30: no limit",
            ),
            ("dead_band", p.dead_band.unwrap_or(0.0), "w"),
            ("play", p.play.unwrap_or(0.0), "b"),
            ("friction", friction.map_or(0.0, |f| f.coulomb), "C"),
            (
                "friction_of_gears",
                friction.map_or(0.0, |f| f.of_gears),
                "mu",
            ),
            ("friction_at_rest", at_rest.map_or(0.0, |a| a.excess), "s"),
            ("friction_speed", at_rest.map_or(1.0, |a| a.speed), "ws"),
            ("gain", p.gain, "position for each unit of phi"),
            ("offset", p.offset, "position at phi = 0"),
            (
                "lowest_angle",
                self.stops()[0],
                "theta of a stop; -1e30: none",
            ),
            (
                "highest_angle",
                self.stops()[1],
                "theta of a stop; 1e30: none",
            ),
        ];
        lines.extend(load_parameters(&p.load));
        let line = |(name, value, meaning): &(&str, f64, &str)| {
            (language.parameter)(id, name, &number(*value), meaning)
        };
        lines.iter().map(line).collect::<Vec<_>>().join("\n")
    }
}

const LOAD_CONSTANT: &str = "load_constant";
const LOAD_GRAVITY: &str = "load_gravity";
const LOAD_RATE: &str = "load_rate";
const LOAD_FROM: &str = "load_from";
const LOAD_RADIANS: &str = "load_radians";
const LOAD_STIFFENING: &str = "load_stiffening";

/// The parameters of a load: name, value and meaning.
fn load_parameters(load: &Load<f64>) -> Vec<(&'static str, f64, &'static str)> {
    match *load {
        Load::None => vec![],
        Load::Constant(constant) => vec![(LOAD_CONSTANT, constant, "at all angles")],
        Load::Pendulum {
            gravity,
            from,
            radians,
        } => vec![
            (LOAD_GRAVITY, gravity, "of a level arm"),
            (LOAD_FROM, from, "the arm hangs at theta = -this"),
            (LOAD_RADIANS, radians, "radians for each unit of theta"),
        ],
        Load::Spring { constant, rate } => vec![
            (LOAD_CONSTANT, constant, "at theta = 0"),
            (LOAD_RATE, rate, "its growth with theta, 1/s^2"),
        ],
        Load::Air {
            constant,
            stiffening,
            from,
        } => vec![
            (LOAD_CONSTANT, constant, "at all angles"),
            (
                LOAD_STIFFENING,
                stiffening,
                "times the square beyond the next",
            ),
            (LOAD_FROM, from, "theta from which it stiffens"),
        ],
    }
}

/// The load as an expression of the angle.
fn load(load: &Load<f64>, language: &Language, id: &str, name: impl Fn(&str) -> String) -> String {
    let template = match load {
        Load::None => return "0.0".to_owned(),
        Load::Constant(_) => return name(LOAD_CONSTANT),
        Load::Pendulum { .. } => language.weight,
        Load::Spring { .. } => {
            return format!("{} + {} * angle", name(LOAD_CONSTANT), name(LOAD_RATE));
        }
        Load::Air { .. } => language.air,
    };
    let from = name(LOAD_FROM);
    let beyond = match load {
        Load::Air { stiffening, .. } if *stiffening < 0.0 => format!("angle < {from}"),
        _ => format!("angle > {from}"),
    };
    let values = [
        ("id", id.to_owned()),
        ("gravity", name(LOAD_GRAVITY)),
        ("radians", name(LOAD_RADIANS)),
        ("constant", name(LOAD_CONSTANT)),
        ("stiffening", name(LOAD_STIFFENING)),
        ("beyond", beyond),
        ("from", from),
    ];
    fill(template, &values)
}
