//! Single samples that stand out from the straight lines on both sides of them.
//!
//! A servo that is not linear misses its linear model in motion, where a glitch is then one large error among many. Its shape
//! sets it apart: the motion bends, and no motion leaves its course and is back on it two samples later.

use crate::thresholds::{SPIKE, SPIKE_SCALE_QUANTILE};

/// The distance of sample `k` from the lines through the two samples before and the two after it, where it is on one side of both:
/// the smaller of the two. 0 elsewhere, and where one of these samples is missing.
fn stands_out(errors: &[f64], k: usize) -> f64 {
    let (Some([a, b]), Some([c, d])) = (
        k.checked_sub(2).and_then(|from| errors.get(from..k)),
        errors.get(k + 1..k + 3),
    ) else {
        return 0.0;
    };
    let (before, after) = (errors[k] - (2.0 * b - a), errors[k] - (2.0 * c - d));
    match before * after > 0.0 {
        true => before.abs().min(after.abs()),
        false => 0.0,
    }
}

/// The spikes among the errors of each run, as indices of run and sample. `in_motion` is true where the servo moves: what
/// stands out there is compared with what usually does.
pub(super) fn spikes(errors: &[&[f64]], in_motion: &[Vec<bool>]) -> Vec<(usize, usize)> {
    let all = || {
        let runs = errors.iter().zip(in_motion).enumerate();
        runs.flat_map(|(run, (errors, moving))| {
            (0..errors.len()).map(move |k| (run, k, stands_out(errors, k), moving[k]))
        })
    };
    let limit = |of_motion: bool| {
        let mut usual: Vec<f64> = all()
            .filter(|(.., moving)| *moving == of_motion)
            .map(|(_, _, by, _)| by)
            .collect();
        usual.sort_by(f64::total_cmp);
        let index = (SPIKE_SCALE_QUANTILE * usual.len() as f64) as usize;
        SPIKE * usual.get(index).copied().unwrap_or(0.0)
    };
    let (at_rest, in_motion) = (limit(false), limit(true));
    // Motion bends at its beginning and end, too, where it hardly counts as motion.
    let limit = at_rest.max(in_motion);
    all()
        .filter(|(_, _, by, _)| *by > limit && limit > 0.0)
        .map(|(run, k, ..)| (run, k))
        .collect()
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
        let mut errors = motion();
        let moving = vec![(0..300).map(|k| (85..155).contains(&k)).collect()];
        assert!(spikes(&[&errors], &moving).is_empty());
        errors[50] += 8.0;
        errors[103] -= 8.0;
        assert_eq!(spikes(&[&errors], &moving), [(0, 50), (0, 103)]);
        // Two samples in a row are no spike: a motion may be as fast.
        errors[51] += 8.0;
        assert_eq!(spikes(&[&errors], &moving), [(0, 103)]);
    }
}
