//! Whether strokes get slower along a record, or quicker, as under a supply that sags.
//!
//! ```text
//! ln v = a + b ln size + c t       a and b of strokes up and of strokes down, c of both
//! ```
//!
//! A servo that is slower later in the record has a c below 0, whatever its speed depends on. Sizes that change along the record are in b.

use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::data::Stroke;
use crate::numerics::dot;
use crate::thresholds::{LAG_DRIFT_SIGNIFICANCE, SPEED_DRIFT};

/// The change of the speed from the first of the strokes `up` and `down` to the last, as a part of that of the first, where it is beyond chance and matters.
pub(super) fn speed_drift(up: &[Stroke], down: &[Stroke]) -> Option<f64> {
    let of_each = [up, down].map(left_by_size);
    let (times, speeds): (Vec<f64>, Vec<f64>) = of_each.into_iter().flatten().unzip();
    // Two coefficients of each direction, and c.
    let degrees = times.len().checked_sub(6)? as f64;
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

/// The times of the larger half of the strokes and the logarithms of their speeds, less what goes with the logarithms of their sizes. Smaller ones may not
/// come to the speed to which larger ones are limited, which is no straight line.
fn left_by_size(strokes: &[Stroke]) -> Vec<(f64, f64)> {
    let mut strokes = strokes.to_vec();
    strokes.sort_by(|a, b| a.size.abs().total_cmp(&b.size.abs()));
    let larger = &strokes[strokes.len() / 2..];
    let of = |value: fn(&Stroke) -> f64| -> Vec<f64> {
        let mean = larger.iter().map(value).sum::<f64>() / larger.len() as f64;
        larger.iter().map(|stroke| value(stroke) - mean).collect()
    };
    let sizes = of(|stroke| stroke.size.abs().ln());
    let square = dot(&sizes, &sizes);
    let without_size = |values: Vec<f64>| {
        // Of strokes of one size there is no effect of it.
        let share = match square > 0.0 {
            true => dot(&values, &sizes) / square,
            false => 0.0,
        };
        let left = values.into_iter().zip(&sizes);
        left.map(|(value, size)| value - share * size).collect()
    };
    let times: Vec<f64> = without_size(of(|stroke| stroke.at as f64));
    let speeds: Vec<f64> = without_size(of(|stroke| stroke.mid_speed.ln()));
    times.into_iter().zip(speeds).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Strokes of random sizes whose speed grows with the size up to a limit, which changes by this part along them.
    fn strokes(change: f64, seed: u32) -> Vec<Stroke> {
        let random = |k: u32| (f64::from(k + 1000 * seed).powi(2) * 0.754_877_666_2).fract();
        let of = |k: u32| {
            let size = 5.0 + 40.0 * random(7 * k + 1);
            let limit = 400.0 * (1.0 + change * f64::from(k) / 39.0);
            let speed = f64::min(20.0 * size, limit) * (1.0 + 0.04 * (random(11 * k + 3) - 0.5));
            Stroke {
                at: 100 * k as usize,
                size,
                travel: size,
                speed,
                mid_speed: speed,
                speeds: [speed; 3],
            }
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
}
