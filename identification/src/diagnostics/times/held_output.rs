//! Whether a column is refreshed less often than rows are written: the output, as by a sensor that is slower than its logger, or a moving
//! input.
//!
//! Then the output changes every so many rows only, and shows the servo as it was up to that many rows before. A sensor of coarse steps
//! also stands still in between, but its changes come at any distance, and most are of one step.

use std::collections::BTreeMap;

use crate::data::Record;
use crate::thresholds::{HELD_OUTPUT_SHARE, ONE_STEP_SHARE};

/// Changes that are needed.
const FEWEST: usize = 100;

/// The longest refresh that is looked for \[samples\].
const LONGEST: usize = 200;

/// From this refresh on, one sample more or less is the beat of two clocks.
const BEATS: usize = 5;

/// Changes of about one step differ by less than this factor from the smallest.
const ONE_STEP: f64 = 1.5;

/// The time between two readings of the sensor \[samples\], where it is longer than a sample.
pub(crate) fn output_held_for(record: &Record) -> Option<usize> {
    let (mut gaps, mut sizes) = (Gaps::default(), Vec::new());
    for run in record.runs() {
        gather(run.output(), &mut gaps, &mut sizes);
    }
    if gaps.count < FEWEST || is_coarse(&sizes) {
        return None;
    }
    let refreshes = || (2..=LONGEST).rev();
    let exactly = refreshes().find(|refresh| is_refreshed_every(*refresh, 0, &gaps));
    exactly.or_else(|| {
        let mut slower = refreshes().filter(|refresh| *refresh >= BEATS);
        slower.find(|refresh| is_refreshed_every(*refresh, 1, &gaps))
    })
}

/// The time between two values of an input that moves all the time \[samples\], where it is longer than a sample. Levels are held for
/// different times.
pub(crate) fn input_held_for(record: &Record) -> Option<usize> {
    let mut gaps = Gaps::default();
    for run in record.runs() {
        gather(run.input(), &mut gaps, &mut Vec::new());
    }
    let (usual, as_usual) = gaps.of_length.iter().max_by_key(|(_, count)| **count)?;
    let is_refreshed = *as_usual as f64 >= HELD_OUTPUT_SHARE * gaps.count as f64;
    (*usual > 1 && gaps.count >= FEWEST && is_refreshed).then_some(*usual)
}

/// How often there are so many samples between neighbouring changes of a column: a long record has few different lengths.
#[derive(Default)]
struct Gaps {
    of_length: BTreeMap<usize, usize>,
    count: usize,
}

impl Gaps {
    fn add(&mut self, length: usize) {
        *self.of_length.entry(length).or_default() += 1;
        self.count += 1;
    }
}

/// Samples between neighbouring changes of a column, and the sizes of these.
fn gather(column: &[f64], gaps: &mut Gaps, sizes: &mut Vec<f64>) {
    let mut last = None;
    for (k, pair) in column.windows(2).enumerate() {
        let size = (pair[1] - pair[0]).abs();
        if size.is_nan() {
            last = None;
        } else if size > 0.0 {
            if let Some(last) = last {
                gaps.add(k - last);
            }
            sizes.push(size);
            last = Some(k);
        }
    }
}

/// Whether most changes are of one step of the sensor.
fn is_coarse(sizes: &[f64]) -> bool {
    let least = sizes.iter().copied().fold(f64::INFINITY, f64::min);
    let single = sizes.iter().filter(|size| **size < ONE_STEP * least);
    single.count() as f64 > ONE_STEP_SHARE * sizes.len() as f64
}

/// Whether changes come at multiples of `refresh`, to within `beat` samples.
fn is_refreshed_every(refresh: usize, beat: usize, gaps: &Gaps) -> bool {
    let fits = |gap: usize| {
        let beyond = (gap + beat) % refresh;
        gap + beat >= refresh && beyond <= 2 * beat
    };
    let fitting = gaps.of_length.iter().filter(|(gap, _)| fits(**gap));
    let fitting: usize = fitting.map(|(_, count)| count).sum();
    fitting as f64 >= HELD_OUTPUT_SHARE * gaps.count as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    /// A lag under levels, with white noise, in steps of `quantum`, read every `refresh` samples.
    fn found(refresh: f64, quantum: f64, noise: f64) -> Option<usize> {
        let mut random = ChaCha8Rng::seed_from_u64(8);
        let levels: Vec<f64> = (0..40).map(|_| random.random_range(-10.0..10.0)).collect();
        let input: Vec<f64> = levels.iter().flat_map(|level| [*level; 150]).collect();
        let (mut y, mut reading, mut read) = (0.0, 0.0, -1.0);
        let output: Vec<f64> = (0..input.len())
            .map(|k| {
                y += f64::clamp((input[k] - y) / 15.0, -0.2, 0.2);
                if (k as f64 / refresh).floor() > read {
                    read = (k as f64 / refresh).floor();
                    let now = y + noise * random.sample::<f64, _>(StandardNormal);
                    reading = (now / quantum).round() * quantum;
                }
                reading
            })
            .collect();
        output_held_for(&Record::of_run(0.002, &input, &output).unwrap())
    }

    #[test]
    fn an_input_that_moves_in_steps_of_equal_length_is_refreshed_and_levels_are_not() {
        let of = |input: &[f64]| {
            let output: Vec<f64> = (0..input.len()).map(|k| (k % 2) as f64).collect();
            input_held_for(&Record::of_run(0.002, input, &output).unwrap())
        };
        let sine = |k: usize| (0.004 * k as f64).sin();
        let refreshed: Vec<f64> = (0..3000).map(|k| sine(k / 10 * 10)).collect();
        assert_eq!(of(&refreshed), Some(10));
        assert_eq!(of(&(0..3000).map(sine).collect::<Vec<f64>>()), None);
        let levels: Vec<f64> = (0..9000u32)
            .map(|k| f64::from((20 * k).isqrt() % 3))
            .collect();
        assert_eq!(of(&levels), None);
    }

    #[test]
    fn a_slow_sensor_is_one_and_coarse_steps_are_none() {
        for refresh in [2, 5, 10, 20] {
            assert_eq!(found(refresh as f64, 0.001, 0.05), Some(refresh));
        }
        // A clock of its own.
        assert!(found(10.07, 0.001, 0.05).is_some_and(|found| (10..=11).contains(&found)));
        for (quantum, noise) in [
            (0.001, 0.05),
            (0.09, 0.05),
            (0.35, 0.05),
            (0.35, 0.0),
            (1.0, 0.0),
        ] {
            assert_eq!(found(1.0, quantum, noise), None, "{quantum}, {noise}");
        }
    }
}
