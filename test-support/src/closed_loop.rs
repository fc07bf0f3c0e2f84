//! Recordings in closed loop, u(k) = C (r(k) - y(k)), and in open loop with the same references.

use crate::plants::{Noise, PERIOD, Plant};
use crate::trial::Trial;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use servoid_identification::Record;

/// The course of r in a closed loop, or of u in an open one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Course {
    /// Ends of ±5 held for 800 ms down to 100 ms.
    Staircase,
    /// ±5 that changes sign in one sample of fifty.
    Telegraph,
    /// ±5, drawn anew every 10 samples.
    Prbs,
    /// Twelve sines from 0.5 to 40 Hz.
    Multisine,
}

/// Samples of a recording.
const SAMPLES: usize = 3600;

impl Course {
    fn samples(self, random: &mut ChaCha8Rng) -> Vec<f64> {
        match self {
            Self::Staircase => crate::plants::staircase()[300..300 + SAMPLES].to_vec(),
            Self::Telegraph => {
                let mut level = 5.0;
                let mut next = |_| {
                    if random.random_bool(0.02) {
                        level = -level;
                    }
                    level
                };
                (0..SAMPLES).map(&mut next).collect()
            }
            Self::Prbs => {
                let levels: Vec<f64> = (0..SAMPLES / 10)
                    .map(|_| if random.random::<bool>() { 5.0 } else { -5.0 })
                    .collect();
                (0..SAMPLES).map(|k| levels[k / 10]).collect()
            }
            Self::Multisine => {
                let sines: Vec<(f64, f64)> = (0..12)
                    .map(|i| {
                        let hz = 0.5 * 80f64.powf(f64::from(i) / 11.0);
                        (hz, std::f64::consts::TAU * random.random::<f64>())
                    })
                    .collect();
                let at = |k: usize| {
                    let of = |(hz, phase): &(f64, f64)| {
                        (std::f64::consts::TAU * hz * k as f64 * PERIOD + phase).sin()
                    };
                    1.5 * sines.iter().map(of).sum::<f64>()
                };
                (0..SAMPLES).map(at).collect()
            }
        }
    }
}

/// One kind of recording.
#[derive(Debug, Clone, Copy)]
pub struct Loop {
    /// The course of r, or of u.
    pub course: Course,
    /// C of a closed loop; `None` in an open one.
    pub controller: Option<f64>,
    /// The servo.
    pub plant: Plant,
    /// Its noise.
    pub noise: Noise,
    /// Factor on the noise.
    pub scale: f64,
    /// Samples from the reading of y to the command that is computed from it.
    pub delay: usize,
}

impl Loop {
    /// One recording.
    #[must_use]
    pub fn trial(&self, random: &mut ChaCha8Rng) -> Trial {
        let course = self.course.samples(random);
        let noise = self.noise.samples(random, SAMPLES);
        let step = self.plant.step(2500);
        let impulse = self.plant.impulse(700);
        let (mut input, mut output) = (vec![0.0; SAMPLES], vec![0.0; SAMPLES]);
        for k in 0..SAMPLES {
            // The servo has dead time, so u(k) does not act on y(k).
            let moved = |m: usize| impulse[m] * input[k - m];
            let servo: f64 = (1..=k.min(699)).map(moved).sum();
            output[k] = servo + self.scale * noise[k];
            input[k] = match self.controller {
                None => course[k],
                Some(c) => {
                    c * (course[k]
                        - if k < self.delay {
                            0.0
                        } else {
                            output[k - self.delay]
                        })
                }
            };
            if self.controller.is_none() {
                output[k] += impulse[0] * input[k];
            }
        }
        Trial {
            record: Record::of_run(PERIOD, input, output).expect("a simulated record is sound"),
            truth: step,
        }
    }
}
