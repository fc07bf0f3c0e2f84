//! Recordings that are harder than even noise of one kind: glitches, tails, jitter, hum, runs that differ.

use std::f64::consts::TAU;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StudentT};
use servoid_identification::{Options, Record, Run};

use crate::coverage::{LONGEST_TRUTH, Line, measure_trials};
use crate::oracle;
use crate::plants::{Noise, PERIOD, Plant, normal, prbs, random, staircase};
use crate::trial::Trial;

/// Standard deviation of white noise at a factor of one.
const NOISE: f64 = 0.05;

/// Samples of a repeated input that are not recorded, at least: longer than a slow end.
const BEFORE: usize = 2000;

/// Samples of a frame of random steps.
const FRAME: usize = 10;

/// Runs of a record of several.
const RUNS: usize = 5;

/// What makes a recording hard.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hardship {
    /// `share` of all samples are wrong by `size` standard deviations of the noise, `length` in a row.
    Glitches {
        share: f64,
        size: f64,
        length: usize,
    },
    /// White noise with Student's distribution of so many degrees of freedom.
    StudentT(f64),
    /// White noise with Laplace's distribution.
    Laplace,
    /// Further noise of this share of the change of the output in 10 ms.
    WithSpeed(f64),
    /// Times of sampling that scatter by this standard deviation \[ms\].
    Jitter(f64),
    /// Five runs, with offsets of this standard deviation.
    RunOffsets(f64),
    /// Runs with gains of this standard deviation about one. The truth is the servo's mean.
    GainScatter { runs: usize, sd: f64 },
    /// Runs with delays of this standard deviation \[ms\] about the mean. The truth is the servo's mean.
    DelayScatter { runs: usize, sd_ms: f64 },
    /// A sine of this frequency \[Hz\] and amplitude, and its third harmonic at a third of that.
    Hum { hz: f64, amplitude: f64 },
    /// The servo begins this far away, and comes by its own response.
    Start(f64),
    /// This share of the samples is missing, input and output.
    Missing(f64),
    /// This share of the response has this time constant \[s\], the rest is the plant's.
    SlowEnd { share: f64, seconds: f64 },
    /// The noise is three times as large in the second half.
    LouderLater,
}

/// The reference of a hard line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Drive {
    Staircase,
    Prbs,
    /// Equal holds of so many samples. The record begins in the middle of the motion, as those of the next ones do.
    Square(usize),
    /// Random frames of ten samples, which repeat themselves after so many samples.
    RepeatedSteps(usize),
    /// All sines of this period \[samples\], with random phases.
    Multisine(usize),
}

impl Drive {
    /// The input, and the samples of it that are not recorded.
    fn input(self, random: &mut ChaCha8Rng) -> (Vec<f64>, usize) {
        let period: Vec<f64> = match self {
            Self::Staircase => return (staircase(), 0),
            Self::Prbs => return (prbs(random), 0),
            Self::Square(hold) => [vec![5.0; hold], vec![-5.0; hold]].concat(),
            Self::RepeatedSteps(samples) => {
                let level = |random: &mut ChaCha8Rng| if random.random() { 5.0 } else { -5.0 };
                let frames = (0..samples.div_ceil(FRAME)).flat_map(|_| [level(random); FRAME]);
                frames.take(samples).collect()
            }
            Self::Multisine(samples) => {
                let phases: Vec<f64> = (1..samples / 2)
                    .map(|_| TAU * random.random::<f64>())
                    .collect();
                let amplitude = 5.0 * (2.0 / phases.len() as f64).sqrt();
                let sine = |k: usize, (l, phase): (f64, &f64)| {
                    amplitude * (TAU * l * k as f64 / samples as f64 + phase).sin()
                };
                let harmonics = || (1..).map(f64::from).zip(&phases);
                (0..samples)
                    .map(|k| harmonics().map(|part| sine(k, part)).sum())
                    .collect()
            }
        };
        let before = period.len() * BEFORE.div_ceil(period.len());
        let samples = before + staircase().len();
        (
            period.iter().copied().cycle().take(samples).collect(),
            before,
        )
    }
}

/// One line of the table.
#[derive(Debug, Clone, Copy)]
pub struct HardLine {
    pub drive: Drive,
    pub plant: Plant,
    pub noise: Noise,
    /// Factor on the noise.
    pub scale: f64,
    pub hardship: Hardship,
}

impl HardLine {
    /// The first columns of the line in the table.
    #[must_use]
    pub fn label(&self) -> String {
        let Self {
            drive,
            plant,
            noise,
            scale,
            hardship,
        } = self;
        format!("| {drive:?} | {plant:?}, {hardship:?} | {noise:?} | {scale} |")
    }

    /// How often bounds hold the truth in `runs` recordings, which differ in their seeds.
    #[must_use]
    pub fn measure(&self, runs: usize, options: &Options) -> Line {
        measure_trials(self.label(), runs, options, |run| self.seeded(run))
    }

    /// The half widths of one who knows N and the noise, of a record without the hardship.
    #[must_use]
    pub fn oracle(&self) -> Option<(f64, f64)> {
        oracle::half_widths(&self.seeded(0), self.noise, self.scale)
    }

    fn seeded(&self, run: usize) -> Trial {
        // FNV-1a: lines with other names have other seeds.
        let hash = (self.label().bytes()).fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
        self.trial(&mut random(hash ^ run as u64))
    }

    pub(crate) fn trial(&self, random: &mut ChaCha8Rng) -> Trial {
        let runs = match self.hardship {
            Hardship::RunOffsets(_) => RUNS,
            Hardship::GainScatter { runs, .. } | Hardship::DelayScatter { runs, .. } => runs,
            _ => 1,
        };
        let runs = (0..runs).map(|_| self.run(random)).collect();
        Trial {
            record: Record::new(PERIOD, runs).expect("a simulated record is sound"),
            truth: self.truth(),
        }
    }

    fn truth(&self) -> Vec<f64> {
        let fast = self.plant.step(LONGEST_TRUTH);
        match self.hardship {
            Hardship::SlowEnd { share, seconds } => fast
                .iter()
                .zip(0..)
                .map(|(g, m)| {
                    let slow = 1.0 - (-f64::from(m) * PERIOD / seconds).exp();
                    (1.0 - share) * g + share * slow
                })
                .collect(),
            _ => fast,
        }
    }

    fn run(&self, random: &mut ChaCha8Rng) -> Run<'static> {
        let (mut input, before) = self.drive.input(random);
        let noise = match self.hardship {
            Hardship::StudentT(degrees) => {
                let tails = StudentT::new(degrees).expect("a positive number");
                (0..input.len())
                    .map(|_| NOISE * self.scale * tails.sample(random))
                    .collect()
            }
            Hardship::Laplace => (0..input.len())
                .map(|_| {
                    let sign = if random.random_bool(0.5) { 1.0 } else { -1.0 };
                    let size: f64 = -random.random::<f64>().max(1e-12).ln();
                    sign * NOISE * self.scale * size / 2f64.sqrt()
                })
                .collect(),
            _ => {
                let mut noise = self.noise.samples(random, input.len());
                noise.iter_mut().for_each(|v| *v *= self.scale);
                noise
            }
        };
        let clean = self.plant.respond(&input);
        let mut output: Vec<f64> = clean.iter().zip(&noise).map(|(y, v)| y + v).collect();
        self.harden(&clean, &noise, &mut input, &mut output, random);
        let (input, output) = (input.split_off(before), output.split_off(before));
        Run::new(input, output).expect("a simulated run is sound")
    }

    fn harden(
        &self,
        clean: &[f64],
        noise: &[f64],
        input: &mut [f64],
        output: &mut [f64],
        random: &mut ChaCha8Rng,
    ) {
        let samples = output.len();
        let speed = |k: usize| (clean[(k + 1).min(samples - 1)] - clean[k.saturating_sub(1)]) / 2.0;
        match self.hardship {
            Hardship::StudentT(_) | Hardship::Laplace => {}
            Hardship::Glitches {
                share,
                size,
                length,
            } => {
                for k in 0..samples {
                    if random.random_bool(share / length as f64) {
                        let sign = if random.random_bool(0.5) { 1.0 } else { -1.0 };
                        let end = (k + length).min(samples);
                        for y in &mut output[k..end] {
                            *y += sign * size * NOISE * self.scale;
                        }
                    }
                }
            }
            Hardship::WithSpeed(share) => {
                let samples_in_10_ms = 0.01 / PERIOD;
                for (k, y) in output.iter_mut().enumerate() {
                    *y += share * samples_in_10_ms * speed(k) * normal(random);
                }
            }
            Hardship::Jitter(ms) => {
                let sd = 1e-3 * ms / PERIOD;
                for (k, y) in output.iter_mut().enumerate() {
                    *y += sd * speed(k) * normal(random);
                }
            }
            Hardship::RunOffsets(sd) => {
                let offset = sd * normal(random);
                output.iter_mut().for_each(|y| *y += offset);
            }
            Hardship::GainScatter { sd, .. } => {
                let gain = 1.0 + sd * normal(random);
                for (k, y) in output.iter_mut().enumerate() {
                    *y = gain * clean[k] + noise[k];
                }
            }
            Hardship::DelayScatter { sd_ms, .. } => {
                let delay = 1e-3 * sd_ms / PERIOD * normal(random);
                for (k, y) in output.iter_mut().enumerate() {
                    *y -= delay * speed(k);
                }
            }
            Hardship::Hum { hz, amplitude } => {
                let phase: f64 = TAU * random.random::<f64>();
                for (k, y) in output.iter_mut().enumerate() {
                    let angle = TAU * hz * k as f64 * PERIOD + phase;
                    *y += amplitude * (angle.sin() + (3.0 * angle).sin() / 3.0);
                }
            }
            Hardship::Start(away) => {
                let step = self.plant.step(samples);
                for (y, g) in output.iter_mut().zip(step) {
                    *y += away * (1.0 - g);
                }
            }
            Hardship::Missing(share) => {
                for k in 0..samples {
                    if random.random_bool(share) {
                        (input[k], output[k]) = (f64::NAN, f64::NAN);
                    }
                }
            }
            Hardship::SlowEnd { share, seconds } => {
                let keep = (-PERIOD / seconds).exp();
                let mut slow = input[0];
                for k in 0..samples {
                    output[k] += share * (slow - clean[k]);
                    slow = keep * slow + (1.0 - keep) * input[k];
                }
            }
            Hardship::LouderLater => {
                for k in samples / 2..samples {
                    output[k] += 2.0 * noise[k];
                }
            }
        }
    }
}

/// The hard lines of the documentation.
#[must_use]
pub fn hard_lines() -> Vec<HardLine> {
    let line = |hardship| HardLine {
        drive: Drive::Staircase,
        plant: Plant::A,
        noise: Noise::White,
        scale: 1.0,
        hardship,
    };
    let glitches = |size, length| {
        line(Hardship::Glitches {
            share: 0.01,
            size,
            length,
        })
    };
    let slow_end = |share, seconds, noise, scale| HardLine {
        plant: Plant::C,
        noise,
        scale,
        ..line(Hardship::SlowEnd { share, seconds })
    };
    let scatter = |runs, sd| line(Hardship::GainScatter { runs, sd });
    let hum = |hz| line(Hardship::Hum { hz, amplitude: 0.1 });
    vec![
        glitches(5.0, 1),
        glitches(50.0, 1),
        glitches(50.0, 3),
        glitches(5.0, 10),
        glitches(50.0, 10),
        HardLine {
            noise: Noise::Ar1,
            ..glitches(50.0, 1)
        },
        HardLine {
            drive: Drive::Prbs,
            noise: Noise::Ar2,
            ..glitches(20.0, 3)
        },
        line(Hardship::StudentT(3.0)),
        line(Hardship::StudentT(5.0)),
        HardLine {
            drive: Drive::Prbs,
            plant: Plant::B,
            ..line(Hardship::StudentT(4.0))
        },
        line(Hardship::Laplace),
        line(Hardship::WithSpeed(0.03)),
        line(Hardship::WithSpeed(0.06)),
        HardLine {
            noise: Noise::Ar1,
            ..line(Hardship::WithSpeed(0.06))
        },
        line(Hardship::Jitter(0.1)),
        line(Hardship::Jitter(0.2)),
        line(Hardship::Jitter(0.5)),
        HardLine {
            drive: Drive::Prbs,
            noise: Noise::Ar2,
            ..line(Hardship::Jitter(0.5))
        },
        line(Hardship::LouderLater),
        line(Hardship::RunOffsets(0.1)),
        line(Hardship::RunOffsets(0.25)),
        HardLine {
            drive: Drive::Prbs,
            ..line(Hardship::RunOffsets(0.25))
        },
        scatter(2, 0.01),
        scatter(3, 0.005),
        scatter(5, 0.01),
        scatter(10, 0.02),
        line(Hardship::DelayScatter {
            runs: 5,
            sd_ms: 1.0,
        }),
        hum(16.7),
        hum(50.0),
        hum(60.0),
        HardLine {
            noise: Noise::Ar1,
            ..hum(50.0)
        },
        line(Hardship::Start(40.0)),
        HardLine {
            scale: 5.0,
            ..line(Hardship::Start(40.0))
        },
        HardLine {
            plant: Plant::D,
            scale: 5.0,
            ..line(Hardship::Start(40.0))
        },
        line(Hardship::Missing(0.05)),
        HardLine {
            plant: Plant::B,
            noise: Noise::Ar1,
            ..line(Hardship::Missing(0.05))
        },
        slow_end(0.1, 0.4, Noise::White, 1.0),
        slow_end(0.1, 0.4, Noise::Ar2, 1.0),
        slow_end(0.1, 0.4, Noise::Ar1, 5.0),
        slow_end(0.03, 0.2, Noise::Ar1, 1.0),
        slow_end(0.03, 0.4, Noise::Ar1, 1.0),
        slow_end(0.03, 0.4, Noise::White, 5.0),
        slow_end(0.05, 0.8, Noise::White, 1.0),
        HardLine {
            drive: Drive::Prbs,
            ..slow_end(0.05, 0.3, Noise::Ar2, 1.0)
        },
        HardLine {
            plant: Plant::B,
            ..slow_end(0.05, 0.5, Noise::Ar1, 1.0)
        },
        HardLine {
            plant: Plant::D,
            ..slow_end(0.04, 0.6, Noise::Ar1, 5.0)
        },
        HardLine {
            drive: Drive::Prbs,
            plant: Plant::A,
            ..slow_end(0.03, 0.4, Noise::Ar1, 1.0)
        },
        HardLine {
            plant: Plant::A,
            ..slow_end(-0.05, 0.3, Noise::Ar1, 1.0)
        },
        HardLine {
            plant: Plant::A,
            ..slow_end(0.01, 0.4, Noise::White, 1.0)
        },
        slow_end(0.03, 0.15, Noise::Ar1, 5.0),
        slow_end(0.1, 0.8, Noise::Ar1, 5.0),
        slow_end(0.02, 0.8, Noise::Ar2, 5.0),
        slow_end(0.05, 0.4, Noise::Arma, 1.0),
        slow_end(0.03, 2.0, Noise::Ar1, 1.0),
        slow_end(0.05, 1.5, Noise::Ar2, 5.0),
        HardLine {
            plant: Plant::A,
            ..slow_end(0.05, 2.0, Noise::White, 5.0)
        },
        HardLine {
            plant: Plant::B,
            ..slow_end(0.04, 3.0, Noise::Ar1, 1.0)
        },
        HardLine {
            drive: Drive::Prbs,
            ..slow_end(0.05, 1.0, Noise::Ar1, 1.0)
        },
    ]
}

/// Servos with and without slow ends under inputs that repeat themselves.
#[must_use]
pub fn repeating_lines() -> Vec<HardLine> {
    use Drive::{Multisine, RepeatedSteps, Square};
    use Noise::{Ar1, Ar2, White};
    use Plant::{A, B, C, D};
    let line = |drive, plant, noise, scale, share, seconds| HardLine {
        drive,
        plant,
        noise,
        scale,
        hardship: Hardship::SlowEnd { share, seconds },
    };
    vec![
        line(Square(150), A, White, 1.0, 0.0, 0.4),
        line(Square(200), A, White, 1.0, 0.0, 0.4),
        line(Square(200), A, Ar1, 1.0, 0.0, 0.4),
        line(Square(300), A, White, 1.0, 0.0, 0.4),
        line(Square(400), B, Ar2, 1.0, 0.0, 0.4),
        line(RepeatedSteps(300), A, White, 1.0, 0.0, 0.4),
        line(RepeatedSteps(599), A, Ar1, 1.0, 0.0, 0.4),
        line(Multisine(600), D, Ar2, 1.0, 0.0, 0.4),
        line(Square(200), C, Ar1, 1.0, 0.03, 0.4),
        line(Square(300), C, Ar1, 1.0, 0.03, 0.4),
        line(Square(250), A, White, 5.0, 0.1, 0.3),
        line(Square(500), A, Ar1, 5.0, 0.1, 0.8),
        line(Square(500), C, Ar1, 5.0, 0.1, 0.8),
        line(RepeatedSteps(300), C, Ar1, 1.0, 0.03, 0.4),
        line(RepeatedSteps(511), A, Ar2, 5.0, 0.1, 0.8),
        line(Multisine(250), C, Ar1, 1.0, 0.1, 0.2),
        line(Multisine(400), C, White, 5.0, 0.03, 0.6),
    ]
}
