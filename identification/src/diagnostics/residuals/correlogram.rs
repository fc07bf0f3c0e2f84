//! Correlations of the residuals, lag by lag, for the plots beside the tests of
//! [`crate::diagnostics::residuals::residual_tests`].
//!
//! ε are the one-step errors and u_D = D(z) u the filtered input, over the samples at which ε is known. The
//! correlations
//!
//! ```text
//! r_ε(τ)  = sum ε(k) ε(k-τ) / sum ε²             r_u(τ) = sum ε(k) u_D(k-τ) / sqrt(sum ε² sum u_D²)
//! ```
//!
//! have a standard deviation of 1/sqrt(pairs) when ε is white and independent of u. It is smaller at lags
//! that the fit has used: the noise order takes the first lags of r_ε, and least squares makes r_u vanish
//! for 0 <= τ < N. Of all other lags a share of 1 - level lies outside the bound by chance.

use std::ops::RangeInclusive;

use crate::data::{Record, Run};
use crate::numerics::pointwise_critical;
use crate::results::Model;

/// Correlation over lags.
#[derive(Debug, Clone, PartialEq)]
pub struct Correlogram {
    /// τ \[samples\].
    pub lags: Vec<isize>,
    /// Correlation, between -1 and 1.
    pub value: Vec<f64>,
    /// Half width of the range that holds each value with probability `level` if ε is white and
    /// independent of u.
    pub bound: f64,
}

impl Correlogram {
    /// Correlation of the one-step errors of `model` on `record` with themselves, at lags 1 to `lags`.
    /// `None` without two errors.
    #[must_use]
    pub fn of_errors(model: &Model, record: &Record, lags: usize, level: f64) -> Option<Self> {
        let errors = errors(model, record);
        let pairs = errors.iter().map(|run| (run.as_slice(), run.as_slice()));
        correlogram(&pairs.collect::<Vec<_>>(), 1..=lags as isize, level)
    }

    /// Correlation of the one-step errors of `model` on `record` with its filtered input: a positive lag is
    /// an input before the error. `None` without two errors.
    #[must_use]
    pub fn with_input(
        model: &Model,
        record: &Record,
        lags: RangeInclusive<isize>,
        level: f64,
    ) -> Option<Self> {
        let errors = errors(model, record);
        let inputs = inputs(model, record);
        let pairs = errors.iter().zip(&inputs);
        let pairs: Vec<_> = pairs.map(|(e, u)| (e.as_slice(), u.as_slice())).collect();
        correlogram(&pairs, lags, level)
    }
}

/// One-step errors by run, NaN where unknown.
fn errors(model: &Model, record: &Record) -> Vec<Vec<f64>> {
    let of = |run: &Run| {
        let pairs = run.output().iter().zip(model.predict(run));
        pairs.map(|(y, p)| y - p).collect()
    };
    record.runs().iter().map(of).collect()
}

/// D(z) u by run, without its mean, which the offset explains; NaN where unknown.
fn inputs(model: &Model, record: &Record) -> Vec<Vec<f64>> {
    let of = |run: &Run| {
        let u = run.input();
        (0..u.len())
            .map(|k| u[k] + model.noise_memory(u, k))
            .collect()
    };
    let mut filtered: Vec<Vec<f64>> = record.runs().iter().map(of).collect();
    let known = filtered.iter().flatten().filter(|u| !u.is_nan());
    let (count, sum) = known.fold((0usize, 0.0), |(n, sum), u| (n + 1, sum + u));
    let mean = sum / count.max(1) as f64;
    filtered.iter_mut().flatten().for_each(|u| *u -= mean);
    filtered
}

/// The residuals of a run, and the signal that they are compared with.
type Pair<'a> = (&'a [f64], &'a [f64]);

fn correlogram(pairs: &[Pair<'_>], lags: RangeInclusive<isize>, level: f64) -> Option<Correlogram> {
    let over_runs = |of: &dyn Fn(&Pair<'_>) -> (usize, f64)| {
        let add = |(n, sum): (usize, f64), (m, more): (usize, f64)| (n + m, sum + more);
        pairs.iter().map(of).fold((0, 0.0), add)
    };
    let (count, square) = over_runs(&|(e, _)| lagged_product(e, e, 0));
    let (others, square_of_other) = over_runs(&|(_, x)| lagged_product(x, x, 0));
    let scale = (square / count.max(1) as f64 * square_of_other / others.max(1) as f64).sqrt();
    if count < 2 || scale.is_nan() || scale <= 0.0 {
        return None;
    }
    let lags: Vec<isize> = lags.collect();
    let correlation = |&lag: &isize| match over_runs(&|(e, x)| lagged_product(e, x, lag)) {
        (0, _) => 0.0,
        (n, sum) => sum / (n as f64 * scale),
    };
    let value = lags.iter().map(correlation).collect();
    Some(Correlogram {
        lags,
        value,
        bound: pointwise_critical(level) / (count as f64).sqrt(),
    })
}

/// Number of pairs e(k), x(k - lag) that are known, and the sum of their products.
fn lagged_product(e: &[f64], x: &[f64], lag: isize) -> (usize, f64) {
    (0..e.len())
        .filter_map(|k| Some(e[k] * x.get(k.checked_add_signed(-lag)?)?))
        .filter(|product| !product.is_nan())
        .fold((0, 0.0), |(n, sum), product| (n + 1, sum + product))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::{NoiseOrder, Options, Settling};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    /// A servo of first order with noise that remembers `memory` of its last value.
    fn record(seed: u64, memory: f64) -> Record<'static> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let u: Vec<f64> = (0..2000)
            .scan(1.0, |u, _| {
                *u *= if random.random_bool(0.1) { -1.0 } else { 1.0 };
                Some(*u)
            })
            .collect();
        let mut random = ChaCha8Rng::seed_from_u64(seed + 1000);
        let (mut servo, mut noise) = (0.0, 0.0);
        let y: Vec<f64> = u
            .iter()
            .map(|u| {
                servo += 0.3 * (u - servo);
                noise = memory * noise + 0.05 * random.sample::<f64, _>(StandardNormal);
                servo + noise
            })
            .collect();
        Record::of_run(0.01, u, y).unwrap()
    }

    fn identified(record: &Record, order: NoiseOrder) -> Model {
        let options = Options {
            settling: Settling::Samples(41),
            noise_order: order,
            ..Options::default()
        };
        crate::identify(record, &options).unwrap()
    }

    fn outside(found: &Correlogram) -> usize {
        let beyond = |r: &&f64| r.abs() > found.bound;
        found.value.iter().filter(beyond).count()
    }

    #[test]
    fn white_errors_stay_within_their_bounds_at_the_stated_level() {
        let mut count = (0, 0);
        for seed in 0..8 {
            let record = record(seed, 0.0);
            let model = identified(&record, NoiseOrder::Order(0));
            let errors = Correlogram::of_errors(&model, &record, 25, 0.99).unwrap();
            let inputs = Correlogram::with_input(&model, &record, -20..=60, 0.99).unwrap();
            count.0 += outside(&errors);
            count.1 += inputs
                .lags
                .iter()
                .zip(&inputs.value)
                .filter(|(lag, r)| !(0..41).contains(*lag) && r.abs() > inputs.bound)
                .count();
            // Least squares leaves nothing at the lags that it has fitted.
            let fitted = inputs.lags.iter().zip(&inputs.value);
            let worst = fitted
                .filter(|(lag, _)| (0..41).contains(*lag))
                .map(|(_, r)| r.abs())
                .fold(0.0, f64::max);
            assert!(worst < 0.1 * inputs.bound, "{worst} of {}", inputs.bound);
        }
        // 1 % of 200 and of 320, neighbours related: 2 and 3 expected; nine has a probability below 0.1 % of
        // each if they were independent.
        assert!(count.0 < 9 && count.1 < 12, "{count:?}");
    }

    #[test]
    fn coloured_errors_and_a_response_that_is_cut_off_stand_out() {
        let coloured = record(3, 0.6);
        let model = identified(&coloured, NoiseOrder::Order(0));
        let found = Correlogram::of_errors(&model, &coloured, 25, 0.99).unwrap();
        assert!((found.value[0] - 0.6).abs() < 0.08, "{}", found.value[0]);
        assert!(found.value[0] > 5.0 * found.bound);

        let clean = record(3, 0.0);
        let options = Options {
            settling: Settling::Samples(7),
            noise_order: NoiseOrder::Order(0),
            ..Options::default()
        };
        let short = crate::identify(&clean, &options).unwrap();
        let found = Correlogram::with_input(&short, &clean, 7..=12, 0.99).unwrap();
        assert!(
            found.value.iter().any(|r| r.abs() > found.bound),
            "{found:?}"
        );
    }
}
