//! A servo model with the facts that its exports state.

use super::recorded_range::recorded;
use crate::data::model_file::ServoModelDocument;
use crate::data::model_metadata::ModelMetadata;
use crate::data::unitless_command::UnitlessCommand;
use crate::data::units::radians_of;
use crate::presentation::export::error::ExportError;
use servoid_identification::results::Model;
use servoid_identification::servo_model::{
    AtRest, Coordinate, DriveLimit, Friction, Load, ServoModel, ServoParameters, SpeedLimit,
};

/// Longest delay that a servo may have \[s\]: files keep the commands of that time.
const LONGEST_DELAY_S: f64 = 10.0;

/// The lowest top speed as a share of that without friction and load: where these stop the servo a rate of zero would mean that
/// there is no limit.
const SLOWEST: f64 = 0.001;

/// What no drive and no angle reaches; single precision can still multiply it.
pub(super) const NO_LIMIT: f64 = 1e30;

/// What may be chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ServoExportOptions {
    /// The controller, as the recordings call it; needed where the model has several.
    pub controller: Option<f64>,
    /// The step of the exported servo \[s\]; without it, one that suits servo and target.
    pub step_s: Option<f64>,
    /// The command that fully deflects a servo of ArduPilot; without it, one that the unit of the command suggests.
    pub full_command: Option<f64>,
}

/// A servo model with one controller, ready to be written.
#[derive(Clone, Debug)]
pub struct ServoExport<'a> {
    /// Name of the servo; any text.
    pub name: &'a str,
    /// Origin of the model; any text.
    pub source: &'a str,
    /// The model.
    pub model: &'a ServoModel,
    /// Units, and the pulse frame, where they are known.
    pub metadata: &'a ModelMetadata,
    /// The number of the chosen controller, from 0.
    pub(super) controller: usize,
    /// The parameters with the chosen controller.
    pub(super) parameters: ServoParameters,
    pub(super) options: ServoExportOptions,
    /// What is known of the sensor's scale, which no interval contains.
    pub(super) of_sensor: Vec<&'a str>,
}

impl<'a> ServoExport<'a> {
    /// Chooses the controller.
    ///
    /// # Errors
    /// There are several controllers and none is chosen, or the model does not have the chosen one.
    pub fn new(
        name: &'a str,
        source: &'a str,
        document: &'a ServoModelDocument,
        metadata: &'a ModelMetadata,
        options: ServoExportOptions,
    ) -> Result<Self, ExportError> {
        let names = &document.controller_names;
        let controller = match options.controller {
            Some(wanted) => {
                let found = names.iter().position(|name| *name == wanted);
                found.ok_or_else(|| ExportError::UnknownController {
                    wanted,
                    known: names.clone(),
                })?
            }
            None if document.model.controllers > 1 => {
                return Err(ExportError::ControllerNotChosen {
                    known: names.clone(),
                });
            }
            None => 0,
        };
        possible_numbers(&document.model)?;
        let parameters = document.model.parameters(controller);
        if !is_possible(&parameters) {
            return Err(ExportError::Impossible);
        }
        Ok(Self {
            name,
            source,
            model: &document.model,
            metadata,
            controller,
            parameters,
            options,
            of_sensor: Vec::new(),
        })
    }

    /// The same, which knows what the linear model of the recording says of the sensor's scale: that bears on gain and speeds of both.
    #[must_use]
    pub fn beside(self, linear: &'a Model) -> Self {
        let advice = linear.advice.iter();
        let of_sensor = advice.filter(|found| found.is_of_sensor_scale());
        Self {
            of_sensor: of_sensor.map(|found| found.finding.as_str()).collect(),
            ..self
        }
    }

    /// The frame that holds a command \[s\]: 0 where there is none, or none is known.
    pub(super) fn frame_s(&self) -> f64 {
        self.metadata.pulse_frame_s.unwrap_or(0.0)
    }

    /// Radians for each unit of the position, for programs whose servos turn by angles.
    ///
    /// # Errors
    /// Neither command nor position is an angle.
    pub(super) fn radians_per_position(&self) -> Result<f64, ExportError> {
        let units = self.metadata.units();
        let position = units.output.or(units.input);
        match (radians_of(position), position) {
            (Some(radians), _) => Ok(radians),
            (None, None) => Ok(self.model.radians_per_command),
            (None, Some(_)) => Ok(self.radians_per_unit()? / self.parameters.gain.abs()),
        }
    }

    /// What is made of a command without a unit; `None` where it has one.
    pub(super) fn unitless(&self) -> Option<UnitlessCommand> {
        UnitlessCommand::of(self.metadata.units(), self.model)
    }

    /// Radians for each unit of θ, where the command, or the position, is an angle.
    ///
    /// # Errors
    /// Neither command nor position is an angle.
    pub(super) fn radians_per_unit(&self) -> Result<f64, ExportError> {
        let units = self.metadata.units();
        let gain = self.parameters.gain.abs();
        let by_position = || radians_of(units.output).map(|radians| gain * radians);
        let radians = match (radians_of(units.input).or_else(by_position), units.input) {
            (Some(radians), _) => radians,
            (None, None) => self.model.radians_per_command,
            (None, Some(unit)) => return Err(ExportError::NotAnAngle(unit.to_owned())),
        };
        match radians.is_finite() && radians > 0.0 {
            true => Ok(radians),
            false => Err(ExportError::Impossible),
        }
    }

    /// The load of a program whose load is the same at all angles \[acceleration\]: of a spring and of one of the air, its mean over the recorded range. The
    /// constant part alone may be many times as large, where θ = 0, or the angle from which it stiffens, is far outside of that range.
    pub(super) fn constant_load(&self) -> f64 {
        match self.parameters.load {
            Load::None | Load::Pendulum { .. } => 0.0,
            Load::Constant(constant) => constant,
            Load::Spring { constant, rate } => {
                constant + rate * recorded(self.model, &self.parameters).0
            }
            Load::Air {
                constant,
                stiffening,
                from,
            } => constant + self.mean_stiffening(stiffening, from),
        }
    }

    /// The mean of a load that is `stiffening` times the square of the distance beyond `from`, over the recorded range.
    fn mean_stiffening(&self, stiffening: f64, from: f64) -> f64 {
        let (middle, most) = recorded(self.model, &self.parameters);
        let way = if stiffening < 0.0 { -1.0 } else { 1.0 };
        let cube = |end: f64| (way * (middle + end - from)).max(0.0).powi(3);
        stiffening * way * (cube(most) - cube(-most)) / (6.0 * most)
    }

    /// The same as the whole load.
    pub(super) fn only_constant_load(&self) -> Load<f64> {
        match self.constant_load() {
            0.0 => Load::None,
            constant => Load::Constant(constant),
        }
    }

    /// The same servo in terms of which a spring is part of the loop, which is softer or stiffer by it: so it is at small signals. Full drive works against
    /// the spring's mean over the recorded range.
    pub(super) fn with_spring_in_loop(&self) -> Self {
        let p = self.parameters;
        let Load::Spring { rate, .. } = p.load else {
            return self.clone();
        };
        let stiffness = p.stiffness + rate;
        let share = p.stiffness / stiffness;
        let middle = recorded(self.model, &p).0;
        // About the middle θ'' counts share times as much, under the same command.
        let parameters = ServoParameters {
            stiffness,
            gain: p.gain * share,
            offset: p.offset + p.gain * middle * (1.0 - share),
            limit: p.limit.map(|limit| DriveLimit {
                up: limit.up / share,
                ..limit
            }),
            speed_limit: p.speed_limit.map(|limit| SpeedLimit {
                up: limit.up / share,
                ..limit
            }),
            friction: p.friction.map(|friction| Friction {
                coulomb: friction.coulomb / share,
                at_rest: friction.at_rest.map(|at_rest| AtRest {
                    speed: at_rest.speed / share,
                    ..at_rest
                }),
                ..friction
            }),
            load: Load::Constant(self.constant_load() / share),
            play: p.play.map(|width| width / share),
            ..p
        };
        Self {
            parameters,
            ..self.clone()
        }
    }

    /// The load of a program that has a constant one, and a loop that may have the spring in it.
    pub(super) fn load_of_loop(&self) -> Load<f64> {
        match self.parameters.load {
            spring @ Load::Spring { .. } => spring,
            _ => self.only_constant_load(),
        }
    }

    /// The parameters with this load in place of their own.
    pub(super) fn parameters_with(&self, load: Load<f64>) -> ServoParameters {
        ServoParameters {
            load,
            ..self.parameters
        }
    }

    /// The least and the largest theta that the stops leave \[units of the command\], -[`NO_LIMIT`] and [`NO_LIMIT`] without.
    pub(super) fn stops(&self) -> [f64; 2] {
        let range = self.parameters.range();
        range.map(|end| end.clamp(-NO_LIMIT, NO_LIMIT))
    }

    /// The least and the largest speed at which that of theta is cut off \[units of the command/s\], -[`NO_LIMIT`] and [`NO_LIMIT`] without.
    pub(super) fn speed_limits(&self) -> [f64; 2] {
        let limit = self.parameters.speed_limit;
        let [up, down] = limit.map_or([NO_LIMIT; 2], |limit| limit.both_ways());
        [-down, up]
    }

    /// The speeds towards larger and smaller theta at which full drive, damping, friction and the constant load balance, or which are cut off
    /// \[units of the command/s\]; `None` without a limit.
    pub(super) fn top_speeds(&self) -> Option<(f64, f64)> {
        let slowest = SLOWEST * self.parameters.free_speed()?;
        let speeds = self.parameters.top_speeds(self.constant_load())?;
        let [up, down] = speeds.map(|speed| speed.max(slowest));
        Some((up, down))
    }
}

/// Refuses the first number of a model that no servo has, by its name in the model file.
fn possible_numbers(model: &ServoModel) -> Result<(), ExportError> {
    let numbers = model.coordinates.iter().zip(&model.values);
    for (coordinate, value) in numbers {
        let (name, is_possible, possible) = match coordinate {
            Coordinate::Delay => (
                "delay",
                (0.0..=LONGEST_DELAY_S).contains(value),
                "0 to 10 s",
            ),
            Coordinate::DeadBand => ("dead_band", *value >= 0.0, "0 or more"),
            Coordinate::Play => ("play", *value >= 0.0, "0 or more"),
            Coordinate::Friction => ("friction", *value >= 0.0, "0 or more"),
            Coordinate::FrictionAtRest => ("friction_at_rest", *value >= 0.0, "0 or more"),
            Coordinate::FrictionOfGears => (
                "friction_of_gears",
                (0.0..1.0).contains(value),
                "0 or more, and less than 1",
            ),
            Coordinate::MotorShare => ("motor_share", *value > 0.0, "more than 0"),
            Coordinate::Gain => ("gain", *value != 0.0, "other than 0"),
            _ => continue,
        };
        if !is_possible {
            return Err(ExportError::ImpossibleNumber {
                name,
                value: *value,
                possible,
            });
        }
    }
    Ok(())
}

/// Whether a servo can be computed: a model file may say anything.
fn is_possible(servo: &ServoParameters) -> bool {
    let positive = |value: f64| value.is_finite() && value > 0.0;
    let not_negative = |value: f64| value.is_finite() && value >= 0.0;
    let limit = servo.limit.is_none_or(|limit| {
        let of_motor = positive(limit.down_to_up) && positive(limit.motor_damping);
        positive(limit.up) && (of_motor || servo.speed_limit.is_some())
    });
    let speed_limit =
        (servo.speed_limit).is_none_or(|limit| positive(limit.up) && positive(limit.down_to_up));
    let friction = servo.friction.is_none_or(|friction| {
        let at_rest = friction
            .at_rest
            .is_none_or(|at_rest| not_negative(at_rest.excess) && positive(at_rest.speed));
        not_negative(friction.coulomb) && (0.0..1.0).contains(&friction.of_gears) && at_rest
    });
    (0.0..=LONGEST_DELAY_S).contains(&servo.delay_s)
        && positive(servo.stiffness)
        && positive(servo.damping)
        && positive(servo.gain.abs())
        && (servo.offset / servo.gain).is_finite()
        && not_negative(servo.dead_band.unwrap_or(0.0))
        && not_negative(servo.play.unwrap_or(0.0))
        && servo.stops.have_travel()
        && limit
        && speed_limit
        && friction
        && servo.holding_command(0.0).is_finite()
}
