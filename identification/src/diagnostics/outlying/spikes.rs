//! Single samples that stand out from the straight lines on both sides of them.
//!
//! A servo that is not linear misses its linear model in motion, where a glitch is then one large error among many. Its shape
//! sets it apart: the motion bends, and no motion leaves its course and is back on it two samples later. The errors alone would not
//! do: where samples are far apart, a model that is wrong at an edge is wrong for one sample. So both stand out, the errors and the
//! measured output.

use crate::thresholds::{SPIKE, SPIKE_SCALE_QUANTILE};

/// The outputs of a run.
pub(super) struct Course<'a> {
    /// As measured.
    pub(super) measured: &'a [f64],
    /// Measured less simulated.
    pub(super) errors: &'a [f64],
    /// Whether the servo moves.
    pub(super) in_motion: Vec<bool>,
}

/// The lowest and the highest of what each sample is above the lines through the two samples before and the two after it. NaN where
/// one of these is missing.
fn above_lines(course: &[f64]) -> impl Iterator<Item = (f64, f64)> {
    course.windows(5).map(|five| {
        let after = five[2] - (2.0 * five[1] - five[0]);
        let before = five[2] - (2.0 * five[3] - five[4]);
        match (after + before).is_nan() {
            true => (f64::NAN, f64::NAN),
            false => (after.min(before), after.max(before)),
        }
    })
}

/// How far a sample stands out that is between `lowest` and `highest` above its lines: the least of all where it is on one side
/// of all, else 0.
fn distance(lowest: f64, highest: f64) -> f64 {
    lowest.max(-highest).max(0.0)
}

/// How far each sample stands out, in output and errors, and in the output alone. 0 where one of its neighbours is missing.
struct Distances {
    both: Vec<f64>,
    measured: Vec<f64>,
}

impl Distances {
    fn of(course: &Course<'_>) -> Self {
        let count = course.measured.len();
        let (mut both, mut measured) = (vec![0.0; count], vec![0.0; count]);
        let pairs = above_lines(course.measured).zip(above_lines(course.errors));
        let distances = both.iter_mut().zip(&mut measured).skip(2).zip(pairs);
        for ((both, measured), (output, errors)) in distances {
            *measured = distance(output.0, output.1);
            if !(output.0 + errors.0).is_nan() {
                *both = distance(output.0.min(errors.0), output.1.max(errors.1));
            }
        }
        Self { both, measured }
    }
}

/// The spikes of each run, as indices of run and sample. What stands out in motion is compared with what usually does there. The first
/// samples of a run, which a model needs as history, have no errors: there the output must stand out farther than anywhere else.
pub(super) fn spikes(courses: &[Course<'_>]) -> Vec<(usize, usize)> {
    let distances: Vec<Distances> = courses.iter().map(Distances::of).collect();
    let limit = |of_motion: bool| {
        let pairs = courses.iter().zip(&distances);
        let pairs = pairs.flat_map(|(course, by)| course.in_motion.iter().zip(&by.both));
        let of_kind = pairs.filter(|(moving, _)| **moving == of_motion);
        SPIKE * usual(of_kind.map(|(_, by)| *by).collect())
    };
    // Motion bends at its beginning and end, too, where it hardly counts as motion.
    let limit = limit(false).max(limit(true));
    let is_spike = |by: f64| limit > 0.0 && by > limit;
    let mut farthest = limit;
    for (course, by) in courses.iter().zip(&distances) {
        let known = course.errors.iter().zip(by.both.iter().zip(&by.measured));
        let usual = known.filter(|(error, (both, _))| !error.is_nan() && !is_spike(**both));
        farthest = usual.fold(farthest, |most, (_, (_, measured))| most.max(*measured));
    }
    let of_run = |(run, (course, by)): (usize, (&Course<'_>, &Distances))| -> Vec<(usize, usize)> {
        let is_found = |k: &usize| match course.errors[*k].is_nan() {
            true => limit > 0.0 && by.measured[*k] > FARTHER * farthest,
            false => is_spike(by.both[*k]),
        };
        let found = (0..course.errors.len()).filter(is_found);
        found.map(|k| (run, k)).collect()
    };
    let runs = courses.iter().zip(&distances).enumerate();
    runs.flat_map(of_run).collect()
}

/// How many times farther than all others a sample without error must stand out: the farthest of some others is no rare event.
const FARTHER: f64 = 1.5;

/// The quantile of what is usual; 0 of no values.
fn usual(mut values: Vec<f64>) -> f64 {
    let index = (SPIKE_SCALE_QUANTILE * values.len() as f64) as usize;
    match index < values.len() {
        true => *values.select_nth_unstable_by(index, f64::total_cmp).1,
        false => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A trapezoid with a bend of a few samples at each corner, and small noise.
    fn motion() -> Vec<f64> {
        let corner =
            |k: usize| ((k as f64 - 100.0) / 3.0).tanh() - ((k as f64 - 140.0) / 3.0).tanh();
        let noise = |k: usize| 0.01 * (0.7 * (k * k) as f64).sin();
        (0..300).map(|k| 5.0 * corner(k) + noise(k)).collect()
    }

    #[test]
    fn a_sample_that_leaves_the_course_of_both_sides_is_one_and_a_bend_is_none() {
        let found = |measured: &[f64], errors: &[f64]| {
            let in_motion = (0..300).map(|k| (85..155).contains(&k)).collect();
            spikes(&[Course {
                measured,
                errors,
                in_motion,
            }])
        };
        let clean = motion();
        assert!(found(&clean, &clean).is_empty());
        let mut glitches = clean.clone();
        glitches[50] += 8.0;
        glitches[103] -= 8.0;
        assert_eq!(found(&glitches, &glitches), [(0, 50), (0, 103)]);
        // A model that is wrong for one sample.
        assert!(found(&clean, &glitches).is_empty());
        // Before the history of a model there are no errors.
        glitches[20] += 8.0;
        let mut errors = glitches.clone();
        errors[..30].fill(f64::NAN);
        assert_eq!(found(&glitches, &errors), [(0, 20), (0, 50), (0, 103)]);
        errors[..45].copy_from_slice(&clean[..45]);
        glitches[20] -= 8.0;
        // Two samples in a row are no spike: a motion may be as fast.
        glitches[51] += 8.0;
        assert_eq!(found(&glitches, &glitches), [(0, 103)]);
    }
}
