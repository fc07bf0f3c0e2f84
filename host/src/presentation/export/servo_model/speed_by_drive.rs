//! A drive that stands for a limit of the speed, in a program that has none.
//!
//! A drive A+ against the motor's damping B has the top speed A+/B, to which the speed comes by and by. The larger B is, the sooner.

use super::subject::ServoExport;
use super::trial_command::Trial;
use servoid_identification::servo_model::DriveLimit;

/// Each damping that is tried is this part of the last.
const FACTOR: f64 = 0.9;

/// Beyond a tenth of the damping of the loop the speed comes to its limit too late for any servo.
const LEAST_SHARE: f64 = 0.1;

/// The drive that, in place of the speed limit of the servo, gives the least mean square of the difference from it in the strokes of the
/// staircase; the drive of the servo itself, where its speed has no limit. `respond` has the positions of a drive.
pub(super) fn closest_drive(
    export: &ServoExport<'_>,
    trial: &Trial,
    respond: impl Fn(DriveLimit<f64>, &Trial) -> Vec<f64>,
) -> Option<DriveLimit<f64>> {
    let servo = &export.parameters;
    let Some(speed) = servo.speed_limit else {
        return servo.drive_limit();
    };
    let of_damping = |motor_damping: f64| DriveLimit {
        up: motor_damping * speed.up,
        down_to_up: speed.down_to_up,
        motor_damping,
    };
    let staircase = trial.only_staircase();
    let exact = staircase.exact(servo);
    let dampings = std::iter::successors(Some(servo.damping), |damping| Some(FACTOR * damping));
    let tried = dampings
        .take_while(|damping| *damping >= LEAST_SHARE * servo.damping)
        .map(|damping| {
            let drive = of_damping(damping);
            let positions = respond(drive, &staircase);
            (staircase.root_mean_square(&positions, &exact), drive)
        });
    let closest = tried.min_by(|a, b| a.0.total_cmp(&b.0));
    closest.map(|(_, drive)| drive)
}
