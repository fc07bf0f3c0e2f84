//! Why a model cannot be written for a target.

/// There is no export. The text names the remedy.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExportError {
    /// The target is a ratio of polynomials.
    #[error(
        "a JSBSim actuator of the linear model needs a low-order model of it, and there is none ({reason}): {}",
        in_place_of_low_order(*.servo_model)
    )]
    NoLowOrder {
        /// Why there is none.
        reason: String,
        /// Whether the file has a servo model that predicts.
        servo_model: bool,
    },
    /// The target has no place for a linear model.
    #[error("this target takes a servo model, and not a linear one")]
    NeedsServoModel,
    /// The file has a linear model alone.
    #[error(
        "this model file has no servo model: identify it with 'servoid identify RECORDING.csv --servo-model -o MODEL.json'"
    )]
    NoServoModel,
    /// A table has responses of linear models.
    #[error(
        "a csv table has the responses of the linear model, and a servo model has none that hold for all strokes: leave --servo-model out, or export to c, python, julia or matlab"
    )]
    NoTableOfServoModel,
    /// Several controllers on one mechanism.
    #[error(
        "the servo model has the controllers {}: choose one of them with --controller",
        names(known)
    )]
    ControllerNotChosen {
        /// What they are called.
        known: Vec<f64>,
    },
    /// None of those on the mechanism.
    #[error("{}", unknown_controller(*.wanted, .known))]
    UnknownController {
        /// What was asked for.
        wanted: f64,
        /// What they are called.
        known: Vec<f64>,
    },
    /// The motion would be wrong, or grow without end.
    #[error("{}", step_too_long(*.step_ms, *.longest_ms))]
    StepTooLong {
        /// The chosen one \[ms\].
        step_ms: f64,
        /// The longest one \[ms\].
        longest_ms: f64,
    },
    /// The servos of the target turn by angles.
    #[error(
        "this target has servos that turn by angles, and the command is in {0}: record or convert it in deg or rad, or export to c, python, julia, matlab or jsbsim"
    )]
    NotAnAngle(String),
    /// ArduPilot's output has no unit, and the command has one of its own.
    #[error(
        "the command is in {0}, so that nothing says which one fully deflects a servo of ArduPilot: state it with --full-command"
    )]
    UnknownFullCommand(String),
    /// ArduPilot's output would be -1 or 1 under all of them.
    #[error(
        "no recorded command is within those of ArduPilot's outputs, {least} to {largest}: state another full command with --full-command"
    )]
    BeyondFullCommand {
        /// The command of the output -1.
        least: f64,
        /// That of the output 1.
        largest: f64,
    },
    /// A servo that stands still is closer to the servo model than the file, or its strokes are wrong by twice the largest one.
    #[error(
        "the file would not follow its command: in strokes that are held or broken off once it is up to {percent} % of the largest stroke away from the servo model, and a servo that stands still is hardly farther, {why}"
    )]
    FollowsNothing {
        /// The largest difference in percent of the largest stroke.
        percent: String,
        /// Why, and what to do.
        why: String,
    },
    /// The document has a number that no servo has, such as a draw of a friction that is less than zero.
    #[error(
        "no servo has the {name} {value}, which 'servo_model' of the model file has: it must be {possible}"
    )]
    ImpossibleNumber {
        /// The name of the coordinate.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        possible: &'static str,
    },
    /// The document has numbers that make no servo together.
    #[error(
        "the servo model has numbers beyond what any servo could have: take those that 'servoid identify' wrote"
    )]
    Impossible,
    /// A full command of a servo under pulses that is a pulse itself.
    #[error(
        "--full-command {0} is counted from 1500 us, where the command is in us: 500 stands for a pulse of 2000 us, and is taken without the option"
    )]
    FullCommandIsPulse(f64),
    /// The positions of the file grow beyond all numbers.
    #[error("the motion of this file has no end: export it with a shorter --step-ms")]
    Endless,
}

/// What to do without a low-order model.
fn in_place_of_low_order(servo_model: bool) -> &'static str {
    match servo_model {
        true => "take the servo model of the same file, which needs none, with --servo-model",
        false => {
            "export to c or csv, identify with --servo-model and export that, or record larger steps"
        }
    }
}

/// Why, and which shorter steps make up one of these.
fn step_too_long(step_ms: f64, longest_ms: f64) -> String {
    let parts = (step_ms / longest_ms).ceil();
    format!(
        "a step of {step_ms} ms is too long for this servo, whose motion would be wrong by percents of a stroke: --step-ms can be {} at the most. Export with --step-ms {}, and take {parts} such steps in each of yours",
        (longest_ms * 1e3).floor() / 1e3,
        (step_ms / parts * 1e7).round() / 1e7
    )
}

fn names(known: &[f64]) -> String {
    let names: Vec<String> = known.iter().map(f64::to_string).collect();
    names.join(", ")
}

fn unknown_controller(wanted: f64, known: &[f64]) -> String {
    match known.is_empty() {
        true => {
            "the servo model has one controller without a name: leave --controller out".to_owned()
        }
        false => format!(
            "the controller {wanted} is none of those of the servo model ({}): choose one of them with --controller",
            names(known)
        ),
    }
}
