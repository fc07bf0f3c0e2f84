//! Recordings whose column of the command has noise: that was sent to the servo, or that was not.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use servoid_identification::{Record, Run};
use std::f64::consts::TAU;

use crate::coverage::LONGEST_TRUTH;
use crate::plants::{Noise, PERIOD, Plant, normal, random, simulate};
use crate::trial::Trial;

/// Ends of the range of all commands.
const END: f64 = 5.0;

/// Time constant of a hand on a stick \[s\].
const HAND_S: f64 = 0.05;

/// What the servo is commanded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// Random levels that are held for 0.1 to 0.4 s.
    Levels,
    /// One end or the other, for 0.1 to 0.4 s.
    Telegraph,
    /// The ends in turn, for 0.4 s each.
    Square,
    /// Eleven levels, up and down, for 0.3 s each.
    Stairs,
    /// A sum of sines up to 12 Hz.
    Multisine,
    /// Random levels behind a lag of 50 ms: a hand.
    Stick,
}

/// The noise of its column, of which a standard deviation is in shares of the range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CommandNoise {
    None,
    White(f64),
    /// 1/(1 - ρ z^-1), of ρ and the standard deviation.
    Ar1(f64, f64),
    /// A step of so much up or down, or none.
    Steps(f64),
}

/// One line of the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoisyCommand {
    pub command: Command,
    pub plant: Plant,
    pub noise: CommandNoise,
    /// Whether the servo got the noise.
    pub is_sent: bool,
    pub samples: usize,
}

impl Command {
    pub fn values(self, samples: usize, random: &mut ChaCha8Rng) -> Vec<f64> {
        match self {
            Self::Multisine => multisine(samples, random),
            Self::Stick => followed_by_hand(&Self::Levels.values(samples, random)),
            _ => self.holds(samples, random),
        }
    }

    fn holds(self, samples: usize, random: &mut ChaCha8Rng) -> Vec<f64> {
        let mut values = Vec::new();
        for hold in 0.. {
            let (level, held) = match self {
                Self::Telegraph => {
                    let level = if random.random() { END } else { -END };
                    (level, random.random_range(50..200))
                }
                Self::Square => (if hold % 2 == 0 { END } else { -END }, 200),
                Self::Stairs => {
                    let place = hold % 20;
                    (f64::from(place.min(20 - place)) - END, 150)
                }
                _ => (random.random_range(-END..END), random.random_range(50..200)),
            };
            values.extend(std::iter::repeat_n(level, held));
            if values.len() >= samples {
                break;
            }
        }
        values.truncate(samples);
        values
    }
}

fn followed_by_hand(levels: &[f64]) -> Vec<f64> {
    let share = 1.0 - (-PERIOD / HAND_S).exp();
    let mut at = 0.0;
    let next = |level: &f64| {
        at += share * (level - at);
        at
    };
    levels.iter().map(next).collect()
}

fn multisine(samples: usize, random: &mut ChaCha8Rng) -> Vec<f64> {
    let lines: Vec<(f64, f64)> = (1..=24)
        .map(|line| (0.5 * f64::from(line), random.random_range(0.0..TAU)))
        .collect();
    let at = |k: usize| {
        let turns = TAU * k as f64 * PERIOD;
        let sines = lines.iter().map(|(hz, phase)| (turns * hz + phase).cos());
        END / 9.0 * sines.sum::<f64>()
    };
    (0..samples).map(at).collect()
}

impl CommandNoise {
    pub fn values(self, samples: usize, random: &mut ChaCha8Rng) -> Vec<f64> {
        let range = 2.0 * END;
        let mut last = 0.0;
        (0..samples)
            .map(|_| match self {
                Self::None => 0.0,
                Self::White(share) => range * share * normal(random),
                Self::Ar1(memory, share) => {
                    let new = (1.0 - memory * memory).sqrt();
                    last = memory * last + new * range * share * normal(random);
                    last
                }
                Self::Steps(share) => range * share * f64::from(random.random_range(-1..=1)),
            })
            .collect()
    }
}

impl NoisyCommand {
    /// Its recording from a seed.
    pub fn trial(&self, seed: u64) -> Trial {
        let mut random = random(seed);
        let command = self.command.values(self.samples, &mut random);
        let noise = self.noise.values(self.samples, &mut random);
        let column: Vec<f64> = command.iter().zip(&noise).map(|(u, w)| u + w).collect();
        let sent = if self.is_sent { &column } else { &command };
        let output = simulate(self.plant, Noise::White, sent, 1.0, &mut random);
        Trial {
            record: Record::of_run(PERIOD, column, output).expect("a simulated record is sound"),
            truth: self.plant.step(LONGEST_TRUTH),
        }
    }

    /// The same with a command that is stated to be exact.
    pub fn exact_trial(&self, seed: u64) -> Trial {
        let Trial { record, truth } = self.trial(seed);
        let runs = record.runs().iter().cloned().map(Run::with_exact_input);
        Trial {
            record: Record::new(PERIOD, runs.collect()).expect("a simulated record is sound"),
            truth,
        }
    }
}
