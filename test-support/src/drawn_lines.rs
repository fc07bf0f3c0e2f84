//! Hard recordings whose numbers are drawn, so that bounds are tried where nobody has looked.

use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;

use crate::hard_lines::{Drive, HardLine, Hardship};
use crate::plants::{Noise, Plant, random};

/// So many lines of a seed, of the kinds of [`hard_lines`](crate::hard_lines::hard_lines) in turn.
#[must_use]
pub fn drawn_lines(seed: u64, count: usize) -> Vec<HardLine> {
    let mut random = random(seed);
    (0..count)
        .map(|k| HardLine {
            drive: one_of(&mut random, &[Drive::Staircase, Drive::Prbs]),
            plant: one_of(&mut random, &[Plant::A, Plant::B, Plant::C, Plant::D]),
            noise: one_of(
                &mut random,
                &[Noise::White, Noise::Ar1, Noise::Ar2, Noise::Arma],
            ),
            scale: one_of(&mut random, &[1.0, 2.0, 5.0]),
            hardship: hardship(&mut random, k),
        })
        .collect()
}

fn one_of<T: Copy>(random: &mut ChaCha8Rng, all: &[T]) -> T {
    *all.choose(random).expect("there are some")
}

/// Of the ranges, those that span decades are drawn by their logarithms.
fn hardship(random: &mut ChaCha8Rng, kind: usize) -> Hardship {
    let mut between = |from: f64, to: f64| from * (to / from).powf(random.random::<f64>());
    match kind % 11 {
        0 => Hardship::Glitches {
            share: between(0.002, 0.03),
            size: between(4.0, 60.0),
            length: between(1.0, 13.0) as usize,
        },
        1 => Hardship::StudentT(between(2.5, 8.0)),
        2 => Hardship::WithSpeed(between(0.01, 0.08)),
        3 => Hardship::Jitter(between(0.05, 0.4)),
        4 => Hardship::LouderLater,
        5 => Hardship::RunOffsets(between(0.02, 0.5)),
        6 => Hardship::GainScatter {
            runs: between(3.0, 11.0) as usize,
            sd: between(0.002, 0.03),
        },
        7 => Hardship::Hum {
            hz: between(10.0, 120.0),
            amplitude: between(0.02, 0.3),
        },
        8 => Hardship::Start(between(5.0, 60.0)),
        9 => Hardship::Missing(between(0.01, 0.08)),
        _ => Hardship::SlowEnd {
            share: between(0.01, 0.12),
            seconds: between(0.1, 2.0),
        },
    }
}
