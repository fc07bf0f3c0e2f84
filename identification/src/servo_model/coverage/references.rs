//! Commands of ±5 degrees, and the noise of sensors.

use super::servos::STROKE;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;
use std::fmt;

/// Time between samples \[s\].
pub(super) const PERIOD_S: f64 = 0.002;

/// Samples in a frame of 20 ms.
pub(super) const FRAME: usize = 10;

/// Levels of the stairs.
const LEVELS: usize = 6;

/// Tones of the multisine, at odd multiples of the lowest.
const TONES: usize = 12;

/// Lowest tone of the multisine \[Hz\]; the highest is 23 times as high.
const LOWEST_HZ: f64 = 0.2;

/// Samples at rest before and after the multisine.
const REST: usize = 300;

/// A course of the command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reference {
    /// Random levels, each for 100 to 400 ms.
    RandomLevels,
    /// Up and down over a few levels, each for 240 ms.
    Stairs,
    /// Sines of random phases in frames, with rest before and after.
    Multisine,
    /// The same with a new command at each sample.
    Smooth,
}

impl Reference {
    pub(super) const ALL: [Self; 4] = [
        Self::RandomLevels,
        Self::Stairs,
        Self::Multisine,
        Self::Smooth,
    ];

    /// The command, sample by sample.
    pub(super) fn command(self, random: &mut ChaCha8Rng, samples: usize) -> Vec<f64> {
        match self {
            Self::RandomLevels => random_levels(random, samples),
            Self::Stairs => stairs(samples),
            Self::Multisine => multisine(random, samples, FRAME),
            Self::Smooth => multisine(random, samples, 1),
        }
    }

    /// Another command of this kind: with the same strokes, in another order and for other times.
    pub(super) fn another(self, random: &mut ChaCha8Rng, samples: usize) -> Vec<f64> {
        match self {
            Self::Stairs => wandering_stairs(random, samples),
            other => other.command(random, samples),
        }
    }
}

impl fmt::Display for Reference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::RandomLevels => "random levels",
            Self::Stairs => "stairs",
            Self::Multisine => "multisine",
            Self::Smooth => "smooth",
        })
    }
}

fn random_levels(random: &mut ChaCha8Rng, samples: usize) -> Vec<f64> {
    let mut command = Vec::new();
    while command.len() < samples {
        let level = random.random_range(-STROKE / 2.0..STROKE / 2.0);
        command.extend(std::iter::repeat_n(level, random.random_range(50..200)));
    }
    command.truncate(samples);
    command
}

/// The command of a step of the stairs.
fn level(step: usize) -> f64 {
    STROKE * (step as f64 / (LEVELS - 1) as f64 - 0.5)
}

fn stairs(samples: usize) -> Vec<f64> {
    let hold = 12 * FRAME;
    let command = |k: usize| {
        let at = k / hold % (2 * (LEVELS - 1));
        level(at.min(2 * (LEVELS - 1) - at))
    };
    (0..samples).map(command).collect()
}

/// Up or down by one step at random, each for 100 to 400 ms.
fn wandering_stairs(random: &mut ChaCha8Rng, samples: usize) -> Vec<f64> {
    let mut command = Vec::new();
    let mut step: usize = random.random_range(0..LEVELS);
    while command.len() < samples {
        command.extend(std::iter::repeat_n(
            level(step),
            random.random_range(50..200),
        ));
        let up = step == 0 || step < LEVELS - 1 && random.random_bool(0.5);
        step = if up { step + 1 } else { step - 1 };
    }
    command.truncate(samples);
    command
}

/// Each command is held for `hold` samples.
fn multisine(random: &mut ChaCha8Rng, samples: usize, hold: usize) -> Vec<f64> {
    let phases: Vec<f64> = (0..TONES).map(|_| random.random_range(0.0..TAU)).collect();
    let sum = |k: usize| -> f64 {
        let time_s = (k / hold * hold) as f64 * PERIOD_S;
        let tone = |(i, phase): (usize, &f64)| {
            (TAU * LOWEST_HZ * (2 * i + 1) as f64 * time_s + phase).sin()
        };
        phases.iter().enumerate().map(tone).sum()
    };
    let moving = samples.saturating_sub(2 * REST);
    let sums: Vec<f64> = (0..moving).map(sum).collect();
    let largest = sums.iter().fold(f64::MIN_POSITIVE, |a, b| a.max(b.abs()));
    let sines = sums.iter().map(|sum| sum * STROKE / 2.0 / largest);
    let rest = || std::iter::repeat_n(0.0, REST);
    rest().chain(sines).chain(rest()).take(samples).collect()
}

/// Standard deviation of the white noise behind all noise \[deg\].
const WHITE: f64 = 0.03;

/// Noise of 0.03 degrees: white, or each value 0.8 times the one before and a white one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NoiseKind {
    White,
    Coloured,
}

impl NoiseKind {
    pub(super) const ALL: [Self; 2] = [Self::White, Self::Coloured];

    /// The share of a value that stays in the next one.
    fn memory(self) -> f64 {
        match self {
            Self::White => 0.0,
            Self::Coloured => 0.8,
        }
    }

    pub(super) fn draw(self, random: &mut ChaCha8Rng, samples: usize) -> Vec<f64> {
        let memory = self.memory();
        let mut state = 0.0;
        let mut next = || -> f64 {
            let white: f64 = StandardNormal.sample(random);
            state = memory * state + WHITE * white;
            state
        };
        (0..samples).map(|_| next()).collect()
    }

    /// Sum of the squares of errors, made white and of variance 1 if they are this noise, where `known` is not NaN.
    pub(super) fn white_squares(self, errors: &[f64], known: &[f64]) -> f64 {
        let white = |pair: &[f64]| ((pair[1] - self.memory() * pair[0]) / WHITE).powi(2);
        let pairs = errors.windows(2).zip(known.windows(2));
        let known = pairs.filter(|(_, known)| !known[0].is_nan() && !known[1].is_nan());
        known.map(|(errors, _)| white(errors)).sum()
    }
}

impl fmt::Display for NoiseKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::White => "white",
            Self::Coloured => "AR(1), 0.8",
        })
    }
}
