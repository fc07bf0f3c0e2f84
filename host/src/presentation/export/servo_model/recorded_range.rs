//! The range of the commands in which an export is compared.

use servoid_identification::servo_model::{ServoModel, ServoParameters};

/// Amplitudes that a servo may have in any unit; a model file may say anything.
const POSSIBLE: std::ops::RangeInclusive<f64> = 1e-9..=1e9;

/// The middle of the recorded commands, and half of their range: what is said of a file holds for the largest strokes that the
/// recording had. A file without it, as older ones are, gets the root mean square of the motion about the position 0, and one without that
/// strokes that the drive limits.
pub(super) fn recorded(model: &ServoModel, parameters: &ServoParameters) -> (f64, f64) {
    let fit = &model.fit;
    let middle_of_outputs = -parameters.offset / parameters.gain;
    let (middle, shown) = match model.commands {
        Some(commands) => (commands.middle(), commands.amplitude()),
        None => {
            let output = fit.rmse / (1.0 - fit.simulation_percent / 100.0);
            (middle_of_outputs, output / parameters.gain.abs())
        }
    };
    // A command that friction and dead band swallow would compare two servos that stand still.
    let shown = shown.max(MOVING * held_back(parameters));
    match POSSIBLE.contains(&shown) && middle.is_finite() {
        true => (middle, shown),
        false => (middle_of_outputs, amplitude_without_recording(parameters)),
    }
}

/// One that the drive limits.
fn amplitude_without_recording(parameters: &ServoParameters) -> f64 {
    let limited = parameters
        .limit
        .map(|limit| 4.0 * limit.up / parameters.stiffness);
    limited
        .filter(|amplitude| POSSIBLE.contains(amplitude))
        .unwrap_or(1.0)
}

/// So many times as large as what does not move the servo the amplitude is at least.
pub(super) const MOVING: f64 = 3.0;

/// The error that moves nothing: that which friction at rest holds, the dead band, and half the play.
pub(super) fn held_back(parameters: &ServoParameters) -> f64 {
    parameters.resting_error().unwrap_or(0.0)
        + parameters.dead_band.unwrap_or(0.0)
        + parameters.half_play()
}

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_dynamics::{Friction, Grid, Start, simulate};

    #[test]
    fn friction_and_dead_band_hold_what_they_say() {
        let servo = ServoParameters {
            delay_s: 0.01,
            gain: 20.0,
            dead_band: Some(0.5),
            friction: Some(Friction {
                coulomb: 4500.0,
                of_gears: 0.0,
                at_rest: None,
            }),
            ..ServoParameters::linear(900.0, 60.0)
        };
        assert_eq!(held_back(&servo), 5.5);
        let moved = |command: f64| {
            let grid = Grid::for_stiffness(0.002, 0.0, servo.stiffness);
            let start = Start::at_rest(0.0, Some(0.0));
            let mut last = 0.0;
            simulate(&servo, &grid, &start, &[command; 300], |_, y| last = y);
            last != 0.0
        };
        assert!(!moved(0.99 * held_back(&servo)) && moved(MOVING * held_back(&servo)));
    }
}
