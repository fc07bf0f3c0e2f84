//! How fast a servo moved in a record, as it was measured.
//!
//! The fastest stroke counts, however short it is beside the rests: a share of all samples would be drowned by them. It must not be a glitch,
//! nor a step of the sensor. So a speed counts where two means, one behind the other, both have it: a reading that is wrong, or a jump, is in one of
//! them. The smaller of two means is also less raised by noise.

use super::stretches::Stretch;
use serde::{Deserialize, Serialize};

/// Time of both means together \[s\]: two pulse frames, and the shortest time that R/C servos take to their top speed and back.
pub(super) const STROKE_S: f64 = 0.04;

/// The speeds that a servo reached in a record, as it was measured: the largest that two means of 20 ms, one behind the other, both have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReachedSpeeds {
    /// Towards larger outputs \[output/s\].
    pub upwards: f64,
    /// Towards smaller outputs, not negative \[output/s\].
    pub downwards: f64,
}

impl ReachedSpeeds {
    /// Time over which each of the two means goes \[s\], where samples are not farther apart.
    pub const MEAN_OVER_S: f64 = 0.5 * STROKE_S;

    /// Those of a record with samples every `period_s` seconds.
    pub(super) fn of(stretches: &[Stretch], period_s: f64) -> Self {
        // Rounding must not make 21 samples of 20.
        let samples = ((STROKE_S / period_s - 1e-6).ceil() as usize).max(1);
        let mut most = Self::default();
        for stretch in stretches {
            let outputs = without_single_ones(&stretch.output);
            let (up, down) = fastest(&outputs, samples);
            most.upwards = most.upwards.max(up / period_s);
            most.downwards = most.downwards.max(down / period_s);
        }
        most
    }
}

/// The largest changes for each sample up and down which both halves of so many samples have. Where a step is as long as a stroke, it is both.
pub(super) fn fastest(outputs: &[f64], samples: usize) -> (f64, f64) {
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
        let near = |found: f64, truth: f64| (found / truth - 1.0).abs() < share;
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

    /// A step of the sensor is 1 of the 8 degrees that a mean covers; uniform noise of 0.25 degrees at most moves that by 0.5.
    #[test]
    fn noise_and_steps_of_the_sensor_hardly_count() {
        let coarse = strokes(0.002).into_iter().map(f64::round).collect();
        require(coarse, 1.0 / 8.0, "coarse");
        let mut state = 1_u32;
        let mut noise = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            0.5 * (f64::from(state) / f64::from(u32::MAX) - 0.5)
        };
        let noisy = strokes(0.002).into_iter().map(|y| y + noise()).collect();
        require(noisy, 0.5 / 8.0, "noisy");
    }
}
