//! The noise of the sensor, from the samples at rest alone.
//!
//! Errors in motion hold what the equation does not know of the servo, and a noise model of all errors takes that for noise. At
//! rest such errors stand still: the scatter about the mean of each rest is that of the sensor.

use crate::estimation::{autoregressive, noise_filter};
use crate::servo_model::motion::simulated_motion::ServoMotion;

/// Samples at rest that show the noise.
const FEWEST: usize = 100;

/// Samples of a rest, at least: a shorter one says more of its own mean than of the noise.
const SHORTEST: usize = 8;

/// Highest order of the noise model: rests are short.
const HIGHEST_ORDER: usize = 4;

/// Lags up to which the noise is followed.
const LAGS: usize = 400;

/// Rounds in which the share of the noise that went with the means is found; each brings it closer by a factor of two or more
/// where rests are twice as long as the noise remembers.
const ROUNDS: usize = 20;

/// Autoregressive noise.
pub(crate) struct NoiseAtRest {
    /// 1, d_1..d_d.
    pub(crate) filter: Vec<f64>,
    /// Standard deviation of the white noise behind it.
    pub(crate) sigma: f64,
    /// Autocovariance at lags 0, 1, ..
    covariance: Vec<f64>,
}

impl NoiseAtRest {
    /// `None` where too little of the record is at rest to show it.
    pub(crate) fn new(motion: &ServoMotion, errors: &[Vec<f64>]) -> Option<Self> {
        let rests = rests(motion, errors);
        if rests.iter().map(Vec::len).sum::<usize>() < FEWEST {
            return None;
        }
        // The means take part of the noise with them: as much as the noise that is found says, which grows by that.
        let products: Vec<f64> = (0..=HIGHEST_ORDER)
            .map(|lag| mean_product(&rests, lag))
            .collect();
        let samples: usize = rests.iter().map(Vec::len).sum();
        let mut found = Self::of_covariance(products.clone(), samples);
        for _ in 0..ROUNDS {
            let of_mean = |rest: &Vec<f64>| rest.len() as f64 * found.variance_of_mean(rest.len());
            let lost = rests.iter().map(of_mean).sum::<f64>() / samples as f64;
            found = Self::of_covariance(products.iter().map(|r| r + lost).collect(), samples);
        }
        Some(found)
    }

    /// The noise whose autocovariance begins with these.
    fn of_covariance(mut covariance: Vec<f64>, samples: usize) -> Self {
        let products: Vec<f64> = covariance.iter().map(|r| r * samples as f64).collect();
        let (ar, sigma) = autoregressive(&products, samples);
        let (order, filter) = (ar.len(), noise_filter(&ar));
        // Yule-Walker: what an autoregressive model of this order says of longer lags.
        covariance.truncate(order + 1);
        while covariance.len() < LAGS {
            let late = filter[1..].iter().zip(covariance.iter().rev());
            covariance.push(-late.map(|(d, r)| d * r).sum::<f64>());
        }
        Self {
            filter,
            sigma,
            covariance,
        }
    }

    /// Sum of the squares of errors, made white and of variance 1 if they are this noise. Around missing ones nothing counts.
    pub(crate) fn white_squares(&self, errors: &[Vec<f64>]) -> f64 {
        let runs = errors.iter().flat_map(|run| run.windows(self.filter.len()));
        let white = runs.map(|run| -> f64 {
            let late = run.iter().rev();
            self.filter.iter().zip(late).map(|(d, e)| d * e).sum()
        });
        let known = white.filter(|white| !white.is_nan());
        known.map(|white| (white / self.sigma).powi(2)).sum()
    }

    /// Whether it averages out over `settling` samples, in which the servo settles. What gusts do to a shaft at rest does not, and passes for noise of the sensor.
    pub(super) fn averages_out(&self, settling: usize) -> bool {
        self.variance_of_mean(settling) < 0.5 * self.variance_of_mean(1)
    }

    /// Variance of the mean of `count` samples in a row.
    pub(crate) fn variance_of_mean(&self, count: usize) -> f64 {
        let known = self.covariance.iter().take(count).enumerate();
        let term = |(lag, r): (usize, &f64)| {
            let pairs = if lag == 0 { 1.0 } else { 2.0 };
            pairs * (1.0 - lag as f64 / count as f64) * r
        };
        (known.map(term).sum::<f64>() / count as f64).max(0.0)
    }
}

/// Errors of each rest less their mean.
fn rests(motion: &ServoMotion, errors: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut rests = Vec::new();
    for (at_rest, errors) in motion.at_rest.iter().zip(errors) {
        let mut at = 0;
        for part in at_rest.chunk_by(|a, b| a == b) {
            let own = &errors[at..at + part.len()];
            at += part.len();
            if part[0] && part.len() >= SHORTEST {
                let mean = own.iter().sum::<f64>() / own.len() as f64;
                rests.push(own.iter().map(|e| e - mean).collect());
            }
        }
    }
    rests
}

/// Mean of the products of samples `lag` apart in the same rest.
fn mean_product(rests: &[Vec<f64>], lag: usize) -> f64 {
    let pairs = || rests.iter().flat_map(|rest| rest.iter().zip(&rest[lag..]));
    pairs().map(|(a, b)| a * b).sum::<f64>() / pairs().count() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    /// AR(1) noise, v(k) = 0.8 v(k-1) + white, in rests of 50 samples that stand at levels of their own.
    #[test]
    fn noise_in_short_rests_is_that_of_the_sensor() {
        let mut random = ChaCha8Rng::seed_from_u64(61);
        let (mut errors, mut at_rest, mut noise) = (Vec::new(), Vec::new(), 0.0);
        for rest in 0..200 {
            for k in 0..60 {
                let white: f64 = StandardNormal.sample(&mut random);
                noise = 0.8 * noise + white;
                // Between two rests the errors are ten times as large.
                let moving = k >= 50;
                errors.push(if moving {
                    10.0 * noise
                } else {
                    noise + 3.0 * (rest % 7) as f64
                });
                at_rest.push(!moving);
            }
        }
        let motion = ServoMotion::resting(at_rest);
        let found = NoiseAtRest::new(&motion, &[errors]).unwrap();
        // Four standard errors of 10 000 samples: 0.6/100 for the coefficient, 1/141 for sigma. With the means of 50 samples left
        // in, it is 0.76.
        assert_eq!(found.filter.len(), 2);
        assert!((found.filter[1] + 0.8).abs() < 0.024, "{:?}", found.filter);
        assert!((found.sigma - 1.0).abs() < 0.03, "{}", found.sigma);
        // The noise that was found is of variance 1 when it is made white, whatever is missing.
        let count = 10_000;
        let mut same = vec![0.0; count];
        for k in 1..count {
            let white: f64 = StandardNormal.sample(&mut random);
            same[k] = 0.8 * same[k - 1] + white;
        }
        same[5000] = f64::NAN;
        let squares = found.white_squares(&[same]) / count as f64;
        assert!((squares - 1.0).abs() < 0.08, "{squares}");
        // σ²/(1 - 0.8)² for each sample of a long mean.
        let exact = 25.0 / 1000.0;
        assert!((found.variance_of_mean(1000) / exact - 1.0).abs() < 0.25);
    }

    /// Over 50 samples, in which a servo settles: noise of a sensor that remembers five averages out, and gusts that last for a hundred do not.
    #[test]
    fn what_is_as_slow_as_the_servo_does_not_average_out() {
        let of_pole = |pole: f64| {
            let covariance = (0..=HIGHEST_ORDER as i32)
                .map(|lag| pole.powi(lag))
                .collect();
            NoiseAtRest::of_covariance(covariance, 10_000).averages_out(50)
        };
        assert!(of_pole(0.0) && of_pole(0.8));
        assert!(!of_pole(0.99));
    }
}
