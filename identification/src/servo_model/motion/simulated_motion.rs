//! The motion of the simulated servo: where it is at rest, how fast it gets, and how far behind the command it falls.

use super::command_range::CommandRange;
use crate::servo_model::stretches::Stretch;
use servoid_dynamics::ServoParameters;

/// Speed that counts as motion, as a share of the largest.
const MOVING: f64 = 0.02;

/// The simulated outputs by stretch, NaN where no output was measured.
pub(crate) struct ServoMotion {
    /// The outputs.
    pub(crate) simulated: Vec<Vec<f64>>,
    /// Whether the servo stands still between the sample before and this one; false where that is not known.
    pub(crate) at_rest: Vec<Vec<bool>>,
    /// Whether it moves.
    pub(crate) moving: Vec<Vec<bool>>,
    /// Largest speeds.
    pub(crate) fastest: Fastest,
    /// The commands.
    pub(crate) commands: CommandRange,
}

/// Largest speeds of the simulated output over a record.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fastest {
    /// Towards larger outputs \[output/s\].
    pub(crate) upwards: f64,
    /// Towards smaller outputs, more than zero \[output/s\].
    pub(crate) downwards: f64,
}

impl Fastest {
    /// In either direction \[output/s\].
    fn of_both(&self) -> f64 {
        self.upwards.max(self.downwards)
    }

    /// Those of outputs with samples every `period_s` seconds; NaN is passed over.
    fn of(outputs: &[Vec<f64>], period_s: f64) -> Self {
        let speeds = || {
            let pairs = outputs.iter().flat_map(|run| run.windows(2));
            pairs.map(|pair| (pair[1] - pair[0]) / period_s)
        };
        Self {
            upwards: speeds().fold(0.0, f64::max),
            downwards: speeds().fold(0.0, |most, speed| f64::max(most, -speed)),
        }
    }
}

/// The largest distance of the angle of the servo `physics` from the command \[command\]; NaN is passed over.
pub(crate) fn largest_error(physics: &ServoParameters, input: &[f64], output: &[f64]) -> f64 {
    let angle = |y: f64| (y - physics.offset) / physics.gain;
    let errors = input.iter().zip(output).map(|(u, y)| (u - angle(*y)).abs());
    errors.fold(0.0, f64::max)
}

/// The largest drive that the servo `physics` may have taken, as the error that asks for it \[command\], if all of its damping is in the loop: what moves smoothly behind its command asks for
/// less than its error, and never shows a limit that a step of that size meets.
pub(crate) fn largest_drive(
    physics: &ServoParameters,
    input: &[f64],
    output: &[f64],
    period_s: f64,
) -> f64 {
    let angle = |y: f64| (y - physics.offset) / physics.gain;
    let late = (physics.delay_s.max(0.0) / period_s) as usize;
    let ahead_s = physics.damping / physics.stiffness;
    let drive = |(pair, u): (&[f64], &f64)| {
        let speed = (angle(pair[1]) - angle(pair[0])) / period_s;
        (u - angle(pair[0]) - ahead_s * speed).abs()
    };
    let moves = output.windows(2).skip(late).zip(input);
    moves.map(drive).fold(0.0, f64::max)
}

impl ServoMotion {
    /// The motion behind errors of the simulation: measured output less error.
    pub(crate) fn new(stretches: &[Stretch], errors: &[Vec<f64>], period_s: f64) -> Self {
        let less = |(stretch, errors): (&Stretch, &Vec<f64>)| {
            let both = stretch.output.iter().zip(errors);
            both.map(|(y, e)| y - e).collect()
        };
        let simulated: Vec<Vec<f64>> = stretches.iter().zip(errors).map(less).collect();
        let fastest = Fastest::of(&simulated, period_s);
        let most = MOVING * fastest.of_both() * period_s;
        let judged = |judge: fn(f64, f64) -> bool| -> Vec<Vec<bool>> {
            let steps = |run: &Vec<f64>| {
                let step = |pair: &[f64]| judge((pair[1] - pair[0]).abs(), most);
                std::iter::once(false)
                    .chain(run.windows(2).map(step))
                    .collect()
            };
            simulated.iter().map(steps).collect()
        };
        Self {
            at_rest: judged(|step, most| step <= most),
            moving: judged(|step, most| step > most),
            simulated,
            fastest,
            commands: commands(stretches),
        }
    }
}

/// The least and the largest command.
pub(super) fn commands(stretches: &[Stretch]) -> CommandRange {
    let commands = || stretches.iter().flat_map(|stretch| &stretch.input);
    CommandRange {
        least: commands().copied().fold(f64::INFINITY, f64::min),
        largest: commands().copied().fold(f64::NEG_INFINITY, f64::max),
    }
}

#[cfg(test)]
impl ServoMotion {
    /// One run that stands still where it says so, and moves elsewhere.
    pub(crate) fn resting(at_rest: Vec<bool>) -> Self {
        Self {
            simulated: vec![vec![0.0; at_rest.len()]],
            moving: vec![at_rest.iter().map(|rest| !rest).collect()],
            at_rest: vec![at_rest],
            fastest: Fastest {
                upwards: 1.0,
                downwards: 1.0,
            },
            commands: CommandRange {
                least: -1.0,
                largest: 1.0,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Behind a ramp the error of a servo whose damping is in its loop asks for no drive; behind a step all of it does.
    #[test]
    fn a_smooth_command_takes_less_drive_than_its_error_and_a_step_takes_all() {
        const PERIOD_S: f64 = 0.005;
        let servo = ServoParameters {
            delay_s: 0.01,
            gain: 2.0,
            offset: 1.0,
            ..ServoParameters::linear(2500.0, 100.0)
        };
        let input: Vec<f64> = (0..400).map(|k| 50.0 * PERIOD_S * f64::from(k)).collect();
        let behind = |u: &f64| servo.gain * (u - 50.0 * (0.01 + 100.0 / 2500.0)) + servo.offset;
        let output: Vec<f64> = input.iter().map(behind).collect();
        assert!((largest_error(&servo, &input, &output) - 2.5).abs() < 1e-9);
        assert!(largest_drive(&servo, &input, &output, PERIOD_S) < 1e-9);
        let step = [vec![0.0; 10], vec![3.0; 10]].concat();
        let still = vec![servo.offset; 20];
        assert_eq!(largest_drive(&servo, &step, &still, PERIOD_S), 3.0);
    }
}
