//! How fast a servo surely moved in a record, as it was measured.
//!
//! The fastest stroke counts, however short it is beside the rests: a share of all samples would be drowned by them. It must not be a glitch,
//! nor a step of the sensor. So a speed counts where two means, one behind the other, both have it: a reading that is wrong, or a jump, is in one of
//! them.
//!
//! **What noise may add** is taken off, so that the servo was at least as fast. Of readings y, the smaller of both means over h samples each is at most
//! (y(k + 2h) - y(k)) / 2h, so that the errors of these two readings alone are in it:
//!
//! ```text
//! reached = max over k and h of  min(y(k+h) - y(k), y(k+2h) - y(k+h)) / h  -  (4 σ(h) + δ) / 2h
//! ```
//!
//! with δ the step of the sensor and σ(h) the standard deviation of a difference of two readings so far apart. That is read off the quietest quarter of
//! the differences of second to sixth order at that distance, which contain motion, too, so that it is hardly too small: noise that is
//! white, or wanders like the sum of such noise, has at least as much in them. Longer means are less raised, and a short stroke has shorter ones: the one that shows most counts.
//! Each stretch of the record counts by itself, so that more runs never show less.

use crate::data::common_step;
use crate::servo_model::stretches::Stretch;
use serde::{Deserialize, Serialize};

/// Time of both means together \[s\]: two pulse frames, and the shortest time that R/C servos take to their top speed and back.
pub(crate) const STROKE_S: f64 = 0.04;

/// Lengths of the means, in times of the shortest.
const LENGTHS: [usize; 4] = [1, 2, 4, 8];

/// By so many standard deviations noise may raise the largest of many measured speeds.
const RAISED_BY_NOISE: f64 = 4.0;

/// Orders of differences that show noise, and the variance of those of a random walk in terms of that of its difference over two steps: the order n has
/// (2n - 2)!/(n - 1)!² for 2.
const ORDERS: [(usize, f64); 5] = [(2, 1.0), (3, 3.0), (4, 10.0), (5, 35.0), (6, 126.0)];

/// Half of the sizes of normal quantities in this part of them, the quietest, are below this part of their standard deviation.
const QUIETEST: (f64, f64) = (0.25, 0.3186);

/// Differences below this many times the smallest are of one step.
const ONE_STEP: f64 = 1.5;

/// Differences from which noise is known.
const ENOUGH: usize = 20;

/// Differences examined for noise, spread over a stretch.
const EXAMINED: usize = 1 << 14;

/// The speeds that a servo reached in a record at least: what noise may have added to the measured ones is not in them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReachedSpeeds {
    /// Towards larger outputs \[output/s\].
    pub upwards: f64,
    /// Towards smaller outputs, not negative \[output/s\].
    pub downwards: f64,
    /// What was taken off the measured speeds for noise, the larger of both \[output/s\]; zero in files from before it was.
    #[serde(default)]
    pub noise: f64,
}

impl ReachedSpeeds {
    /// Those of a record with samples every `period_s` seconds.
    pub(crate) fn of(stretches: &[Stretch], period_s: f64) -> Self {
        let outputs = stretches.iter().map(|stretch| &stretch.output);
        let [up, down] = outputs
            .map(|outputs| Surest::of(outputs, period_s))
            .fold([Surest::default(); 2], |[up, down], found| {
                [up.or(found[0]), down.or(found[1])]
            });
        Self {
            upwards: up.speed,
            downwards: down.speed,
            noise: up.noise.max(down.noise),
        }
    }

    /// The speeds as they were measured, which noise may have raised: upwards and downwards \[output/s\].
    #[must_use]
    pub fn measured(&self) -> [f64; 2] {
        [self.upwards, self.downwards].map(|speed| match speed > 0.0 {
            true => speed + self.noise,
            false => 0.0,
        })
    }
}

/// A speed that was surely reached, and what was taken off for noise.
#[derive(Clone, Copy, Default)]
struct Surest {
    speed: f64,
    noise: f64,
}

impl Surest {
    /// Up and down in one stretch.
    fn of(outputs: &[f64], period_s: f64) -> [Self; 2] {
        let cleaned = without_single_ones(outputs);
        let differences: Vec<f64> = outputs.windows(2).map(|y| y[1] - y[0]).collect();
        let known: Vec<f64> = differences.into_iter().filter(|d| !d.is_nan()).collect();
        let step = step(&known);
        // Rounding must not make 11 samples of 10.
        let shortest = ((0.5 * STROKE_S / period_s - 1e-6).ceil() as usize).max(1);
        // Where a step is as long as a stroke, it is both means.
        let samples = |length: usize| match period_s >= STROKE_S - 1e-9 {
            true => length,
            false => 2 * length * shortest,
        };
        let of_length = |length: usize| {
            let samples = samples(length);
            let sd = noise_of_difference(outputs, samples.div_ceil(2))?;
            let raised = (RAISED_BY_NOISE * sd + step) / (samples as f64 * period_s);
            let (up, down) = fastest(&cleaned, samples);
            Some([up, down].map(|measured| Self {
                speed: measured / period_s - raised,
                noise: raised,
            }))
        };
        let found = LENGTHS.into_iter().filter_map(of_length);
        found.fold([Self::default(); 2], |[up, down], found| {
            [up.or(found[0]), down.or(found[1])]
        })
    }

    fn or(self, other: Self) -> Self {
        match other.speed > self.speed {
            true => other,
            false => self,
        }
    }
}

/// The step of the sensor in `differences` of its readings: one of which all are whole multiples, or the smallest that stands alone where the sensor rests, which the digits of a
/// file may make a little smaller or larger. Nothing where readings have no steps.
fn step(differences: &[f64]) -> f64 {
    let alone = differences.windows(3).filter_map(|all| match all {
        [0.0, change, 0.0] if *change != 0.0 => Some(change.abs()),
        _ => None,
    });
    let alone: Vec<f64> = alone.collect();
    let smallest = alone.iter().copied().fold(f64::INFINITY, f64::min);
    let alike = alone.iter().copied().filter(|d| *d < ONE_STEP * smallest);
    let of_rests = match alone.len() >= ENOUGH {
        true => alike.fold(0.0, f64::max),
        false => 0.0,
    };
    common_step(differences).unwrap_or_default().max(of_rests)
}

/// The standard deviation of the difference of two readings by their noise, of differences between readings that are so many `samples` apart; `None` of
/// too few.
fn noise_of_difference(outputs: &[f64], samples: usize) -> Option<f64> {
    let mut differences = outputs.to_vec();
    let mut done = 0;
    let of_order = |(order, of_walk): (usize, f64)| {
        while done < order {
            let pairs = differences.iter().zip(differences.iter().skip(samples));
            differences = pairs.map(|(first, second)| second - first).collect();
            done += 1;
        }
        let every = differences.len().div_ceil(EXAMINED).max(1);
        let sizes = differences.iter().step_by(every).map(|d| d.abs());
        let mut sizes: Vec<f64> = sizes.filter(|size| !size.is_nan()).collect();
        let (part, of_sd) = QUIETEST;
        let rank = (part * sizes.len() as f64) as usize;
        let is_known = sizes.len() >= ENOUGH;
        is_known.then(|| {
            let (_, quiet, _) = sizes.select_nth_unstable_by(rank, f64::total_cmp);
            *quiet / of_sd / of_walk.sqrt()
        })
    };
    ORDERS.into_iter().filter_map(of_order).reduce(f64::min)
}

/// The largest changes for each sample up and down which both halves of so many samples have. Where a step is as long as a stroke, it is both.
pub(crate) fn fastest(outputs: &[f64], samples: usize) -> (f64, f64) {
    let half = samples.div_ceil(2);
    let means = outputs.windows(half + 1);
    let means: Vec<f64> = means.map(|y| (y[half] - y[0]) / half as f64).collect();
    let pairs = means.iter().zip(means.iter().skip(samples - half));
    let known = pairs.filter(|(first, second)| !(**first + **second).is_nan());
    known.fold((0.0, 0.0), |(up, down): (f64, f64), (first, second)| {
        (up.max(first.min(*second)), down.max(-first.max(*second)))
    })
}

/// Each output as the middle one of itself and its neighbours: where samples are far apart, a wrong one would be in both means.
fn without_single_ones(outputs: &[f64]) -> Vec<f64> {
    let mut cleaned = outputs.to_vec();
    for (of_three, cleaned) in outputs.windows(3).zip(cleaned.iter_mut().skip(1)) {
        if let [before, own, after] = of_three
            && !(before + own + after).is_nan()
        {
            *cleaned = own.clamp(before.min(*after), before.max(*after));
        }
    }
    cleaned
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Record;
    use crate::servo_model::stretches::stretches;

    /// Ten strokes of 20 degrees to each side at 400 and 500 deg/s, with rests of a second between them: 98 % of the samples are rest.
    fn strokes(period_s: f64) -> Vec<f64> {
        let (up_s, down_s) = (20.0 / 400.0, 20.0 / 500.0);
        let at = |time_s: f64| {
            let time_s = time_s % 2.0;
            let up = ((time_s - 0.3) / up_s).clamp(0.0, 1.0);
            let down = ((time_s - 1.3) / down_s).clamp(0.0, 1.0);
            20.0 * (up - down)
        };
        let samples = (20.0 / period_s) as usize;
        (0..samples).map(|k| at(k as f64 * period_s)).collect()
    }

    fn reached(output: Vec<f64>, period_s: f64) -> [f64; 2] {
        // A record must have a command; what it is does not matter here.
        let command: Vec<f64> = (0..output.len()).map(|k| (k % 2) as f64).collect();
        let record = Record::of_run(period_s, command, output).unwrap();
        let (stretches, _) = stretches(&record, &[]);
        let found = ReachedSpeeds::of(&stretches, period_s);
        [found.upwards, found.downwards]
    }

    fn require(output: Vec<f64>, share: f64, case: &str) {
        let [up, down] = reached(output, 0.002);
        let near = |found: f64, truth: f64| (1.0 - share..1.0 + 1e-9).contains(&(found / truth));
        assert!(near(up, 400.0) && near(down, 500.0), "{case}: {up} {down}");
    }

    #[test]
    fn the_fastest_strokes_count_however_long_the_rests_are() {
        require(strokes(0.002), 1e-9, "clean");
    }

    #[test]
    fn wrong_readings_and_jumps_are_no_speed() {
        for length in [1, 3, 9] {
            let mut output = strokes(0.002);
            for first in [100, 2222, 2655, 5151, 7160] {
                for y in &mut output[first..first + length] {
                    *y += 60.0;
                }
            }
            require(output, 1e-9, &format!("{length} wrong samples"));
        }
        let mut output = strokes(0.002);
        for y in &mut output[4000..] {
            *y += 40.0;
        }
        require(output, 1e-9, "a jump");
        let mut output = strokes(0.05);
        for k in [3, 33, 77] {
            output[k] += 60.0;
        }
        // One sample of each stroke at the most is in motion.
        assert!(
            reached(output, 0.05)
                .into_iter()
                .all(|speed| speed <= 500.0)
        );
    }

    /// Noise that is white at `stays` = 0 and wanders at 0.98, of standard deviation `sd`.
    fn noise(sd: f64, stays: f64, mut state: u32) -> impl FnMut() -> f64 {
        let mut last = 0.0;
        move || {
            // Three uniform numbers are normal enough.
            let uniform = |state: &mut u32| {
                *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                2.0 * f64::from(*state) / f64::from(u32::MAX) - 1.0
            };
            let draw = uniform(&mut state) + uniform(&mut state) + uniform(&mut state);
            last = stays * last + (1.0 - stays * stays).sqrt() * draw;
            sd * last
        }
    }

    /// A step of the sensor is 1 of the 16 degrees that both means cover, and noise of 0.15 degrees takes off 4 times 0.37 of them.
    #[test]
    fn noise_and_steps_of_the_sensor_take_little_off() {
        let coarse = strokes(0.002).into_iter().map(f64::round).collect();
        require(coarse, 1.0 / 8.0, "coarse");
        let mut noise = noise(0.15, 0.0, 1);
        let noisy = strokes(0.002).into_iter().map(|y| y + noise()).collect();
        require(noisy, 1.5 / 16.0, "noisy");
    }

    #[test]
    fn no_noise_makes_a_servo_faster_than_it_was() {
        for (seed, sd, stays, period_s) in (0..40).flat_map(|seed| {
            let of = move |(sd, stays)| [0.002, 0.01, 0.02].map(|period| (seed, sd, stays, period));
            [(0.1, 0.0), (0.5, 0.0), (0.5, 0.9), (1.0, 0.98), (2.0, 0.0)]
                .into_iter()
                .flat_map(of)
        }) {
            let mut noise = noise(sd, stays, seed);
            let noisy = strokes(period_s).into_iter().map(|y| y + noise());
            let [up, down] = reached(noisy.collect(), period_s);
            assert!(
                up <= 400.0 && down <= 500.0,
                "{seed}: {sd} {stays} {period_s}: {up} {down}"
            );
        }
    }

    /// Steps of 360/4096 degrees, written with two decimals, are multiples of nothing.
    #[test]
    fn steps_that_a_file_rounds_are_steps() {
        let mut noise = noise(0.02, 0.0, 3);
        // Levels between two counts, so that the sensor toggles in rests.
        let counts = strokes(0.005)
            .into_iter()
            .map(|y| ((y + 0.22 + noise()) * 4096.0 / 360.0).round());
        let output: Vec<f64> = counts
            .map(|count| (count * 36000.0 / 4096.0).round() / 100.0)
            .collect();
        let differences: Vec<f64> = output.windows(2).map(|y| y[1] - y[0]).collect();
        assert_eq!(common_step(&differences), None);
        let found = step(&differences);
        // To the last digit.
        assert!((found - 360.0 / 4096.0).abs() < 0.01, "{found}");
        let [up, down] = reached(output, 0.005);
        assert!(up <= 400.0 && down <= 500.0, "{up} {down}");
    }

    #[test]
    fn more_runs_never_show_less() {
        let quiet = strokes(0.002);
        let mut noise = noise(3.0, 0.0, 5);
        let noisy: Vec<f64> = strokes(0.002).into_iter().map(|y| y + noise()).collect();
        let run = |output: &[f64]| {
            let command: Vec<f64> = (0..output.len()).map(|k| (k % 2) as f64).collect();
            crate::data::Run::new(command, output.to_vec()).unwrap()
        };
        let of = |runs: Vec<crate::data::Run<'static>>| {
            let record = Record::new(0.002, runs).unwrap();
            ReachedSpeeds::of(&stretches(&record, &[]).0, 0.002)
        };
        let alone = of(vec![run(&quiet)]);
        let both = of(vec![run(&quiet), run(&noisy)]);
        assert!(both.upwards >= alone.upwards && both.downwards >= alone.downwards);
    }
}
