//! The motion of the simulated servo over a record: where it is at rest, and how fast it gets.

use super::stretches::Stretch;
use serde::{Deserialize, Serialize};

/// Speed that counts as motion, as a share of the largest.
const MOVING: f64 = 0.02;

/// The simulated outputs by stretch, NaN where no output was measured.
pub(super) struct Motion {
    /// The outputs.
    pub(super) simulated: Vec<Vec<f64>>,
    /// Whether the servo stands still between the sample before and this one; false where that is not known.
    pub(super) at_rest: Vec<Vec<bool>>,
    /// Whether it moves.
    pub(super) moving: Vec<Vec<bool>>,
    /// Largest speeds.
    pub(super) fastest: Fastest,
}

/// Largest speeds of the simulated output over a record.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fastest {
    /// Towards larger outputs \[output/s\].
    pub upwards: f64,
    /// Towards smaller outputs, more than zero \[output/s\].
    pub downwards: f64,
}

impl Fastest {
    /// In either direction \[output/s\].
    #[must_use]
    pub fn of_both(&self) -> f64 {
        self.upwards.max(self.downwards)
    }

    /// Those of an output with samples every `period_s` seconds; NaN is passed over.
    pub(super) fn of<T: AsRef<[f64]>>(outputs: &[T], period_s: f64) -> Self {
        let speeds = || {
            let pairs = outputs.iter().flat_map(|run| run.as_ref().windows(2));
            pairs.map(|pair| (pair[1] - pair[0]) / period_s)
        };
        Self {
            upwards: speeds().fold(0.0, f64::max),
            downwards: speeds().fold(0.0, |most, speed| f64::max(most, -speed)),
        }
    }
}

impl Motion {
    /// The motion behind errors of the simulation: measured output less error.
    pub(super) fn new(stretches: &[Stretch], errors: &[Vec<f64>], period_s: f64) -> Self {
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
        }
    }
}
