//! Recordings of one servo by loggers with faults of time.

use crate::plants::random;
use rand::RngExt;
use rand_distr::StandardNormal;
use servoid_identification::Record;

/// Steps of the simulation in a sample.
const STEPS: usize = 20;
const SAMPLES: usize = 6000;
const PERIOD_S: f64 = 0.002;

/// Delay of the servo \[samples\].
const DELAY: usize = 6;

/// A servo of second order (40 rad/s, damping ratio 0.8) under random levels that are held for 0.1 to 0.4 s, and what its logger does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Logger {
    /// Share by which the clock of the position goes faster than that of the command.
    pub drift: f64,
    /// Samples from one reading of the sensor to the next.
    pub refresh: usize,
    /// Samples by which commands are written late.
    pub late: usize,
    /// Share by which the stiffness of the servo falls along the recording.
    pub weaker: f64,
    /// Largest speed of the servo \[output per second\].
    pub top: f64,
    /// Position at which it runs into a stop \[output\].
    pub stop: f64,
    /// Share of the recording after which it stands still, as if it were jammed.
    pub jams: f64,
    /// Levels of the command from -10 to 10, each held for at least 0.3 s; 0 for any level.
    pub levels: u32,
}

impl Default for Logger {
    /// One without fault, and a linear servo.
    fn default() -> Self {
        Self {
            drift: 0.0,
            refresh: 1,
            late: 0,
            weaker: 0.0,
            top: f64::INFINITY,
            stop: f64::INFINITY,
            jams: f64::INFINITY,
            levels: 0,
        }
    }
}

impl Logger {
    /// Its recording, of 12 s, with white noise of 0.05 beside levels up to 10.
    ///
    /// # Panics
    /// Never: the recording is one.
    #[must_use]
    pub fn record(self, seed: u64) -> Record<'static> {
        let mut random = random(seed);
        let mut input = Vec::new();
        while input.len() < SAMPLES {
            let (level, held) = match self.levels.checked_sub(1) {
                None => (random.random_range(-10.0..10.0), 50..200),
                Some(last) => {
                    let share = f64::from(random.random_range(0..=last)) / f64::from(last);
                    (20.0 * share - 10.0, 150..250)
                }
            };
            input.extend(vec![level; random.random_range(held)]);
        }
        input.truncate(SAMPLES);
        let course = self.course(&input);
        let mut reading = 0.0;
        let mut read = |k: usize| {
            if k.is_multiple_of(self.refresh) {
                let at = (k as f64 * (1.0 + self.drift) * STEPS as f64).round() as usize;
                reading = course[at] + 0.05 * random.sample::<f64, _>(StandardNormal);
            }
            reading
        };
        let output: Vec<f64> = (0..SAMPLES).map(&mut read).collect();
        let written = |k: usize| input[k.saturating_sub(self.late)];
        let written: Vec<f64> = (0..SAMPLES).map(written).collect();
        Record::of_run(PERIOD_S, written, output).expect("it is one")
    }

    /// The position at every step of the simulation, a little beyond the end.
    fn course(self, input: &[f64]) -> Vec<f64> {
        let (mut position, mut speed) = (0.0, 0.0);
        let step_s = PERIOD_S / STEPS as f64;
        let mut next = |step: usize| {
            let now = step / STEPS;
            if now as f64 >= self.jams * SAMPLES as f64 {
                return position;
            }
            let command = input[now.saturating_sub(DELAY).min(SAMPLES - 1)];
            let stiffness = 1600.0 * (1.0 - self.weaker * now as f64 / SAMPLES as f64);
            speed += step_s * (stiffness * (command - position) - 64.0 * speed);
            speed = f64::clamp(speed, -self.top, self.top);
            position += step_s * speed;
            if position > self.stop {
                (position, speed) = (self.stop, speed.min(0.0));
            }
            position
        };
        (0..SAMPLES * STEPS * 21 / 20).map(&mut next).collect()
    }
}
