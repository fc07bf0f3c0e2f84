//! Terms of the equation that a target may not have.

use super::subject::ServoExport;
use crate::presentation::summary::{four_digits, listed_words};
use servoid_identification::servo_model::{Load, ServoParameters};

/// What a target leaves out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Term {
    /// Full drive is an acceleration, and speed builds up.
    FullDrive,
    /// Speed is cut off.
    SpeedLimit,
    /// Speed is limited within the loop, not behind it.
    SpeedInLoop,
    /// Speed in one direction only differs from that in the other.
    TwoSpeeds,
    /// The loop is weaker where the drive is negative.
    WeakerLoopDownwards,
    /// The ratio of damping to stiffness is free.
    DampingRatio,
    DeadBand,
    Play,
    Friction,
    FrictionOfGears,
    FrictionAtRest,
    ConstantLoad,
    Weight,
    /// Beside full drive: the loop has it.
    Spring,
    StiffeningLoad,
    /// The same where its mean is kept.
    ChangeOfLoadOfAir,
    /// The shaft goes no farther.
    Stops,
    /// Where the load changes its sign, it pushes the shaft to the other edge of the dead band.
    JumpOfRests,
    /// Longer pulses act later.
    PulseEnd,
}

impl Term {
    /// What it is called in a list.
    fn name(self) -> &'static str {
        match self {
            Self::FullDrive => "the time in which speed builds up",
            Self::SpeedLimit => "the speed that is cut off",
            Self::SpeedInLoop => "the limit of the speed within the loop, and has one behind it",
            Self::TwoSpeeds => "one of the two speeds",
            Self::WeakerLoopDownwards => "the weaker loop to one side",
            Self::DampingRatio => "the damping ratio",
            Self::DeadBand => "the dead band",
            Self::Play => "the play",
            Self::Friction => "the friction",
            Self::FrictionOfGears => "the friction of the gears",
            Self::FrictionAtRest => "the excess of friction at rest",
            Self::ConstantLoad => "the constant load",
            Self::Weight => "the weight",
            Self::Spring => "the spring at full drive",
            Self::StiffeningLoad => "the load of the air",
            Self::ChangeOfLoadOfAir => "the load of the air, but for its mean",
            Self::Stops => "the stops",
            Self::JumpOfRests => "the jump of the rests where the load changes its sign",
            Self::PulseEnd => "that longer pulses act later",
        }
    }
}

impl ServoExport<'_> {
    /// Those of `terms` that this servo has, in a sentence with their values.
    pub(super) fn left_out(&self, target: &str, terms: &[Term]) -> String {
        let found: Vec<String> = terms
            .iter()
            .filter_map(|term| self.described(*term))
            .collect();
        match found.is_empty() {
            true => format!("Left out: nothing; {target} has all terms of this servo."),
            false => format!(
                "Left out, as {target} cannot express it, in units of the command, which theta has: {}.",
                found.join("; ")
            ),
        }
    }

    /// That a file goes without play and dead band, which count in small motion, however small they are beside the largest stroke.
    pub(super) fn without_play_and_dead_band(&self) -> Vec<String> {
        let unit = self.output_unit();
        let position = |width: f64| four_digits(width * self.parameters.gain.abs());
        let play = self.parameters.play.map(|width| {
            format!(
                "the play of {} {unit} is left out: after each turn the servo stands still until that is crossed, and the file does not",
                position(width)
            )
        });
        let dead_band = self.parameters.dead_band.map(|width| {
            format!(
                "the dead band of {} {unit} to each side is left out: the servo stands still within it, and small motion of the file is earlier and larger",
                position(width)
            )
        });
        play.into_iter().chain(dead_band).collect()
    }

    /// "the full drive, the friction and the stops", of those of `terms` that this servo has.
    pub(super) fn names_of(&self, terms: &[Term]) -> String {
        let names = terms
            .iter()
            .filter(|term| self.described(**term).is_some())
            .map(|term| term.name());
        listed_words(&names.map(str::to_owned).collect::<Vec<_>>())
    }

    /// A term of this servo with its value; `None` where it does not have the term.
    fn described(&self, term: Term) -> Option<String> {
        let p = &self.parameters;
        let command = self.command_unit();
        match term {
            Term::FullDrive => self.full_drive(),
            Term::SpeedLimit => self.speed_limit(),
            Term::SpeedInLoop => p.speed_limit.map(|_| {
                "a limit of the speed within the loop: here it stands behind that, and the servo turns round later".to_owned()
            }),
            Term::TwoSpeeds => self.two_speeds(),
            Term::WeakerLoopDownwards => self.weaker_loop(),
            Term::DampingRatio => {
                let ratio = four_digits(p.damping / (2.0 * p.stiffness.sqrt()));
                Some(format!("the damping ratio of {ratio}"))
            }
            Term::DeadBand => p
                .dead_band
                .map(|width| format!("dead band, {} {command} to each side", four_digits(width))),
            Term::Play => p
                .play
                .map(|width| format!("play, {} {command} from one end to the other", four_digits(width))),
            Term::Friction => p
                .friction
                .map(|friction| format!("friction, {}", self.acceleration(friction.coulomb))),
            Term::FrictionOfGears => {
                let share = self.parameters.friction?.of_gears;
                (share > 0.0).then(|| {
                    let percent = four_digits(100.0 * share);
                    format!("friction of the gears, {percent} % of drive and load together")
                })
            }
            Term::FrictionAtRest => {
                let rest = p.friction?.at_rest?;
                let factor = four_digits(1.0 + rest.excess);
                let speed = four_digits(rest.speed);
                (factor != four_digits(1.0)).then(|| {
                    format!("what friction at rest is beyond that in motion (it is {factor} times that, and falls around {speed} {command}/s)")
                })
            }
            Term::ConstantLoad | Term::Weight | Term::Spring | Term::StiffeningLoad => {
                self.load(term)
            }
            Term::ChangeOfLoadOfAir => self.load(Term::StiffeningLoad).map(|stiffening| {
                let mean = self.acceleration(self.constant_load());
                format!("{stiffening}: here it is the same at all angles, its mean over the recorded range together with its constant part, {mean}")
            }),
            Term::Stops => self.stop_positions(),
            Term::JumpOfRests => {
                let crossing = four_digits(self.model.command_without_load()?);
                let jump = four_digits(2.0 * p.dead_band?);
                Some(format!(
                    "the jump of the rests by {jump} {command}, twice the dead band, where the load changes its sign, under a command of {crossing}: rests to one side of that are off by as much"
                ))
            }
            Term::PulseEnd => p.pulse_end.map(|end| {
                let ms = four_digits(1e3 * end.s_per_command);
                let neutral = four_digits(end.neutral);
                format!("that a pulse acts {ms} ms later for each {command} beyond {neutral}")
            }),
        }
    }

    /// "the stop at 3.979 deg of the position (theta = 3.98 deg)".
    fn stop_positions(&self) -> Option<String> {
        let stops = self.parameters.stops;
        let (command, output) = (self.command_unit(), self.output_unit());
        let at = |(position, theta): (f64, f64)| {
            format!(
                "{} {output} of the position (theta = {} {command})",
                four_digits(position),
                four_digits(theta)
            )
        };
        // The position grows with theta, or falls.
        let [at_lower, at_upper] = self.parameters.upwards_first(self.parameters.range());
        let [lower, upper] = [(stops.lower, at_lower), (stops.upper, at_upper)]
            .map(|(position, theta)| Some((position?, theta)));
        let ends: Vec<String> = [lower, upper].into_iter().flatten().map(at).collect();
        match ends.as_slice() {
            [] => None,
            [one] => Some(format!("the stop at {one}")),
            both => Some(format!("the stops at {}", both.join(" and "))),
        }
    }

    /// Where the servo stops, as a paragraph of a file that has it; `None` without stops. `how` says how the file has it.
    pub(super) fn stops_in_words(&self, how: &str) -> Option<String> {
        let stops = self.stop_positions()?;
        let plural = self.parameters.stops.lower.and(self.parameters.stops.upper);
        let (has, beyond) = match plural {
            Some(_) => ("They are", "Commands beyond both were in the recording."),
            None => (
                "It is",
                "A command beyond was in the recording; where another stop lies, or whether there is one, it does not show.",
            ),
        };
        let open = match self.model.shows_its_stops() {
            true => "",
            false => {
                " Too few commands show it: a load, friction, play or a gain that falls there looks the same."
            }
        };
        Some(format!(
            "Stops: {stops}. {has} part of {how}. {beyond}{open}"
        ))
    }

    fn full_drive(&self) -> Option<String> {
        let command = self.command_unit();
        let limit = self.parameters.drive_limit()?;
        let drives = self.parameters.upwards_first(limit.both_ways());
        let [up, down] = drives.map(four_digits);
        let per_s = four_digits(limit.motor_damping);
        let against = match self.parameters.speed_limit {
            None => format!(", against the motor's damping of {per_s} 1/s"),
            Some(_) => String::new(),
        };
        Some(format!(
            "full drive as an acceleration, {up} {command}/s^2 upwards and {down} downwards{against}: here speed follows at once"
        ))
    }

    fn speed_limit(&self) -> Option<String> {
        let command = self.command_unit();
        let limit = self.parameters.speed_limit?;
        let speeds = self.parameters.upwards_first(limit.both_ways());
        let [up, down] = speeds.map(four_digits);
        let drive = self.parameters.drive_limit().map(|drive| {
            let most = four_digits(drive.up);
            format!(" and full drive as an acceleration of {most} {command}/s^2")
        });
        let drive = drive.unwrap_or_default();
        Some(format!(
            "the limit of the speed, {up} {command}/s upwards and {down} downwards{drive}: here a motor's damping stands for that"
        ))
    }

    fn two_speeds(&self) -> Option<String> {
        let command = self.command_unit();
        let p = &self.parameters;
        let of_speed = p.speed_limit.map(|limit| limit.down_to_up);
        let ratio = of_speed.or_else(|| Some(p.drive_limit()?.down_to_up))?;
        let (larger, smaller) = self.top_speeds().filter(|_| ratio != 1.0)?;
        let [up, down] = p.upwards_first([larger, smaller]).map(four_digits);
        Some(format!(
            "two speeds, {up} {command}/s upwards and {down} downwards: one rate stands for both"
        ))
    }

    fn weaker_loop(&self) -> Option<String> {
        let ratio = self.parameters.drive_limit()?.loop_down_to_up();
        (ratio != 1.0).then(|| {
            let ratio = four_digits(ratio);
            format!(
                "stiffness and damping of the loop that are {ratio} times as large where the drive is negative"
            )
        })
    }

    fn load(&self, term: Term) -> Option<String> {
        let command = self.command_unit();
        match (term, self.parameters.load) {
            (Term::ConstantLoad, Load::Constant(load)) => {
                Some(format!("constant load, {}", self.acceleration(load)))
            }
            (Term::ConstantLoad, Load::Air { constant, .. }) => Some(format!(
                "the constant part of the load, {}",
                self.acceleration(constant)
            )),
            (Term::Weight, Load::Pendulum { gravity, from, .. }) => Some(format!(
                "the weight on the arm, which takes {} with a level arm, and hangs at theta = {} {command}",
                self.acceleration(gravity),
                four_digits(-from)
            )),
            (Term::Spring, Load::Spring { rate, .. }) => Some(format!(
                "the load of a spring at full drive, which grows by {} {command}/s^2 for each {command}, {} % of the stiffness of the loop: here gain and stiffness have it, and full drive is that against its mean",
                four_digits(rate),
                four_digits(100.0 * rate / self.parameters.stiffness)
            )),
            (
                Term::StiffeningLoad,
                Load::Air {
                    stiffening, from, ..
                },
            ) => {
                let beyond = if stiffening > 0.0 { "above" } else { "below" };
                Some(format!(
                    "the load of the air that stiffens {beyond} theta = {} {command}, by {} 1/s^2 for each {command} times the square of the distance",
                    four_digits(from),
                    four_digits(stiffening)
                ))
            }
            _ => None,
        }
    }

    /// An acceleration, and the error at rest that it stands for.
    fn acceleration(&self, acceleration: f64) -> String {
        let command = self.command_unit();
        let without_dead_band = ServoParameters {
            dead_band: None,
            ..self.parameters
        };
        let error = four_digits(without_dead_band.error_of(acceleration));
        let acceleration = four_digits(acceleration);
        format!("{acceleration} {command}/s^2, an error of {error} {command} at rest")
    }

    pub(super) fn command_unit(&self) -> &str {
        self.metadata
            .units()
            .input
            .unwrap_or("units of the command")
    }

    pub(super) fn output_unit(&self) -> &str {
        self.metadata
            .units()
            .output
            .unwrap_or("units of the position")
    }
}
