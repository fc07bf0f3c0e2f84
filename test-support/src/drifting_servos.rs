//! Servos whose gain changes along a recording, and slow ones, beside servos that neither change nor are slow but have something else.

use crate::plants::{Noise, normal, random};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use servoid_identification::{Record, Run};

/// Time between samples \[s\].
pub const PERIOD: f64 = 0.005;

/// Steps of the simulation in a sample.
const STEPS: usize = 10;

/// Delay of the servo \[samples\].
const DELAY: usize = 2;

/// The command, within ±10.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Command {
    /// Any level, each held for so many times 0.15 to 0.5 s.
    Levels(f64),
    /// Up and down five levels, each held for 0.4 s.
    Staircase,
    /// ±5, each held for 0.1 to 0.6 s.
    Telegraph,
    /// ±5, drawn anew every 40 ms.
    Prbs,
}

impl Command {
    fn samples(self, count: usize, random: &mut ChaCha8Rng) -> Vec<f64> {
        let mut input: Vec<f64> = Vec::with_capacity(count + 1000);
        let mut number = 0;
        while input.len() < count {
            let sign = if number % 2 == 0 { 5.0 } else { -5.0 };
            let (level, held_s) = match self {
                Self::Levels(times) => (
                    random.random_range(-10.0..10.0),
                    times * random.random_range(0.15..0.5),
                ),
                Self::Staircase => (5.0 * f64::from((number % 8 - 4i32).abs()) - 10.0, 0.4),
                Self::Telegraph => (sign, random.random_range(0.1..0.6)),
                Self::Prbs => (if random.random_bool(0.5) { 5.0 } else { -5.0 }, 0.04),
            };
            input.extend(std::iter::repeat_n(level, (held_s / PERIOD) as usize));
            number += 1;
        }
        input.truncate(count);
        input
    }
}

/// What moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// Second order: natural frequency \[rad/s\] and damping ratio.
    Second(f64, f64),
    /// A lag \[s\].
    Lag(f64),
    /// The integral of the command, times so many a second.
    Integral(f64),
}

/// How the gain changes along each run, by [`DriftingServo::change`] in all.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Course {
    Evenly,
    /// At this share of the run.
    AtOnce(f64),
}

/// What else the servo or the recording has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Beside {
    Nothing,
    /// A limit of its speed \[output/s\].
    TopSpeed(f64),
    /// Play between drive and sensor \[output\].
    Play(f64),
    /// Errors that do not move it \[output\].
    DeadBand(f64),
    /// An output at which it stops.
    Stop(f64),
    /// This share of the response takes 1.5 s.
    SlowEnd(f64),
    /// The gain grows by this share over ten of the output.
    Bend(f64),
    /// Gains of the runs scatter by this share.
    RunGains(f64),
    /// Offsets of the runs scatter by so much.
    RunOffsets(f64),
    /// Glitches of 5 in this share of the samples.
    Glitches(f64),
    /// The noise is so many times larger in the last eighth of each run.
    LateNoise(f64),
    /// Further noise of this share of the speed in a tenth of a second.
    NoiseOfMotion(f64),
    /// Errors of the times of samples, white \[s\].
    Jitter(f64),
    /// The same error of the output at each visit of a level, white from unit to unit.
    LevelErrors(f64),
    /// A drift of the output over each run.
    Drift(f64),
    /// The command is the error of the output times this.
    Loop(f64),
}

/// One kind of recording.
#[derive(Debug, Clone, Copy)]
pub struct DriftingServo {
    pub command: Command,
    pub motion: Motion,
    /// Of each run \[s\].
    pub seconds: f64,
    pub runs: usize,
    pub noise: Noise,
    /// Factor on the noise.
    pub scale: f64,
    /// Change of the gain along a run, as a share of it.
    pub change: f64,
    pub course: Course,
    pub beside: Beside,
}

impl Default for DriftingServo {
    /// A linear servo that does not change, under random levels.
    fn default() -> Self {
        Self {
            command: Command::Levels(1.0),
            motion: Motion::Second(40.0, 0.8),
            seconds: 30.0,
            runs: 1,
            noise: Noise::White,
            scale: 1.0,
            change: 0.0,
            course: Course::Evenly,
            beside: Beside::Nothing,
        }
    }
}

impl DriftingServo {
    /// Its recording.
    ///
    /// # Panics
    /// Never: the recording is one.
    #[must_use]
    pub fn record(&self, seed: u64) -> Record<'static> {
        let mut random = random(seed);
        let levels: Vec<f64> = (0..41).map(|_| normal(&mut random)).collect();
        let runs = (0..self.runs).map(|_| self.run(&levels, &mut random));
        Record::new(PERIOD, runs.collect()).expect("it moves")
    }

    fn run(&self, levels: &[f64], random: &mut ChaCha8Rng) -> Run<'static> {
        let count = (self.seconds / PERIOD) as usize;
        let mut input = self.command.samples(count, random);
        let of_run = normal(random);
        let gain = match self.beside {
            Beside::RunGains(sd) => 1.0 + sd * of_run,
            _ => 1.0,
        };
        let noise = self.noise.samples(random, count);
        let course = self.motion(&mut input, gain, &noise);
        let speed = |k: usize| (course[k] - course[k.saturating_sub(1)]) / PERIOD;
        let read = |k: usize| {
            let further = match self.beside {
                Beside::RunOffsets(sd) => sd * of_run,
                Beside::Glitches(share) if random.random_bool(share) => 5.0,
                Beside::LateNoise(times) if 8 * k > 7 * count => {
                    (times - 1.0) * self.scale * noise[k]
                }
                Beside::NoiseOfMotion(share) => 0.1 * share * speed(k) * normal(random),
                Beside::Jitter(sd) => sd * speed(k) * normal(random),
                Beside::LevelErrors(sd) => {
                    sd * levels[(input[k].round() + 20.0).clamp(0.0, 40.0) as usize]
                }
                Beside::Drift(change) => change * k as f64 / count as f64,
                _ => 0.0,
            };
            course[k] + self.scale * noise[k] + further
        };
        let output = (0..count).map(read).collect::<Vec<f64>>();
        Run::new(input, output).expect("one length")
    }

    /// The output without noise. In a loop, the input is replaced by that of the controller.
    fn motion(&self, input: &mut [f64], gain: f64, noise: &[f64]) -> Vec<f64> {
        let count = input.len();
        let changed = |k: usize| {
            let at = k as f64 / count as f64;
            match self.course {
                Course::Evenly => 1.0 + self.change * at,
                Course::AtOnce(place) if at > place => 1.0 + self.change,
                Course::AtOnce(_) => 1.0,
            }
        };
        let mut servo = Moved::default();
        let mut output = Vec::with_capacity(count);
        for k in 0..count {
            let seen = servo.output(self.beside);
            output.push(seen);
            if let Beside::Loop(times) = self.beside {
                input[k] = times * (input[k] - seen - self.scale * noise[k]);
            }
            let command = k.checked_sub(DELAY).map_or(0.0, |past| input[past]);
            for _ in 0..STEPS {
                servo.step(self, gain * changed(k) * command);
            }
        }
        output
    }
}

/// The state of a servo.
#[derive(Default)]
struct Moved {
    position: f64,
    speed: f64,
    /// Behind the play.
    behind: f64,
    /// The slow part of the response.
    slow: f64,
}

impl Moved {
    fn step(&mut self, servo: &DriftingServo, command: f64) {
        let step_s = PERIOD / STEPS as f64;
        let error = match servo.beside {
            Beside::DeadBand(band) => {
                let error = command - self.position;
                error - error.clamp(-band, band)
            }
            _ => command - self.position,
        };
        match servo.motion {
            Motion::Second(omega, damping) => {
                self.speed += step_s * omega * (omega * error - 2.0 * damping * self.speed);
            }
            Motion::Lag(seconds) => self.speed = error / seconds,
            Motion::Integral(rate) => self.speed = rate * command,
        }
        if let Beside::TopSpeed(top) = servo.beside {
            self.speed = self.speed.clamp(-top, top);
        }
        self.position += step_s * self.speed;
        if let Beside::Stop(stop) = servo.beside
            && self.position > stop
        {
            (self.position, self.speed) = (stop, self.speed.min(0.0));
        }
        if let Beside::Play(play) = servo.beside {
            let half = 0.5 * play;
            self.behind = self
                .behind
                .clamp(self.position - half, self.position + half);
        }
        self.slow += step_s * (self.position - self.slow) / 1.5;
    }

    fn output(&self, beside: Beside) -> f64 {
        match beside {
            Beside::Play(_) => self.behind,
            Beside::SlowEnd(share) => (1.0 - share) * self.position + share * self.slow,
            Beside::Bend(share) => self.position * (1.0 + share * self.position / 20.0),
            _ => self.position,
        }
    }
}
