//! How far an exported servo is from the servo model.

use super::subject::ServoExport;
use super::trial_command::Trial;
use servoid_dynamics::ServoParameters;

/// Of a file, under a command.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Difference {
    /// The command.
    pub trial: Trial,
    /// The largest difference of the position \[unit of the position\].
    pub largest: f64,
    /// The largest in strokes that are held or broken off once, those of the staircase and that of the search, likewise.
    pub largest_in_strokes: f64,
    /// Its root mean square, likewise.
    pub root_mean_square: f64,
    /// Whether the file is closer to the servo in the staircase than one that stands still, in the mean of squares.
    pub follows: bool,
    /// The largest from a servo that has the load and the stops that the export has, where it leaves some out, and what these are.
    pub without_others: Option<(f64, &'static str)>,
}

impl Difference {
    /// Of the positions at the beginning of each step that `found` has beside a servo, by a target that has load and stops of `like`.
    pub fn of(
        export: &ServoExport<'_>,
        trial: Trial,
        found: impl Fn(&ServoParameters) -> Vec<f64>,
        like: &ServoParameters,
    ) -> Self {
        let servo = &export.parameters;
        let (positions, exact) = (found(servo), trial.exact(servo));
        let from_like = || trial.largest_difference(&found(like), &trial.exact(like));
        let [strokes, exact_strokes] = [&positions, &exact].map(|course| trial.staircase(course));
        let [once, exact_once] = [&positions, &exact].map(|course| trial.broken_off(course));
        let still = vec![servo.resting_output(trial.middle()); exact_strokes.len()];
        Self {
            follows: trial.root_mean_square(strokes, exact_strokes)
                < trial.root_mean_square(&still, exact_strokes),
            largest: trial.largest_difference(&positions, &exact),
            largest_in_strokes: f64::max(
                trial.largest_difference(strokes, exact_strokes),
                trial.largest_difference(once, exact_once),
            ),
            root_mean_square: trial.root_mean_square(&positions, &exact),
            without_others: others(servo, like).map(|others| (from_like(), others)),
            trial,
        }
    }
}

/// What of load and stops `servo` has and `like` has not.
fn others(servo: &ServoParameters, like: &ServoParameters) -> Option<&'static str> {
    match (servo.load != like.load, servo.stops != like.stops) {
        (false, false) => None,
        (true, false) => Some("the load that is left out"),
        (false, true) => Some("the stops that are left out"),
        (true, true) => Some("the load and the stops that are left out"),
    }
}
