//! A joint with a position actuator in MuJoCo's MJCF.
//!
//! The actuator's force kp (ctrl - q) - kv q' within its range is the drive of the equation; the joint has the motor's damping and the
//! friction. Its inertia is one, since accelerations are known per unit of inertia.

use super::delay_in_steps::{delay_in_words, rounded_delay, to_nanoseconds};
use super::difference::Difference;
use super::exported::ExportedServo;
use super::fixed_step::step_s;
use super::load_mass::{GRAVITY, Turn, Weight};
use super::recorded_range::recorded;
use super::smooth_command::SmoothCommand;
use super::speed_by_drive::{SHARES, closest_drive};
use super::statement::{Comparison, Frame, line};
use super::subject::ServoExport;
use super::terms::Term;
use super::trial_command::Trial;
use super::worst_command::with_worst;
use crate::presentation::export::emulation::DelayLine;
use crate::presentation::export::error::ExportError;
use crate::presentation::export::target::Target;
use crate::presentation::export::text::{XML_STYLE, identifier, number};
use crate::presentation::summary::four_digits;
use crate::presentation::template::fill;
use servoid_identification::servo_model::{DriveLimit, Load};

/// Impedance of the constraint that holds the joint by friction: the largest that MuJoCo takes, so that it hardly creeps.
const IMPEDANCE: f64 = 0.9999;

/// Time constant of that constraint in steps: the shortest that MuJoCo takes.
const TIME_CONSTANT: f64 = 2.0;

/// MuJoCo takes a positive damping of a general actuator for a damping ratio where its two stiffnesses are equal: so much apart they are not.
const NO_RATIO: f64 = 1e-6;

/// An angle that no servo reaches \[rad\], for the end that has no stop.
const TURNS: f64 = 1e3;

/// What position actuator and joint have not.
const LEFT_OUT: [Term; 8] = [
    Term::SpeedLimit,
    Term::WeakerLoopDownwards,
    Term::DeadBand,
    Term::Play,
    Term::FrictionOfGears,
    Term::FrictionAtRest,
    Term::ChangeOfLoadOfAir,
    Term::PulseEnd,
];

/// The numbers of joint and actuator. The joint's angle is the position in rad.
struct Joint {
    /// Of the position actuator.
    kp: f64,
    kv: f64,
    /// Largest drive towards larger and smaller angles, which theta turns against where the gain is negative.
    range: Option<(f64, f64)>,
    /// Of the joint.
    damping: f64,
    frictionloss: f64,
    /// Force of the second actuator.
    load: f64,
    /// The angles of the stops, infinite without.
    stops: [f64; 2],
    delay_steps: usize,
    step_s: f64,
    weight: Weight,
    /// Torque of a spring for each rad of theta that the joint has turned.
    spring: f64,
    /// The joint's angle at theta = 0.
    at_zero: f64,
}

impl Joint {
    /// With this drive, that of the servo or the one that stands for its limit of the speed.
    fn of(
        export: &ServoExport<'_>,
        step_s: f64,
        radians: f64,
        limit: Option<DriveLimit<f64>>,
    ) -> Self {
        let p = &export.parameters;
        let turn = turn(export, radians);
        let size = turn.each.abs();
        let damping = limit.map_or(0.0, |limit| limit.motor_damping);
        Self {
            kp: p.stiffness,
            kv: p.damping - damping,
            range: limit.map(|limit| {
                let drives = p.upwards_first(limit.both_ways());
                let [up, down] = drives.map(|drive| size * drive);
                (up, down)
            }),
            damping,
            frictionloss: p.friction.map_or(0.0, |friction| size * friction.coulomb),
            load: turn.each
                * match p.load {
                    Load::Spring { constant, .. } => constant,
                    _ => export.constant_load(),
                },
            spring: match p.load {
                Load::Spring { rate, .. } => rate,
                _ => 0.0,
            },
            at_zero: turn.at_zero,
            stops: [
                radians * p.stops.lower.unwrap_or(f64::NEG_INFINITY),
                radians * p.stops.upper.unwrap_or(f64::INFINITY),
            ],
            // The angle after a step has the speed at the end of the step: it is early by half a step.
            delay_steps: (p.delay_s.max(0.0) / step_s + 1.0).floor() as usize,
            step_s,
            weight: Weight::of(&p.load, turn, recorded(export.model, p)),
        }
    }

    /// By how much the angle is late \[s\]: by its whole steps, and half a step less.
    fn late_s(&self) -> f64 {
        to_nanoseconds((self.delay_steps as f64 - 0.5) * self.step_s)
    }

    /// The angle at the beginning of each step, as MuJoCo's integrator `implicitfast` computes it, from rest at the angle
    /// `rest`, for these values of ctrl.
    fn respond(&self, controls: &[f64], rest: f64) -> Vec<f64> {
        let first = controls.first().copied().unwrap_or(0.0);
        let (mut angle, mut speed) = (rest, 0.0);
        let mut late = DelayLine::new(self.delay_steps, first);
        let mut angles = Vec::with_capacity(controls.len());
        for control in controls {
            angles.push(angle);
            let wanted = self.kp * (late.pass(*control) - angle) - self.kv * speed;
            let drive = match self.range {
                Some((up, down)) => wanted.clamp(-down, up),
                None => wanted,
            };
            let load = self.load + self.spring * (angle - self.at_zero) + self.weight.at(angle);
            let free = drive - self.damping * speed - load;
            let rubbed = self.with_friction(free, speed);
            let acceleration = rubbed + self.by_stop(angle, speed, rubbed);
            // A drive at its limit does not depend on the speed.
            let by_speed = self.damping + if drive == wanted { self.kv } else { 0.0 };
            speed += self.step_s * acceleration / (1.0 + self.step_s * by_speed);
            angle += self.step_s * speed;
        }
        angles
    }

    /// The values of the template.
    fn values(&self, id: &str) -> Vec<(&'static str, String)> {
        let range = self.range.map(|(up, down)| {
            let (lowest, highest) = (number(-down), number(up));
            format!(" forcerange=\"{lowest} {highest}\"")
        });
        let friction = (self.frictionloss > 0.0).then(|| {
            format!(
                " frictionloss=\"{}\" solreffriction=\"{} 1\" solimpfriction=\"{IMPEDANCE} {IMPEDANCE} 0.001 0.5 2\"",
                number(self.frictionloss),
                number(TIME_CONSTANT * self.step_s)
            )
        });
        let stops = self.stops.iter().any(|end| end.is_finite()).then(|| {
            let [lowest, highest] = self.stops.map(|end| end.clamp(-TURNS, TURNS));
            format!(
                " limited=\"true\" range=\"{} {}\" solreflimit=\"{} 1\" solimplimit=\"{IMPEDANCE} {IMPEDANCE} 0.001 0.5 2\"",
                number(lowest),
                number(highest),
                number(TIME_CONSTANT * self.step_s)
            )
        });
        let load = (self.load != 0.0 || self.spring != 0.0).then(|| {
            let at_angle_0 = self.spring * self.at_zero - self.load;
            let values = [
                ("id", id.to_owned()),
                ("load", number(at_angle_0)),
                ("spring", number(-self.spring)),
            ];
            fill(include_str!("../templates/servo_model/load.mjcf"), &values)
        });
        let (actuator, law) = self.law();
        vec![
            ("id", id.to_owned()),
            ("actuator", actuator.to_owned()),
            ("step", number(self.step_s)),
            ("mass", number(self.weight.mass)),
            ("place", self.weight.place()),
            ("gravity", number(-GRAVITY)),
            ("armature", number(1.0 - self.weight.inertia())),
            ("damping", number(self.damping)),
            ("friction", friction.unwrap_or_default()),
            ("stops", stops.unwrap_or_default()),
            ("law", law),
            ("range", range.unwrap_or_default()),
            // MuJoCo rounds a delay up to whole steps.
            ("delay", number(self.late_s())),
            ("samples", (self.delay_steps + 1).to_string()),
            ("load", load.unwrap_or_default()),
        ]
    }

    /// The element of the actuator and its law. A position actuator has no negative kv; a general one takes any.
    fn law(&self) -> (&'static str, String) {
        let (kp, kv) = (self.kp, self.kv);
        match kv < 0.0 {
            false => (
                "position",
                format!("kp=\"{}\" kv=\"{}\"", number(kp), number(kv)),
            ),
            true => (
                "general",
                format!(
                    "gainprm=\"{}\" biastype=\"affine\" biasprm=\"0 {} {}\"",
                    number(kp),
                    number(-(1.0 + NO_RATIO) * kp),
                    number(-kv)
                ),
            ),
        }
    }

    /// What a stop adds to the acceleration `free`: a soft constraint, too, which pushes the joint back that is beyond.
    fn by_stop(&self, angle: f64, speed: f64, free: f64) -> f64 {
        let [lowest, highest] = self.stops;
        let time_s = IMPEDANCE * TIME_CONSTANT * self.step_s;
        let wanted = |beyond: f64| {
            -IMPEDANCE * (free + 2.0 / time_s * speed + IMPEDANCE * beyond / (time_s * time_s))
        };
        if angle < lowest {
            wanted(angle - lowest).max(0.0)
        } else if angle > highest {
            wanted(angle - highest).min(0.0)
        } else {
            0.0
        }
    }

    /// The acceleration with a soft constraint that opposes the motion by at most `frictionloss`: it would end the motion within
    /// its time constant.
    fn with_friction(&self, free: f64, speed: f64) -> f64 {
        let rate = 2.0 / (IMPEDANCE * TIME_CONSTANT * self.step_s);
        let wanted = -IMPEDANCE * (free + rate * speed);
        free + wanted.clamp(-self.frictionloss, self.frictionloss)
    }
}

/// How the joint, whose angle is the position, turns with theta.
fn turn(export: &ServoExport<'_>, radians: f64) -> Turn {
    let p = &export.parameters;
    Turn {
        at_zero: radians * p.offset,
        each: radians * p.gain,
    }
}

/// The model.
pub(super) fn write(export: &ServoExport<'_>) -> Result<ExportedServo, ExportError> {
    let radians = export.radians_per_position()?;
    let step_s = step_s(export)?;
    let turn = turn(export, radians);
    let servo = &export.parameters;
    let trial = Trial::of(export, step_s, [f64::NEG_INFINITY, f64::INFINITY]);
    let rest = radians * servo.resting_output(trial.middle());
    let positions_of = |joint: &Joint, commands: Vec<f64>| -> Vec<f64> {
        let controls: Vec<f64> = commands.into_iter().map(|u| turn.at(u)).collect();
        let angles = joint.respond(&controls, rest).into_iter();
        angles.map(|angle| angle / radians).collect()
    };
    let drive = closest_drive(export, &trial, |drive, trial| {
        let joint = Joint::of(export, step_s, radians, Some(drive));
        positions_of(&joint, trial.command())
    });
    let joint = Joint::of(export, step_s, radians, drive);
    let positions = |commands: Vec<f64>| positions_of(&joint, commands);
    let trial = with_worst(trial, export, |commands| positions(commands.to_vec()));
    let smooth = SmoothCommand::of(export, &trial, None);
    let found = positions(trial.command());
    let load = match servo.load {
        Load::Pendulum { .. } | Load::Spring { .. } => servo.load,
        _ => export.only_constant_load(),
    };
    let like = export.parameters_with(load);
    let difference = Difference::of(export, trial, |_| found.clone(), &like);
    let control = control(export, turn);
    let mut about = about(export, radians, &control, &difference);
    about.push(format!(
        "Delay: {} MuJoCo rounds what delay says up to whole steps, {} here, and the angle is early by half a step; nsample is one more. They are of a MuJoCo later than 3.9. In an older one leave both out, and delay the command yourself.",
        delay_in_words(export, joint.late_s(), step_s),
        joint.delay_steps
    ));
    about.extend(speed_in_words(export, drive));
    about.push(smooth.in_words(export, &|sine| positions(sine.held())));
    let mut values = joint.values(&identifier(export.name));
    values.push(("about", XML_STYLE.comment(&about)));
    let text = fill(include_str!("../templates/servo_model/servo.mjcf"), &values);
    let remark =
        format!("the joint's angle is the position in rad, and ctrl the command as one: {control}");
    Ok(ExportedServo::new(text, difference)?
        .lacking(export, "MuJoCo", &LEFT_OUT)?
        .with(
            [remark]
                .into_iter()
                .chain(export.without_play_and_dead_band())
                .chain(rounded_delay(export, joint.late_s(), step_s)),
        ))
}

/// What stands for a limit of the speed.
fn speed_in_words(export: &ServoExport<'_>, drive: Option<DriveLimit<f64>>) -> Option<String> {
    let drive = drive.filter(|_| export.parameters.speed_limit.is_some())?;
    let unit = export.command_unit();
    let [up, down] = drive.both_ways().map(four_digits);
    Some(format!(
        "Speed: MuJoCo has no limit of it. Here the speed comes to that against the joint's damping B, in 1/B: B is {} 1/s, A+ {up} {unit}/s^2 and A- {down} {unit}/s^2. Of all B from {} to {} times c, the joint is closest to the servo with that one in the staircase, in the mean of squares.",
        four_digits(drive.motor_damping),
        SHARES.0,
        SHARES.1
    ))
}

/// What ctrl is for a command.
fn control(export: &ServoExport<'_>, turn: Turn) -> String {
    let unit = export.metadata.units().input;
    format!(
        "ctrl = {} times the command{}",
        line(turn.at_zero, turn.each),
        unit.map(|unit| format!(" in {unit}")).unwrap_or_default()
    )
}

/// Where the joint begins: at 0, as all that MuJoCo keeps.
const START: &str = "Start: the joint begins at rest at the position 0, and ctrl is 0 for the delay. To begin at rest elsewhere, set qpos to its angle and fill the delay with ctrl (mj_initCtrlHistory).";

fn about(
    export: &ServoExport<'_>,
    radians: f64,
    control: &str,
    difference: &Difference,
) -> Vec<String> {
    let mut about = export.statement(Target::Mujoco);
    about.extend(export.stops_in_words("the joint, as its range"));
    about.extend([
        START.to_owned(),
        export.frame(Frame::BeforeFile),
        format!(
            "In MuJoCo: the joint's angle is the position in rad, {} for each unit of it. ctrl is the command as such a position: {control}. The actuator is the drive, with kp = k, kv = c - B and the range from -A- to A+ (where B is larger than c it is a general one, with gainprm = k and biasprm = 0, -k, B - c, because a position actuator has no negative kv); the joint has the damping B and the frictionloss C. Range, frictionloss and load act on the joint: they are times the gain in rad.",
            number(radians)
        ),
        "The joint has an inertia of 1 kg m^2, which stands for the unknown one of motor, gears and load. In your mechanism with the inertia J about this joint, armature included, multiply kp, kv (or gainprm and biasprm), forcerange, damping, frictionloss and the load by J. The weight, if there is one, is a mass on an arm as short as a millimetre: your mechanism takes its place.".to_owned(),
        format!(
            "Steps: {} ms each (timestep), for which delay and constraints are computed. For others, export with --step-ms.",
            number(1e3 * difference.trial.step_s)
        ),
        "Numbers: where a command is no number, MuJoCo warns, and all ctrl count as 0 when its step has come out of the delay.".to_owned(),
        export.left_out("MuJoCo's position actuator", &LEFT_OUT),
        export.difference(difference, Comparison::Emulation("MuJoCo")),
    ]);
    about
}
