//! A drive that stands for a limit of the speed, in a program that has none.
//!
//! A drive A+ against the motor's damping B has the top speed A+/B, to which the speed comes in 1/B. Below its limit such a drive is that of the loop,
//! whatever B is: the loop has c - B of the damping, which a B beyond c makes negative.

use super::subject::ServoExport;
use super::trial_command::Trial;
use servoid_identification::servo_model::DriveLimit;

/// Each damping that is tried is this part of the last.
const FACTOR: f64 = 0.9;

/// Shares of the damping of the loop: with the least the speed comes to its limit too late for any servo, with the largest in 1 to 2 ms. A
/// servo whose acceleration has a limit, too, is between.
pub(super) const SHARES: (f64, f64) = (0.1, 16.0);

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
        at_one_stiffness: false,
    };
    let staircase = trial.only_staircase();
    let exact = staircase.exact(servo);
    let most = SHARES.1 * servo.damping;
    let dampings = std::iter::successors(Some(most), |damping| Some(FACTOR * damping));
    let tried = dampings
        .take_while(|damping| *damping >= SHARES.0 * servo.damping)
        .map(|damping| {
            let drive = of_damping(damping);
            let positions = respond(drive, &staircase);
            (staircase.root_mean_square(&positions, &exact), drive)
        });
    let closest = tried.min_by(|a, b| a.0.total_cmp(&b.0));
    closest.map(|(_, drive)| drive)
}
