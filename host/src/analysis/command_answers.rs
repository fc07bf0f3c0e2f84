//! By how much the answer to each change of the command is later than the model.
//!
//! Between two changes of the command, the errors e of the model and the speed s' of its output, both about their means, give the time by
//! which the answer to the first of them is later, τ = -Σ e s' / Σ s'². A drift, an offset of a run, or a load moves a hold as a whole, which
//! is in the means. Noise moves τ by its covariance r(l), which is that of what τ leaves of the errors:
//!
//! ```text
//! var τ = Σ_jk s'(j) s'(k) r(j - k) / (Σ s'²)²
//! ```

use servoid_identification::Run;
use servoid_identification::column::mean;
use servoid_identification::results::Model;

/// The answer to one change of the command.
pub(super) struct CommandAnswer {
    /// The run, and the row in it at which the command changed.
    pub(super) at: (usize, usize),
    /// The command before the change and after it.
    pub(super) levels: [f64; 2],
    /// Later than the model by \[samples\].
    pub(super) late: f64,
    /// Sum of squares of the speed about its mean.
    pub(super) weight: f64,
    /// The speed about its mean, and the errors that the lag does not explain.
    speeds: Vec<f64>,
    left: Vec<f64>,
}

impl CommandAnswer {
    /// Change of the command.
    pub(super) fn stroke(&self) -> f64 {
        let [before, after] = self.levels;
        after - before
    }
}

/// The answers of a run, each from one change of the command to the next.
pub(super) fn answers(index: usize, run: &Run<'_>, model: &Model) -> Vec<CommandAnswer> {
    let simulated = model.simulate(run);
    let speed = |beside: &[f64]| match beside {
        [before, _, after] => 0.5 * (after - before),
        _ => f64::NAN,
    };
    let speeds = std::iter::once(f64::NAN).chain(simulated.windows(3).map(speed));
    let both = run.output().iter().zip(&simulated);
    let errors = both.map(|(measured, simulated)| measured - simulated);
    let rows: Vec<(f64, (f64, f64))> =
        (run.input().iter().copied().zip(errors.zip(speeds))).collect();
    // The first hold answers what was before the run.
    let holds: Vec<_> = rows.chunk_by(|(a, _), (b, _)| a == b).collect();
    let pairs = holds.iter().zip(holds.iter().skip(1));
    let mut row = 0;
    pairs
        .filter_map(|(before, hold)| {
            row += before.len();
            let levels = [before.first()?.0, hold.first()?.0];
            answer((index, row), levels, hold)
        })
        .collect()
}

/// The answer within a hold, by its rows of command, error and speed.
fn answer(
    at: (usize, usize),
    levels: [f64; 2],
    hold: &[(f64, (f64, f64))],
) -> Option<CommandAnswer> {
    let known = hold.iter().map(|(_, pair)| *pair);
    let known = known.filter(|(error, speed)| !(error * speed).is_nan());
    let (mut left, mut speeds): (Vec<f64>, Vec<f64>) = known.unzip();
    for values in [&mut left, &mut speeds] {
        let mean = mean(values)?;
        values.iter_mut().for_each(|value| *value -= mean);
    }
    let weight = lagged_product(&speeds, 0);
    let product: f64 = left.iter().zip(&speeds).map(|(e, s)| e * s).sum();
    let late = -product / weight;
    for (error, speed) in left.iter_mut().zip(&speeds) {
        *error += late * speed;
    }
    (weight > 0.0).then_some(CommandAnswer {
        at,
        levels,
        late,
        weight,
        speeds,
        left,
    })
}

/// Lags of the covariance of noise: what lasts longer is in the means.
const LAGS: usize = 100;

/// The variance of the times that is noise \[samples²\], on average.
pub(super) fn of_noise(answers: &[CommandAnswer]) -> f64 {
    let of_lag = |lag: usize| {
        let rows = |answer: &CommandAnswer| answer.left.len().saturating_sub(lag);
        let count: usize = answers.iter().map(rows).sum();
        let product = |answer: &CommandAnswer| lagged_product(&answer.left, lag);
        let covariance = answers.iter().map(product).sum::<f64>() / count.max(1) as f64;
        let share = |answer: &CommandAnswer| {
            lagged_product(&answer.speeds, lag) / (answer.weight * answer.weight)
        };
        let both_ways = if lag == 0 { 1.0 } else { 2.0 };
        both_ways * covariance * answers.iter().map(share).sum::<f64>()
    };
    (0..=LAGS).map(of_lag).sum::<f64>() / answers.len() as f64
}

/// Σ x(k) x(k + lag).
fn lagged_product(values: &[f64], lag: usize) -> f64 {
    let later = values.iter().skip(lag);
    values
        .iter()
        .zip(later)
        .map(|(now, later)| now * later)
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Pulses of speed of 15 rows in noise v(k) = 0.9 v(k-1) + ε(k), which moves times by 12 times the variance of white noise of as much. Means of holds
    /// take some of the slowest noise with them.
    #[test]
    fn the_variance_of_times_is_that_of_slow_noise() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let mut noise = 0.0;
        let mut hold = |_: u32| {
            let rows = (0..80u32).map(|row| {
                noise = 0.9 * noise + random.random_range(-0.5..0.5);
                let speed = (-f64::from(row) / 15.0).exp();
                (1.0, (noise, speed))
            });
            answer((0, 0), [0.0; 2], &rows.collect::<Vec<_>>())
        };
        let answers: Vec<CommandAnswer> = (0..400).filter_map(&mut hold).collect();
        let square: f64 = answers.iter().map(|answer| answer.late.powi(2)).sum();
        let ratio = of_noise(&answers) * answers.len() as f64 / square;
        assert!((0.35..1.4).contains(&ratio), "{ratio}");
    }
}
