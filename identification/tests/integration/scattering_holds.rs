//! Answers that come at times of their own, and levels that are off: what differs from hold to hold is in the bounds.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use servoid_identification::{Options, Record, identify};

/// Time between rows \[s\].
const PERIOD: f64 = 0.005;

/// The step response of a lag of 40 ms, `time` after the step \[s\].
fn answer(time: f64) -> f64 {
    1.0 - (-time.max(0.0) / 0.04).exp()
}

/// What differs from hold to hold.
#[derive(Debug, Clone, Copy)]
struct Holds {
    /// Commands take effect after waits of up to this \[s\].
    frame: f64,
    /// Commands are written in steps of this; the servo gets finer ones.
    written: f64,
    /// Levels to choose from, or any.
    levels: Option<usize>,
}

impl Holds {
    /// The mean of [`answer`] over the waits.
    fn mean_answer(&self, time: f64) -> f64 {
        let waits = (0..100).map(|k| (f64::from(k) + 0.5) / 100.0 * self.frame);
        waits.map(|wait| answer(time - wait)).sum::<f64>() / 100.0
    }

    /// 60 levels of 0.3 to 0.5 s in noise of a two-hundredth of the levels.
    fn record(&self, seed: u64) -> Record<'static> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let level = |random: &mut ChaCha8Rng| random.random_range(-5.0..5.0f64);
        let count = self.levels.unwrap_or_default();
        let choice: Vec<f64> = (0..count).map(|_| level(&mut random)).collect();
        let (mut input, mut output) = (Vec::new(), Vec::new());
        let (mut angle, mut before) = (0.0, 0.0);
        for _ in 0..60 {
            let next = match choice.len() {
                0 => level(&mut random),
                count => choice[random.random_range(0..count)],
            };
            let wait = self.frame * random.random_range(0.0..1.0);
            // From one angle towards a command, `time` later.
            let towards =
                |command: f64, from: f64, time: f64| from + (command - from) * answer(time);
            let from = angle;
            for row in 0..random.random_range(60..100u32) {
                let time = f64::from(row) * PERIOD;
                angle = match time < wait {
                    true => towards(before, from, time),
                    false => towards(next, towards(before, from, wait), time - wait),
                };
                input.push(match self.written > 0.0 {
                    true => (next / self.written).round() * self.written,
                    false => next,
                });
                output.push(angle + 0.025 * random.sample::<f64, _>(StandardNormal));
            }
            before = next;
        }
        Record::of_run(PERIOD, input, output).unwrap()
    }

    /// Of 40 recordings, those whose bands have a level, and those of them that contain the mean answer in all points.
    fn bands(&self) -> (usize, usize) {
        let (mut claimed, mut inside) = (0, 0);
        for seed in 0..40 {
            let model = identify(&self.record(seed), &Options::default()).unwrap();
            let Some(bounds) = model.step.bounds.valid() else {
                continue;
            };
            claimed += 1;
            let band = &bounds.simultaneous;
            let limits = band.lower.iter().zip(&band.upper);
            let mut points = model.step.time_s.iter().zip(limits);
            inside += usize::from(points.all(|(time, (lower, upper))| {
                (*lower..=*upper).contains(&self.mean_answer(*time))
            }));
        }
        (claimed, inside)
    }
}

const EVEN: Holds = Holds {
    frame: 0.0,
    written: 0.0,
    levels: None,
};

/// Of 40 bands of 99 % more than two are missed in one of 130 tries.
fn assert_hold(holds: Holds) {
    let (claimed, inside) = holds.bands();
    assert!(
        claimed >= 36 && inside + 2 >= claimed,
        "{holds:?}: {inside} of {claimed}"
    );
}

/// Without the allowance 18 of 40 are missed.
#[test]
fn the_mean_of_answers_that_scatter_is_in_the_band() {
    assert_hold(Holds {
        frame: 0.02,
        ..EVEN
    });
}

#[test]
fn levels_that_were_rounded_are_in_the_band() {
    assert_hold(Holds {
        written: 0.5,
        ..EVEN
    });
}

/// The same levels again and again, each off by the same.
#[test]
fn levels_that_are_off_by_the_same_at_each_visit_are_in_the_band() {
    assert_hold(Holds {
        written: 0.3,
        levels: Some(12),
        ..EVEN
    });
}
