//! Simulated servos by name, and those that a model file keeps.
//!
//! A rig commands degrees and reads degrees: 10 µs of the pulse are one degree, and the neutral pulse is 0. A servo model has the
//! units of its record. Degrees and radians become degrees; a command in µs is the pulse itself. A command without a unit is a part of a full one,
//! where the output is an angle; where a record had no units at all, it is the angle that identification took it for, and so is the output.

use crate::data::model_file::{ModelFile, ModelFileError};
use crate::data::model_metadata::unit_meant;
use crate::data::unitless_command::{FULL_US, UnitlessCommand};
use crate::data::units::Units;
use servoid_identification::results::{Noise, six_digits, with_unit};
use servoid_identification::servo_model::ServoModel;
use servoid_protocol::{PulseTrain, PulseWidth};
use servoid_simulator::{
    MachineParameters, NoiseKind, OptionsError, RANGE_DEG, SERVO_SCALE, ServoKind,
    SimulationOptions,
};
use std::path::{Path, PathBuf};

/// Why there is no such simulated servo. The text names the remedy.
#[derive(Debug, thiserror::Error)]
pub enum SimulatedServoError {
    /// It is neither a name nor a model file.
    #[error(
        "there is no simulated servo `{0}`: choose bench, aircraft or linear, or the file of a servo model, which ends in .json"
    )]
    Unknown(String),
    /// The options are wrong.
    #[error(transparent)]
    Options(#[from] OptionsError),
    /// The seed stands in the text of the servo, and beside it.
    #[error("the seed is given twice, in `{servo}` and as {seed} beside it: leave one of them out")]
    TwoSeeds {
        /// The text of the servo.
        servo: String,
        /// The other seed.
        seed: u64,
    },
    /// A controller was named of a servo that is no model.
    #[error(
        "the servo `{0}` has no controllers to choose from: only a servo model may have several"
    )]
    NoControllers(String),
    /// The model cannot be read.
    #[error(transparent)]
    Model(#[from] ModelFileError),
    /// The model is linear alone.
    #[error(
        "the model {0:?} has no servo model, which alone can be simulated: identify with --servo-model"
    )]
    NoServoModel(PathBuf),
    /// Its units are not those of a rig.
    #[error(
        "the {what} of {path:?} is in {unit}, and a rig commands and reads angles: identify a recording with the {what} in degrees"
    )]
    NotAnAngle {
        /// The model.
        path: PathBuf,
        /// Command or position.
        what: &'static str,
        /// Its unit.
        unit: String,
    },
    /// It has several controllers, and none of them was named.
    #[error("the servo model in {path:?} has the controllers {known}: choose one with {option}")]
    WhichController {
        /// The model.
        path: PathBuf,
        /// Their names.
        known: String,
        /// How to choose.
        option: &'static str,
    },
    /// A controller was named that it does not have.
    #[error("the servo model in {path:?} has no controller {controller}{known}")]
    NoSuchController {
        /// The model.
        path: PathBuf,
        /// The name.
        controller: String,
        /// What it has.
        known: String,
    },
    /// It rests where the sensor of a simulated rig does not reach.
    #[error(
        "the servo model in {path:?} rests at {rest_deg:.1} degrees at neutral, and the sensor of a simulated rig shows {RANGE_DEG} degrees to each side of 0: \
         subtract {rest} from the column of the position, so that neutral is 0, and identify again"
    )]
    OutOfSight {
        /// The model.
        path: PathBuf,
        /// Where it rests (deg).
        rest_deg: f64,
        /// The same in the unit of its position, with that.
        rest: String,
    },
    /// It cannot be simulated.
    #[error("the servo model in {0:?} cannot be simulated: its {1}")]
    NotSimulated(PathBuf, String),
}

/// The key that chooses one of several controllers.
const CONTROLLER: &str = "controller=";

/// The options of the simulated rig that a text after `sim:` describes: `SERVO?KEY=VALUE&...`, where SERVO is the name of a
/// servo, or a model file that ends in `.json`. The key `controller` chooses one of several controllers of the model.
///
/// # Errors
/// [`SimulatedServoError`].
pub fn options(text: &str) -> Result<SimulationOptions, SimulatedServoError> {
    let (servo, keys) = text.split_once('?').unwrap_or((text, ""));
    let path = Path::new(servo);
    let (chosen, others): (Vec<&str>, Vec<&str>) =
        keys.split('&').partition(|key| key.starts_with(CONTROLLER));
    if path.extension().is_none_or(|ending| ending != "json") {
        if !chosen.is_empty() {
            return Err(SimulatedServoError::NoControllers(servo.to_owned()));
        }
        return text.parse().map_err(|error| match error {
            OptionsError::UnknownServo(name) => SimulatedServoError::Unknown(name),
            other => other.into(),
        });
    }
    let controller = chosen.first().and_then(|key| key.strip_prefix(CONTROLLER));
    let parameters = machine(path, controller)?;
    let options = SimulationOptions::with_keys(ServoKind::Machine(parameters), &others.join("&"));
    options.map_err(|error| match error {
        OptionsError::OutOfRange(what, expected) => {
            SimulatedServoError::NotSimulated(path.to_owned(), format!("{what} must be {expected}"))
        }
        other => other.into(),
    })
}

/// The text of a servo, with the controller that is chosen of a model's several.
#[must_use]
pub fn with_controller(servo: &str, controller: Option<f64>) -> String {
    let keys = if servo.contains('?') { '&' } else { '?' };
    controller.map_or_else(
        || servo.to_owned(),
        |name| format!("{servo}{keys}{CONTROLLER}{name}"),
    )
}

/// What to say before the servo that `text` describes is simulated: that its model does not predict the recording it comes from, or else that it has no
/// intervals. `None` of one that has both, and of a servo that is no model.
#[must_use]
pub fn caution(text: &str) -> Option<String> {
    let path = Path::new(text.split('?').next()?);
    let found = ModelFile::read(path).ok()?.servo_model().ok()??;
    let percent = found.model.prediction_percent();
    let shown = path.display();
    if !found.model.predicts() {
        return Some(format!(
            "the servo model of {shown} predicts the recording that it comes from to {percent:.1} % only: what is simulated by it is not that servo"
        ));
    }
    let reason = found.model.covariance.withdrawn()?;
    Some(format!(
        "the servo model of {shown} has no intervals, because {}: how far it is from that servo is not known",
        reason.because()
    ))
}

/// What 1 is taken for in the command of the model that `text` describes, where its unit is not known.
#[must_use]
pub fn taken_for(text: &str) -> Option<String> {
    let path = Path::new(text.split('?').next()?);
    let file = ModelFile::read(path).ok()?;
    let model = file.servo_model().ok()??.model;
    let taken = match UnitlessCommand::of(file.metadata.units(), &model)? {
        UnitlessCommand::PulseWidth => "a pulse of 1 us".to_owned(),
        UnitlessCommand::PartOfFull => format!(
            "a full command, a pulse {FULL_US} us from the neutral one, which is {} degrees of a rig",
            FULL_US / SERVO_SCALE.us_per_degree
        ),
        UnitlessCommand::Radians => "1 rad".to_owned(),
        UnitlessCommand::Degrees => "1 degree".to_owned(),
    };
    let shown = path.display();
    Some(format!(
        "the command of {shown} has no unit: 1 is taken for {taken}"
    ))
}

/// What the recording of the model in the file `text` names leaves open: the servo has one value of it among many. Empty of a servo that is no model.
#[must_use]
pub fn left_open(text: &str) -> Vec<String> {
    let found = model_of(text)
        .map(|model| model.quantities)
        .unwrap_or_default();
    let open = found.into_iter().filter(|quantity| !quantity.determined);
    open.map(|quantity| quantity.name).collect()
}

/// The servo model in the file that `text` names; `None` of another servo.
fn model_of(text: &str) -> Option<ServoModel> {
    let path = Path::new(text.split('?').next()?);
    Some(ModelFile::read(path).ok()?.servo_model().ok()??.model)
}

/// The noise of the recording that the model in the file `text` names comes from (deg), for a rig of this sampling; `None` of a servo that is no
/// model, and where `options` choose a noise of their own. Where the recording had another sample period, the noise is white, and as large.
#[must_use]
pub fn noise_of_model(text: &str, options: &SimulationOptions, train: PulseTrain) -> Option<Noise> {
    let ServoKind::Machine(parameters) = &options.servo else {
        return None;
    };
    let found = model_of(text)?;
    if options.noise != NoiseKind::Full {
        return None;
    }
    let same_period = (found.sample_period_s - train.sample_s()).abs() < 1e-9;
    let (ar, sigma) = match same_period {
        true => (found.noise.ar, found.noise.sigma),
        false => (Vec::new(), found.fit.rmse),
    };
    let sigma = sigma * parameters.degrees_per_output;
    Some(Noise { ar, sigma })
}

/// The servo of a model file.
fn machine(
    path: &Path,
    controller: Option<&str>,
) -> Result<MachineParameters, SimulatedServoError> {
    let file = ModelFile::read(path)?;
    let Some(found) = file.servo_model()? else {
        return Err(SimulatedServoError::NoServoModel(path.to_owned()));
    };
    let number = controller_number(path, &found.controller_names, controller)?;
    let scale = Scale::of(path, file.metadata.units(), &found.model)?;
    let parameters = MachineParameters {
        servo: found.model.parameters(number),
        neutral_command: scale.neutral_command,
        command_per_degree: scale.command_per_degree,
        degrees_per_output: scale.degrees_per_output,
    };
    let rest_deg = parameters.rest_deg();
    if rest_deg.abs() > RANGE_DEG {
        let rest = six_digits(rest_deg / scale.degrees_per_output);
        let unit = file.metadata.units().output.unwrap_or_default();
        return Err(SimulatedServoError::OutOfSight {
            path: path.to_owned(),
            rest_deg,
            rest: with_unit(rest, unit),
        });
    }
    Ok(parameters)
}

fn controller_number(
    path: &Path,
    names: &[f64],
    wanted: Option<&str>,
) -> Result<usize, SimulatedServoError> {
    let known: Vec<String> = names.iter().map(f64::to_string).collect();
    let known = known.join(", ");
    let path = path.to_owned();
    match wanted {
        None if names.len() > 1 => Err(SimulatedServoError::WhichController {
            path,
            known,
            option: "--controller, or controller= after the ? of a port",
        }),
        None => Ok(0),
        Some(wanted) => {
            let place = names.iter().position(|name| wanted.parse() == Ok(*name));
            place.ok_or_else(|| SimulatedServoError::NoSuchController {
                path,
                controller: wanted.to_owned(),
                known: match names.is_empty() {
                    true => ": all of its recording had the same, without a name".to_owned(),
                    false => format!(": it has {known}"),
                },
            })
        }
    }
}

/// The units of a model on a rig.
struct Scale {
    neutral_command: f64,
    command_per_degree: f64,
    degrees_per_output: f64,
}

impl Scale {
    fn of(path: &Path, units: Units<'_>, model: &ServoModel) -> Result<Self, SimulatedServoError> {
        let no_angle = |what, unit: &str| SimulatedServoError::NotAnAngle {
            path: path.to_owned(),
            what,
            unit: unit.to_owned(),
        };
        let unitless = UnitlessCommand::of(units, model);
        let pulse = (f64::from(PulseWidth::NEUTRAL.0), SERVO_SCALE.us_per_degree);
        let (neutral_command, command_per_degree) = match units.input.and_then(unit_meant) {
            Some(unit) if unit == "us" => pulse,
            None if unitless == Some(UnitlessCommand::PulseWidth) => pulse,
            None => (0.0, unitless.map_or(1.0, degrees_of).recip()),
            Some(unit) => match degrees(&unit) {
                Some(degrees) => (0.0, degrees.recip()),
                None => return Err(no_angle("command", &unit)),
            },
        };
        let degrees_per_output = match units.output.and_then(unit_meant) {
            None if neutral_command == 0.0 => command_per_degree.recip(),
            None => 1.0,
            Some(unit) => degrees(&unit).ok_or_else(|| no_angle("position", &unit))?,
        };
        Ok(Self {
            neutral_command,
            command_per_degree,
            degrees_per_output,
        })
    }
}

/// What a rig commands for 1 of a command without a unit \[deg\].
fn degrees_of(unitless: UnitlessCommand) -> f64 {
    match unitless {
        UnitlessCommand::PulseWidth => SERVO_SCALE.us_per_degree.recip(),
        UnitlessCommand::PartOfFull => FULL_US / SERVO_SCALE.us_per_degree,
        UnitlessCommand::Radians => 1f64.to_degrees(),
        UnitlessCommand::Degrees => 1.0,
    }
}

/// Degrees in an angle's unit; `None` for what is no angle.
pub(crate) fn degrees(unit: &str) -> Option<f64> {
    match unit {
        "deg" => Some(1.0),
        "rad" => Some(1f64.to_degrees()),
        _ => None,
    }
}
