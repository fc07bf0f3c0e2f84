//! Evidence on whether the errors of a servo model are noise.
//!
//! Noise follows neither the command nor what the equation lacks; score tests show where errors do. And it is there at rest as well as in motion: where
//! the errors one step ahead are larger in motion, the model is wrong there, or its fit lies in a poor minimum. Where
//! nothing of the record is at rest, nothing shows that they are noise.

use super::covariance::Uncertainty;
use super::lack_of_fit;
use crate::diagnostics::one_step_errors;
use crate::numerics::square_about_mean;
use crate::results::Reason;
use crate::servo_model::descent::coordinates::{Coordinate, Point};
use crate::servo_model::stretches::Stretch;
use crate::thresholds::{MOTION_IN_NOISE, MOTION_NOISE_CHANCE, MOTION_NOISE_RATIO, SERVO_LEVELS};

/// What speaks against intervals of `point`.
pub(crate) fn against(stretches: &[Stretch], point: &Point, found: &Uncertainty) -> Option<Reason> {
    if hardly_moves(stretches, found) {
        return Some(Reason::MotionInNoise);
    }
    if levels(stretches) < SERVO_LEVELS {
        return Some(Reason::FewLevels);
    }
    if hides_friction(point, found) {
        return Some(Reason::FrictionUnseen);
    }
    let follow = lack_of_fit::follows_command(stretches, point, found) || found.has_hidden_part;
    if follow {
        return Some(Reason::ErrorsNotNoise);
    }
    if found.at_rest.is_none() {
        return Some(Reason::NeverAtRest);
    }
    grows_with_motion(found).then_some(Reason::ErrorsNotNoise)
}

/// Whether the servo has friction that the record does not show: it hardly moved, and between two strokes any friction fits.
fn hides_friction(point: &Point, found: &Uncertainty) -> bool {
    let mut all = point.coordinates.iter().zip(&found.seen);
    all.any(|(coordinate, seen)| *coordinate == Coordinate::Friction && !seen)
}

/// Whether the motion of the model is lost in the noise: the shaft of a servo that is held has no gain, and neither has a model of it. Its
/// errors are noise all the same.
fn hardly_moves(stretches: &[Stretch], found: &Uncertainty) -> bool {
    let outputs = stretches.iter().flat_map(|stretch| &stretch.output);
    let simulated = found.motion.simulated.iter().flatten();
    let known = outputs
        .zip(simulated)
        .filter(|(y, s)| !(**y * **s).is_nan());
    let (measured, simulated): (Vec<f64>, Vec<f64>) = known.unzip();
    square_about_mean(&simulated) < MOTION_IN_NOISE * square_about_mean(&measured)
}

/// Different commands that the servo was sent to, up to as many as are needed: one that it begins at shows nothing of where it comes to rest.
fn levels(stretches: &[Stretch]) -> usize {
    let mut found: Vec<f64> = Vec::new();
    for stretch in stretches {
        let mut before = stretch.at_rest.or(stretch.input.first().copied());
        for command in &stretch.input {
            let is_sent = before.replace(*command) != Some(*command);
            if is_sent && !found.contains(command) {
                found.push(*command);
            }
            if found.len() == SERVO_LEVELS {
                return SERVO_LEVELS;
            }
        }
    }
    found.len()
}

/// Whether the errors one step ahead are larger in motion than at rest, beyond chance and by more than a little.
fn grows_with_motion(found: &Uncertainty) -> bool {
    let ahead: Vec<f64> = (found.errors().iter())
        .flat_map(|errors| one_step_errors(errors, &found.ar))
        .collect();
    let on = |side: &[Vec<bool>]| {
        let squares: Vec<f64> = (side.iter().flatten().zip(&ahead))
            .filter(|(on_side, error)| **on_side && !error.is_nan())
            .map(|(_, error)| error * error)
            .collect();
        (squares.len() as f64, squares.iter().sum::<f64>())
    };
    let (rest_count, at_rest) = on(&found.motion.at_rest);
    let (moving_count, moving) = on(&found.motion.moving);
    if rest_count == 0.0 || moving_count == 0.0 {
        return true;
    }
    let ratio = (moving / moving_count) / (at_rest / rest_count);
    // The logarithm of a mean of n squares of Gaussian noise has the variance 2/n.
    let chance = MOTION_NOISE_CHANCE * (2.0 / rest_count + 2.0 / moving_count).sqrt();
    ratio.is_nan() || ratio > MOTION_NOISE_RATIO && ratio.ln() > chance
}

#[cfg(test)]
mod tests {
    use super::levels;
    use crate::data::{Record, Run};
    use crate::servo_model::stretches::stretches;

    /// Runs of one step each, of which the first row has the step already.
    fn steps(at_rest: Option<f64>) -> usize {
        let runs = [1.0, 2.0, -3.0].map(|command| {
            let run = Run::new(vec![command; 20], vec![0.5 * command; 20]).unwrap();
            match at_rest {
                Some(rest) => run.with_input_at_rest(rest),
                None => run,
            }
        });
        let record = Record::new(0.02, runs.into()).unwrap();
        levels(&stretches(&record, &[]).0)
    }

    #[test]
    fn a_command_counts_where_the_servo_was_sent_to_it() {
        assert_eq!(steps(Some(0.0)), 3);
        assert_eq!(steps(None), 0);
    }
}
