//! Aliasing: the effect of frequencies above half the rate of sampling on those below.
//!
//! An input that is held between samples has a spectrum of its own at every ω + kω_s, ω_s being the rate of
//! sampling, and sampling folds what the servo answers there onto ω:
//!
//! ```text
//! G(e^{jωTs}) / H(ω) - G(jω) = Σ_{k≠0} G(j(ω + kω_s)) H(ω + kω_s) / H(ω),   |H(ω + kω_s) / H(ω)| = ω / |ω + kω_s|
//! ```
//!
//! with H the response of the hold, of [`Timing::magnitude_factor`](crate::data::timing::Timing::magnitude_factor)
//! 1/|H|. If |G| falls at least like a first-order lag, |G(jω)| <= r/ω, the sum is at most
//!
//! ```text
//! (r/ω) Σ_{k≠0} ω² / (ω + kω_s)² = (r/ω) (1/|H(ω)|² - 1)
//! ```
//!
//! which for a lag of 25 ms and samples every 2 ms moves the bandwidth by less than 0.2 %, and by a
//! hundred times as much when they are ten times as far apart. r is that of a first-order lag with the gain and bandwidth
//! of the servo, unless the upper half of the frequencies shows it to be less, or more.

use super::measured::Measured;
use crate::thresholds::FOLDED_POWER_DOUBT;

/// The part of a response that is folded from beyond half the rate of sampling.
pub(super) struct Folding {
    /// |G(jω)| ω is at most this beyond half the rate of sampling; infinite where that is not known.
    r: f64,
}

impl Folding {
    /// For a servo whose bandwidth is `bandwidth` \[rad/s\], if it has one.
    pub(super) fn new(measured: &Measured<'_>, bandwidth: Option<f64>) -> Self {
        let gain = measured.theta[0].abs();
        let of_lag = bandwidth.map_or(f64::INFINITY, |omega| gain * omega);
        let (at_least, at_most) = upper(measured);
        Self {
            r: if at_least > of_lag {
                at_most
            } else {
                at_most.min(of_lag)
            },
        }
    }

    /// Bound of what is folded into G(e^{jωTs}) at `omega` \[rad/s\], as a distance in the complex plane.
    pub(super) fn at(&self, measured: &Measured<'_>, omega: f64) -> f64 {
        let factor = measured.timing.magnitude_factor(omega);
        // At rest nothing is folded, however much there is; so it is where nothing is known of it.
        if omega == 0.0 || self.r.is_infinite() {
            return 0.0;
        }
        self.r / omega * (factor - 1.0 / factor)
    }
}

/// Bounds of the root mean square of |G(jω)| ω over the upper half of the frequencies, without what noise adds
/// to it.
fn upper(measured: &Measured<'_>) -> (f64, f64) {
    let basis = &measured.basis;
    let highest = basis.highest();
    let (mut power, mut noise) = (0.0, 0.0);
    let upper = highest.div_ceil(2).max(1)..=highest;
    let count = upper.clone().count();
    for l in upper {
        let omega = l as f64 * basis.fundamental() / measured.timing.sample_period_s;
        let scale = (omega * measured.timing.magnitude_factor(omega)).powi(2);
        for k in [2 * l - 1, 2 * l] {
            power += scale * measured.theta[k].powi(2);
            noise += scale * measured.covariance[(k, k)];
        }
    }
    if count == 0 {
        return (0.0, f64::INFINITY);
    }
    let count = count as f64;
    // Each power has the distribution of a sum of two squares.
    let (seen, doubt) = (power - noise, FOLDED_POWER_DOUBT * noise / count.sqrt());
    let mean = |power: f64| (power.max(0.0) / count).sqrt();
    (mean(seen - doubt), mean(seen.max(0.0) + doubt))
}

#[cfg(test)]
mod tests {
    use crate::results::Model;
    use crate::{Options, Record, identify};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    const PERIOD: f64 = 0.01;

    /// A lag of the given number of samples under random steps, sampled without a word of what it does
    /// between samples.
    fn of_lag(samples: f64) -> Model {
        of_lags([samples, samples])
    }

    /// Two lags side by side, each with half of the gain.
    fn of_lags(samples: [f64; 2]) -> Model {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let keep = samples.map(|samples| (-1.0 / samples).exp());
        let (mut input, mut output, mut states) = (Vec::new(), Vec::new(), [0.0; 2]);
        for _ in 0..300 {
            let level = random.random_range(-1.0..1.0);
            for _ in 0..random.random_range(2..20) {
                let noise: f64 = StandardNormal.sample(&mut random);
                // The input of a sample takes effect at the sample, whose output is still as before.
                input.push(level);
                output.push(f64::midpoint(states[0], states[1]) + 0.001 * noise);
                for (state, keep) in states.iter_mut().zip(keep) {
                    *state = keep * *state + (1.0 - keep) * level;
                }
            }
        }
        identify(
            &Record::of_run(PERIOD, &input, &output).unwrap(),
            &Options::default(),
        )
        .unwrap()
    }

    #[test]
    fn the_bandwidth_of_a_lag_is_inside_its_interval_however_few_samples_it_has() {
        for samples in [20.0, 5.0, 2.0] {
            let model = of_lag(samples);
            let exact = 1.0 / (samples * PERIOD);
            let found = model.metrics.bandwidth_rad_s;
            assert!(found.contains(exact), "{samples}: {found:?}, {exact}");
            // That is what folding does to it: it may be as much on the other side.
            let off = (found.value.unwrap() - exact).abs();
            let half = (found.upper.unwrap() - found.lower.unwrap()) / 2.0;
            assert!(
                half < 4.0 * off + 0.02 * exact,
                "{samples}: {found:?}, {exact}"
            );
        }
    }

    #[test]
    fn the_response_of_a_lag_is_inside_its_bounds_up_to_half_the_rate_of_sampling() {
        let model = of_lag(3.0);
        let omegas: Vec<f64> = (1..30).map(|k| 10.0 * f64::from(k)).collect();
        let found = model.servo_response(&omegas).unwrap();
        for (k, omega) in omegas.iter().enumerate() {
            let exact = -10.0 * (1.0 + (3.0 * PERIOD * omega).powi(2)).log10();
            let known = found.bounds.valid().unwrap();
            let bounds = known.magnitude_db_lower[k]..=known.magnitude_db_upper[k];
            assert!(bounds.contains(&exact), "{omega}: {exact} {bounds:?}");
        }
    }

    #[test]
    fn a_servo_with_more_at_high_frequencies_than_a_lag_of_its_bandwidth_is_seen_to_have_it() {
        let samples = [10.0, 0.25];
        let model = of_lags(samples);
        for omega in [5.0, 10.0, 20.0, 40.0, 100.0] {
            // Half of 1/(1 + jωT) each.
            let parts = samples.map(|samples| {
                let x = omega * samples * PERIOD;
                (0.5 / (1.0 + x * x), -0.5 * x / (1.0 + x * x))
            });
            let (re, im) = (parts[0].0 + parts[1].0, parts[0].1 + parts[1].1);
            let exact = im.atan2(re).to_degrees();
            let bounds = model.servo_response(&[omega]).unwrap().bounds;
            let known = bounds.valid().unwrap();
            let phase = known.phase_deg_lower[0]..=known.phase_deg_upper[0];
            assert!(phase.contains(&exact), "{omega}: {exact} {phase:?}");
        }
    }
}
