//! Simulated servos whose step response is known exactly, references and noises.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Time between samples of all simulations \[s\].
pub const PERIOD: f64 = 0.002;

/// Linear servos of different character, by the letters of the documentation's coverage table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Plant {
    /// Second order, damping 0.5, 60 rad/s, dead time 4 samples.
    A,
    /// Second order, damping 0.7, 30 rad/s, dead time 10 samples.
    B,
    /// First order, 25 ms, dead time 6 samples.
    C,
    /// Second order, damping 0.6, 60 rad/s, with a real pole at 20 rad/s.
    D,
    /// Second order, damping 0.15, 40 rad/s, dead time 4 samples: rings for 0.9 s.
    E,
}

impl Plant {
    /// The exact response to a unit step at sample 0, held between samples.
    pub fn step(self, samples: usize) -> Vec<f64> {
        (0..samples).map(|m| self.at(m)).collect()
    }

    fn at(self, m: usize) -> f64 {
        let (dead, response): (usize, fn(f64) -> f64) = match self {
            Self::A => (4, |t| second_order(0.5, 60.0, t)),
            Self::B => (10, |t| second_order(0.7, 30.0, t)),
            Self::C => (6, |t| 1.0 - (-t / 0.025).exp()),
            Self::D => (0, |t| with_pole(0.6, 60.0, 20.0, t)),
            Self::E => (4, |t| second_order(0.15, 40.0, t)),
        };
        m.checked_sub(dead)
            .map_or(0.0, |m| response(m as f64 * PERIOD))
    }

    /// The response to an impulse of one sample.
    pub fn impulse(self, samples: usize) -> Vec<f64> {
        let before = |m: usize| m.checked_sub(1).map_or(0.0, |m| self.at(m));
        (0..samples).map(|m| self.at(m) - before(m)).collect()
    }

    /// The response to an input that had stood at its first value for ever.
    pub fn respond(self, input: &[f64]) -> Vec<f64> {
        // A second is longer than any of the plants remembers to 1e-9, except E.
        let step = self.step(if self == Self::E { 2500 } else { 700 });
        let impulse = self.impulse(step.len());
        let settled = step[step.len() - 1];
        (0..input.len())
            .map(|k| {
                let moved: f64 = (0..=k.min(impulse.len() - 1))
                    .map(|m| impulse[m] * (input[k - m] - input[0]))
                    .sum();
                settled * input[0] + moved
            })
            .collect()
    }
}

fn second_order(zeta: f64, omega: f64, t: f64) -> f64 {
    let root = (1.0 - zeta * zeta).sqrt();
    let damped = omega * root;
    1.0 - (-zeta * omega * t).exp() * ((damped * t).cos() + zeta / root * (damped * t).sin())
}

/// w²/(s²+2ζws+w²) · p/(s+p), by partial fractions.
fn with_pole(zeta: f64, omega: f64, pole: f64, t: f64) -> f64 {
    // Y(s) = 1/s + a/(s+p) + (b s + c)/(s²+2ζws+w²); a from the residue at -p, b and c from the
    // limits s -> infinity (b = -1 - a) and the coefficient of s³.
    let square = omega * omega;
    let a = -square / (pole * pole - 2.0 * zeta * omega * pole + square);
    let b = -1.0 - a;
    let c = -(2.0 * zeta * omega + pole) - a * 2.0 * zeta * omega - b * pole;
    let damped = omega * (1.0 - zeta * zeta).sqrt();
    let decay = (-zeta * omega * t).exp();
    1.0 + a * (-pole * t).exp()
        + decay * (b * (damped * t).cos() + (c - b * zeta * omega) / damped * (damped * t).sin())
}

/// Noises, with standard deviations of 0.05 to 0.064 at a step of 5.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Noise {
    White,
    /// 1/(1 - 0.95 z^-1).
    Ar1,
    /// 1/(1 - 1.5 z^-1 + 0.7 z^-2).
    Ar2,
    /// (1 + 0.6 z^-1)/(1 - 0.9 z^-1).
    Arma,
}

impl Noise {
    /// D(z) without its first coefficient, the coefficient of a moving average, and the standard deviation of what drives it.
    pub(crate) fn numbers(self) -> (&'static [f64], f64, f64) {
        match self {
            Self::White => (&[], 0.0, 0.05),
            Self::Ar1 => (&[-0.95], 0.0, 0.02),
            Self::Ar2 => (&[-1.5, 0.7], 0.0, 0.02),
            Self::Arma => (&[-0.9], 0.6, 0.02),
        }
    }

    pub fn samples(self, random: &mut ChaCha8Rng, count: usize) -> Vec<f64> {
        let (ar, ma, sd) = self.numbers();
        let warm_up = 500;
        let mut noise: Vec<f64> = Vec::with_capacity(count + warm_up);
        let mut before = 0.0;
        for k in 0..count + warm_up {
            let drive: f64 = sd * normal(random);
            let past: f64 = ar
                .iter()
                .enumerate()
                .filter(|(i, _)| k > *i)
                .map(|(i, d)| d * noise[k - i - 1])
                .sum();
            noise.push(drive + ma * before - past);
            before = drive;
        }
        noise.split_off(warm_up)
    }
}

pub fn normal(random: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(random)
}

pub fn random(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// Rest, then ±5 with holds of 800 ms down to 100 ms, then rest: 4200 samples.
pub fn staircase() -> Vec<f64> {
    let mut input = vec![0.0; 300];
    for hold in (1..=8).rev() {
        input.extend(std::iter::repeat_n(5.0, 50 * hold));
        input.extend(std::iter::repeat_n(-5.0, 50 * hold));
    }
    input.extend(std::iter::repeat_n(0.0, 300));
    input
}

/// Rest, 360 random frames of 10 samples at ±5, then rest: 4200 samples.
pub fn prbs(random: &mut ChaCha8Rng) -> Vec<f64> {
    let mut input = vec![0.0; 300];
    for _ in 0..360 {
        let level = if random.random::<bool>() { 5.0 } else { -5.0 };
        input.extend(std::iter::repeat_n(level, 10));
    }
    input.extend(std::iter::repeat_n(0.0, 300));
    input
}

/// ±5 in equal holds of 400 ms: 4200 samples.
pub fn square() -> Vec<f64> {
    (0..4200)
        .map(|k| if k / 200 % 2 == 0 { 5.0 } else { -5.0 })
        .collect()
}

/// `input` behind two first-order lags of the given corner frequency \[Hz\].
pub fn low_passed(input: &[f64], hertz: f64) -> Vec<f64> {
    let keep = (-std::f64::consts::TAU * hertz * PERIOD).exp();
    let lag = |input: &[f64]| -> Vec<f64> {
        input
            .iter()
            .scan(input[0], |state, u| {
                *state = keep * *state + (1.0 - keep) * u;
                Some(*state)
            })
            .collect()
    };
    lag(&lag(input))
}

/// The response of `plant` to `input` with `noise` times `scale`.
pub fn simulate(
    plant: Plant,
    noise: Noise,
    input: &[f64],
    scale: f64,
    random: &mut ChaCha8Rng,
) -> Vec<f64> {
    let noise = noise.samples(random, input.len());
    plant
        .respond(input)
        .iter()
        .zip(noise)
        .map(|(y, v)| y + scale * v)
        .collect()
}
