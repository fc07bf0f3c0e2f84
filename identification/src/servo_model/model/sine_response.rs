//! The response of a servo to a sine of one size: how much of it arrives, and how late.
//!
//! A servo that is limited has no frequency response of its own: it has one for each amplitude, that of the first harmonic of its motion (the
//! describing function; J. E. Gibson, *Nonlinear Automatic Control*, 1963). It is simulated, with the derivatives by all coordinates, whose
//! covariance gives the intervals; other sets of terms that predict as well widen them.

use super::{ServoModel, quadratic, start_at_rest};
use crate::numerics::not_negative;
use crate::results::{Bounds, Interval, Reason, pointwise_critical};
use crate::servo_model::descent::coordinates::Point;
use crate::servo_model::descent::step::MOST;
use servoid_dynamics::{Dual, Grid, Scalar, simulate};
use std::f64::consts::{PI, SQRT_2, TAU};

/// Steps of a period. The command is held in each, which the harmonic of the held command takes out again.
const STEPS: usize = 240;

/// Periods that are looked at.
const PERIODS: usize = 4;

/// The servo has come to its periodic motion after so long \[s\], and after two periods at the least.
const COMES_TO_IT_S: f64 = 1.5;

/// The first harmonic of the motion under a sine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SineResponse {
    /// Amplitude of the motion over that of the command \[output per input\].
    pub gain: f64,
    /// Phase \[degrees\]; a lag is negative.
    pub phase_deg: f64,
    /// Intervals of both at the level of the model. They are withdrawn where the command runs further ahead of the servo than in the record, and where that
    /// leaves the phase open by a turn or more.
    pub bounds: Bounds<[Interval; 2]>,
}

/// Logarithm of the gain and phase \[rad\], with standard deviations, and the motion.
struct Harmonic {
    values: [f64; 2],
    sd: [f64; 2],
    outputs: Vec<f64>,
}

/// A sine about the middle of the commands of a record, held in steps.
struct Sine {
    commands: Vec<f64>,
    omega: f64,
    step_s: f64,
}

impl Sine {
    fn new(hertz: f64, amplitude: f64, middle: f64) -> Self {
        let before = (COMES_TO_IT_S * hertz).ceil().max(2.0) as usize;
        let at = |k: usize| middle + amplitude * (TAU * k as f64 / STEPS as f64).sin();
        Self {
            commands: (0..(before + PERIODS) * STEPS).map(at).collect(),
            omega: TAU * hertz,
            step_s: 1.0 / (hertz * STEPS as f64),
        }
    }

    /// Real and imaginary part of what step `k` has in the first harmonic; none before the periods that are looked at.
    fn weights(&self, k: usize) -> Option<[f64; 2]> {
        let turn = TAU * (k % STEPS) as f64 / STEPS as f64;
        (k + PERIODS * STEPS >= self.commands.len()).then(|| [turn.cos(), -turn.sin()])
    }

    /// The first harmonic of the held command, in the measure of [`Self::weights`].
    fn of_command(&self) -> [f64; 2] {
        let mut sum = [0.0; 2];
        for (k, command) in self.commands.iter().enumerate() {
            for (sum, weight) in sum.iter_mut().zip(self.weights(k).unwrap_or_default()) {
                *sum += command * weight;
            }
        }
        // A hold of h is (1 - exp(-jωh)) / (jωh) of the values at its edge.
        let half = 0.5 * self.omega * self.step_s;
        let (size, late) = (half.sin() / half, -half);
        let [re, im] = sum;
        [
            size * (re * late.cos() - im * late.sin()),
            size * (re * late.sin() + im * late.cos()),
        ]
    }
}

impl ServoModel {
    /// The response to a sine of `hertz` and this `amplitude` to each side of the middle of the recorded commands, of the controller number `controller`
    /// (from 0).
    ///
    /// The intervals do not have the uncertainty of a sensor's delay, and of how a command was sent.
    #[must_use]
    pub fn respond_to_sine(&self, hertz: f64, amplitude: f64, controller: usize) -> SineResponse {
        let middle = self.commands.map_or(0.0, |commands| commands.middle());
        let sine = Sine::new(hertz, amplitude, middle);
        let own = self.covariance.valid();
        let rows = own.map_or(&[][..], |found| &found.rows);
        let found = self.harmonic(&self.point(), rows, &sine, controller);
        let [log_gain, phase] = found.values;
        let critical = own.map_or(f64::NAN, |found| pointwise_critical(found.level));
        // What the equation lacks may be a sine of this frequency.
        let lacking = self.fit.discrepancy.unwrap_or(f64::NAN) * SQRT_2;
        let lacking = lacking / (amplitude.abs() * log_gain.exp());
        let half = |harmonic: &Harmonic, k: usize| {
            let apart = (harmonic.values[k] - found.values[k]).abs();
            apart + critical * harmonic.sd[k].hypot(lacking)
        };
        let others = self.alternatives.iter().filter(|_| own.is_some());
        let others: Vec<Harmonic> = others
            .map(|other| {
                self.harmonic(
                    &self.point_of_alternative(other),
                    &other.covariance,
                    &sine,
                    controller,
                )
            })
            .collect();
        let half = [0, 1].map(|k| {
            let all = others.iter().chain([&found]);
            all.map(|harmonic| half(harmonic, k)).fold(0.0, f64::max)
        });
        let gain = log_gain.exp();
        let (factor, degrees) = (half[0].exp(), half[1].to_degrees());
        let phase_deg = phase.to_degrees();
        let intervals = [
            Interval::new(gain, gain / factor, gain * factor),
            Interval::new(phase_deg, phase_deg - degrees, phase_deg + degrees),
        ];
        let beyond = self.beyond_record(&sine.commands, &found.outputs, controller);
        // Next to the edge of a dead band the derivatives are of no use.
        let open = half[1].is_nan() || half[1] >= PI;
        SineResponse {
            gain,
            phase_deg,
            bounds: self
                .covariance
                .as_ref()
                .map(|_| intervals)
                .unless(beyond)
                .unless(open.then_some(Reason::SineOpen)),
        }
    }

    /// The first harmonic of the motion of another servo, `point`, with the covariance of its coordinates.
    fn harmonic(
        &self,
        point: &Point,
        covariance: &[Vec<f64>],
        sine: &Sine,
        controller: usize,
    ) -> Harmonic {
        let physics = point.physics(controller, |i, value| Dual::<MOST>::variable(value, i));
        let own = point.physics(controller, |_, value| value);
        let first = Dual::constant(sine.commands[0]);
        let start = start_at_rest(&physics, first);
        let grid = Grid::for_stiffness(sine.step_s, 0.0, own.stiffness);
        let (mut outputs, mut sums) = (Vec::new(), [Dual::<MOST>::constant(0.0); 2]);
        simulate(&physics, &grid, &start, &sine.commands, |k, y| {
            outputs.push(y.value);
            for (sum, weight) in sums.iter_mut().zip(sine.weights(k).unwrap_or_default()) {
                *sum = *sum + y * weight;
            }
        });
        let [a, b] = sine.of_command();
        let [re, im] = sums;
        let size = 1.0 / (a * a + b * b);
        let [re, im] = [(re * a + im * b) * size, (im * a - re * b) * size];
        let square = re.value * re.value + im.value * im.value;
        let sd = |of: fn([f64; 2], [f64; 2]) -> f64| {
            let slopes = (re.slope.iter().zip(&im.slope))
                .map(|(dre, dim)| of([re.value, im.value], [*dre, *dim]) / square);
            let slopes: Vec<f64> = slopes.collect();
            not_negative(quadratic(covariance, &slopes)).sqrt()
        };
        let linear = -sine.omega * own.delay_s
            - (own.damping * sine.omega).atan2(own.stiffness - sine.omega * sine.omega);
        let linear = if own.gain < 0.0 { linear + PI } else { linear };
        let phase = im.value.atan2(re.value);
        Harmonic {
            // A phase alone does not say how many turns it lacks: a servo that follows is next to its response to small signals.
            values: [
                0.5 * square.ln(),
                phase + TAU * ((linear - phase) / TAU).round(),
            ],
            sd: [
                sd(|[re, im], [dre, dim]| re * dre + im * dim),
                sd(|[re, im], [dre, dim]| re * dim - im * dre),
            ],
            outputs,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The step of the sine, and not its holds, is what the gain is of: a servo without a delay that follows at once has 1 and 0.
    #[test]
    fn the_harmonic_of_a_held_sine_is_a_little_smaller_and_half_a_step_late() {
        let sine = Sine::new(8.0, 5.0, 2.0);
        let [re, im] = sine.of_command();
        let count = (PERIODS * STEPS) as f64;
        // Of a sine: -j A/2 for each step.
        let half = std::f64::consts::PI / STEPS as f64;
        assert!((re.hypot(im) / (2.5 * count) - half.sin() / half).abs() < 1e-12);
        assert!((im.atan2(re) + std::f64::consts::FRAC_PI_2 + half).abs() < 1e-9);
    }
}
