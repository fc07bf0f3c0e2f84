//! What the equation may lack without the record showing it.
//!
//! Errors of the equation change as slowly as the servo; noise averages out over such times. The mean squares of
//! errors averaged over windows, less what the noise at rest leaves there, are those of the discrepancy. Their upper
//! limit is taken, since bands and intervals have to hold for any discrepancy that the record does not exclude.

use super::noise_at_rest::NoiseAtRest;
use crate::numerics::chi_square_quantile;
use crate::servo_model::descent::coordinates::Point;
use crate::servo_model::motion::simulated_motion::ServoMotion;
use crate::thresholds::DISCREPANCY_MISSED;
use servoid_dynamics::Grid;

/// Windows in the time in which a servo settles.
pub(crate) const WINDOWS: usize = 8;

/// Time in which a servo settles at small signals \[1/ω\].
const SETTLING: f64 = 8.0;

/// Samples of a window: the servo settles in [`WINDOWS`] of them.
pub(crate) fn window(point: &Point, grid: &Grid) -> usize {
    let servo = point.physics(0, |_, value| value);
    let settling_s = servo.delay_s + SETTLING / servo.stiffness.sqrt();
    let settling = (settling_s / grid.period_s).ceil() as usize;
    settling.div_ceil(WINDOWS).max(1)
}

/// Upper limit of the root mean square of the discrepancy \[output\], at rest or in motion, whichever is larger.
pub(super) fn upper_limit(
    errors: &[Vec<f64>],
    motion: &ServoMotion,
    noise: &NoiseAtRest,
    window: usize,
) -> f64 {
    let (mut at_rest, mut moving) = (Vec::new(), Vec::new());
    for (errors, rest) in errors.iter().zip(&motion.at_rest) {
        for (errors, rest) in errors.chunks_exact(window).zip(rest.chunks_exact(window)) {
            let mean = errors.iter().sum::<f64>() / window as f64;
            let resting = rest.iter().filter(|rest| **rest).count();
            if mean.is_nan() {
                continue;
            }
            let side = if 2 * resting > window {
                &mut at_rest
            } else {
                &mut moving
            };
            side.push(mean * mean);
        }
    }
    let noise = noise.variance_of_mean(window);
    let limit = |squares: &[f64]| -> f64 {
        // The sum over what the variance is follows χ²; without windows nothing bounds it but the other side.
        let least = chi_square_quantile(DISCREPANCY_MISSED, squares.len());
        let largest = squares.iter().sum::<f64>() / least;
        if squares.is_empty() {
            0.0
        } else {
            largest - noise
        }
    };
    limit(&at_rest).max(limit(&moving)).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    /// Errors with a slow sine in motion below white noise: the limit holds what is there, and does not claim much more.
    #[test]
    fn the_limit_holds_a_discrepancy_below_the_noise() {
        let (samples, size) = (4000, 0.3);
        let mut within = 0;
        let runs = 200;
        for seed in 0..runs {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let at_rest: Vec<bool> = (0..samples).map(|k| k / 200 % 2 == 0).collect();
            let error = |k: usize| {
                let noise: f64 = StandardNormal.sample(&mut random);
                let slow = 2f64.sqrt() * size * (0.03 * k as f64).sin();
                if at_rest[k] { noise } else { noise + slow }
            };
            let errors = vec![(0..samples).map(error).collect::<Vec<f64>>()];
            let motion = ServoMotion::resting(at_rest);
            let noise = NoiseAtRest::new(&motion, &errors).unwrap();
            let limit = upper_limit(&errors, &motion, &noise, 10);
            within += u64::from(limit > size);
            assert!(limit < 2.0 * size, "{limit}");
        }
        // 99 % is promised where it varies as noise does; 95 % or less of 200 has a probability of 1 in 100 000 then.
        assert!(within >= 191, "{within} of {runs}");
    }
}
