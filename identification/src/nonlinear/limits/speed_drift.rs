//! Whether strokes get slower along a record, or quicker, as under a supply that sags.
//!
//! ```text
//! ln v = a + b ln size + c t       an a of each group of strokes of like sizes, a b of strokes up and of strokes down, c of both
//! ```
//!
//! A servo that is slower later in the record has a c below 0, whatever its speed depends on. Strokes are held against others of their size alone: how the
//! speed grows with the size is no straight line, so that runs with strokes of other sizes would pass for a servo that changes from run to run.

use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::data::Stroke;
use crate::numerics::dot;
use crate::thresholds::{LAG_DRIFT_SIGNIFICANCE, SPEED_DRIFT};

/// Strokes in a group of like sizes: few, so that their sizes are alike, and enough that three quarters of what they show is left.
const LIKE: usize = 4;

/// The change of the speed from the first of the strokes `up` and `down` to the last, as a part of that of the first, where it is beyond chance and matters.
pub(super) fn speed_drift(up: &[Stroke], down: &[Stroke]) -> Option<f64> {
    let [up_left, down_left] = [up, down].map(left_by_size);
    let degrees = (up_left.degrees + down_left.degrees).checked_sub(1)? as f64;
    let times = [up_left.times, down_left.times].concat();
    let speeds = [up_left.speeds, down_left.speeds].concat();
    let square = dot(&times, &times);
    let slope = dot(&times, &speeds) / square;
    let left: f64 = (times.iter().zip(&speeds))
        .map(|(t, v)| (v - slope * t).powi(2))
        .sum();
    let t = slope / (left / degrees / square).sqrt();
    let p = 2.0 * StudentsT::new(0.0, 1.0, degrees).ok()?.sf(t.abs());
    let at = || up.iter().chain(down).map(|stroke| stroke.at);
    let change = f64::exp_m1(slope * (at().max()? - at().min()?) as f64);
    (p < LAG_DRIFT_SIGNIFICANCE && change.abs() > SPEED_DRIFT).then_some(change)
}

/// What the sizes of strokes in one direction leave.
struct LeftBySize {
    times: Vec<f64>,
    /// Logarithms of the speeds.
    speeds: Vec<f64>,
    /// Strokes less the coefficients that were taken out.
    degrees: usize,
}

/// That of the larger half of the strokes. Smaller ones may not come to the speed to which larger ones are limited.
fn left_by_size(strokes: &[Stroke]) -> LeftBySize {
    let mut strokes = strokes.to_vec();
    strokes.sort_by(|a, b| a.size.abs().total_cmp(&b.size.abs()));
    let groups = groups_of_like_sizes(&strokes[strokes.len() / 2..]);
    let of = |value: fn(&Stroke) -> f64| -> Vec<f64> {
        let within = |group: &Vec<Stroke>| {
            let mean = group.iter().map(value).sum::<f64>() / group.len() as f64;
            group.iter().map(|s| value(s) - mean).collect::<Vec<_>>()
        };
        groups.iter().flat_map(within).collect()
    };
    let sizes = of(|stroke| stroke.size.abs().ln());
    let square = dot(&sizes, &sizes);
    let without_size = |values: Vec<f64>| -> Vec<f64> {
        // Of strokes of one size there is no effect of it.
        let share = match square > 0.0 {
            true => dot(&values, &sizes) / square,
            false => 0.0,
        };
        let left = values.into_iter().zip(&sizes);
        left.map(|(value, size)| value - share * size).collect()
    };
    LeftBySize {
        times: without_size(of(|stroke| stroke.at as f64)),
        speeds: without_size(of(|stroke| stroke.mid_speed.ln())),
        degrees: sizes.len().saturating_sub(groups.len() + 1),
    }
}

/// Strokes, ascending by size, in groups of neighbours; those of one size are in one group.
fn groups_of_like_sizes(strokes: &[Stroke]) -> Vec<Vec<Stroke>> {
    let mut groups: Vec<Vec<Stroke>> = Vec::new();
    for stroke in strokes {
        let open = groups.last_mut().filter(|group| {
            let is_same = |last: &Stroke| last.size.abs() == stroke.size.abs();
            group.len() < LIKE || group.last().is_some_and(is_same)
        });
        match open {
            Some(group) => group.push(*stroke),
            None => groups.push(vec![*stroke]),
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stroke(at: usize, size: f64, speed: f64) -> Stroke {
        Stroke {
            at,
            size,
            travel: size,
            speed,
            mid_speed: speed,
            speeds: [speed; 3],
        }
    }

    /// Strokes of random sizes whose speed grows with the size up to a limit, which changes by this part along them.
    fn strokes(change: f64, seed: u32) -> Vec<Stroke> {
        let random = |k: u32| (f64::from(k + 1000 * seed).powi(2) * 0.754_877_666_2).fract();
        let of = |k: u32| {
            let size = 5.0 + 40.0 * random(7 * k + 1);
            let limit = 400.0 * (1.0 + change * f64::from(k) / 39.0);
            let speed = f64::min(20.0 * size, limit) * (1.0 + 0.04 * (random(11 * k + 3) - 0.5));
            stroke(100 * k as usize, size, speed)
        };
        (0..40).map(of).collect()
    }

    #[test]
    fn strokes_that_get_slower_are_found_and_others_are_not() {
        for seed in 0..40 {
            let of = |change: f64| speed_drift(&strokes(change, seed), &strokes(change, seed + 50));
            assert_eq!(of(0.0), None, "{seed}");
            for change in [-0.3, 0.2] {
                let found = of(change).unwrap();
                assert!((found - change).abs() < 0.05, "{seed}: {found}");
            }
        }
    }

    #[test]
    fn runs_of_other_strokes_are_no_change() {
        let random = |k: u32| (f64::from(k).powi(2) * 0.754_877_666_2).fract();
        // A motor comes to its speed over the stroke: random levels, small strokes and a switch, in each order.
        let kinds: [fn(f64) -> f64; 3] = [|r| 60.0 * r, |r| 8.0 * r, |_| 60.0];
        for order in [[0, 1, 2], [2, 0, 1], [2, 1, 0], [1, 0, 2]] {
            for change in [0.0, -0.2] {
                let of = |k: u32| {
                    let size = 0.1 + kinds[order[k as usize / 40]](random(7 * k + 1));
                    let limit = 580.0 * (1.0 + change * f64::from(k) / 119.0);
                    let built_up = 1.0 - (-0.08 * size).exp();
                    let speed = limit * built_up * (1.0 + 0.02 * (random(11 * k + 3) - 0.5));
                    stroke(100 * k as usize, size, speed)
                };
                let all: Vec<Stroke> = (0..120).map(of).collect();
                match (change, speed_drift(&all, &all)) {
                    (0.0, found) => assert_eq!(found, None, "{order:?}"),
                    (_, found) => assert!((found.unwrap() - change).abs() < 0.05, "{found:?}"),
                }
            }
        }
    }
}
