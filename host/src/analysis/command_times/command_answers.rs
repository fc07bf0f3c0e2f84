//! By how much the answer to each change of the command is later than the model.
//!
//! Between two changes of the command, the errors e of the model and the speed s' of its output, both about their means, give the time by
//! which the answer to the first of them is later, τ = -Σ e s' / Σ s'². A drift, an offset of a run, or a load moves a hold as a whole, which
//! is in the means. A stroke that is shorter or longer than that of the model, as behind a dead band, moves τ as well, and is no later: the same from s' without what
//! the output of the model explains of it is the time beside the size of the stroke. Noise moves τ by its covariance r(l), which is that of what τ leaves of the errors:
//!
//! ```text
//! var τ = Σ_jk s'(j) s'(k) r(j - k) / (Σ s'²)²
//! ```

use servoid_identification::Run;
use servoid_identification::column::mean;
use servoid_identification::results::Model;

/// The answer to one change of the command.
pub(crate) struct CommandAnswer {
    /// The run, and the row in it at which the command changed.
    pub(crate) at: (usize, usize),
    /// The command before the change and after it.
    pub(crate) levels: [f64; 2],
    /// Later than the model by \[samples\].
    pub(crate) late: f64,
    /// The same beside the size of the stroke \[samples\].
    pub(crate) late_beside_size: f64,
    /// Sum of squares of the speed about its mean.
    pub(crate) weight: f64,
    /// The speed about its mean, and the errors that the lag does not explain.
    speeds: Vec<f64>,
    left: Vec<f64>,
}

impl CommandAnswer {
    /// Change of the command.
    pub(crate) fn stroke(&self) -> f64 {
        let [before, after] = self.levels;
        after - before
    }
}

/// The answers of a run, each from one change of the command to the next.
pub(crate) fn answers(index: usize, run: &Run<'_>, model: &Model) -> Vec<CommandAnswer> {
    let simulated = model.simulate(run);
    let speed = |beside: &[f64]| match beside {
        [before, _, after] => 0.5 * (after - before),
        _ => f64::NAN,
    };
    let end = || std::iter::once(f64::NAN);
    let speeds = end().chain(simulated.windows(3).map(speed)).chain(end());
    let both = run.output().iter().zip(&simulated).zip(speeds);
    let row = |((measured, position), speed): ((&f64, &f64), f64)| HeldRow {
        error: measured - position,
        position: *position,
        speed,
    };
    let commands = run.input().iter().copied();
    let rows: Vec<(f64, HeldRow)> = commands.zip(both.map(row)).collect();
    // The first hold answers what was before the run.
    let holds: Vec<_> = rows.chunk_by(|(a, _), (b, _)| a == b).collect();
    let pairs = holds.iter().zip(holds.iter().skip(1));
    let mut start = 0;
    pairs
        .filter_map(|(before, hold)| {
            start += before.len();
            let levels = [before.first()?.0, hold.first()?.0];
            let rows: Vec<HeldRow> = hold.iter().map(|(_, row)| *row).collect();
            answer((index, start), levels, &rows)
        })
        .collect()
}

/// A row of a hold: the error of the model, its output and the speed of that.
#[derive(Clone, Copy)]
struct HeldRow {
    error: f64,
    position: f64,
    speed: f64,
}

/// The answer within a hold, by its rows.
fn answer(at: (usize, usize), levels: [f64; 2], hold: &[HeldRow]) -> Option<CommandAnswer> {
    let is_known = |row: &&HeldRow| !(row.error * row.speed).is_nan();
    let known: Vec<HeldRow> = hold.iter().filter(is_known).copied().collect();
    let about_mean = |of: fn(&HeldRow) -> f64| {
        let mut values: Vec<f64> = known.iter().map(of).collect();
        let mean = mean(&values)?;
        values.iter_mut().for_each(|value| *value -= mean);
        Some(values)
    };
    let mut left = about_mean(|row| row.error)?;
    let speeds = about_mean(|row| row.speed)?;
    let positions = about_mean(|row| row.position)?;
    let [mut of_any_size, mut beside] = [left.clone(), speeds.clone()];
    take_out(&positions, &mut of_any_size);
    take_out(&positions, &mut beside);
    let late_beside_size = -take_out(&beside, &mut of_any_size);
    let late = -take_out(&speeds, &mut left);
    let weight = lagged_product(&speeds, 0);
    (weight > 0.0).then_some(CommandAnswer {
        at,
        levels,
        late,
        late_beside_size,
        weight,
        speeds,
        left,
    })
}

/// Takes a `part` out of `values` as far as it explains them, and returns how often; not a number where nothing is in it.
fn take_out(part: &[f64], values: &mut [f64]) -> f64 {
    let products = values.iter().zip(part).map(|(value, part)| value * part);
    let times = products.sum::<f64>() / lagged_product(part, 0);
    for (value, part) in values.iter_mut().zip(part) {
        *value -= times * part;
    }
    times
}

/// Lags of the covariance of noise: what lasts longer is in the means.
const LAGS: usize = 100;

/// The variance of the times that is noise \[samples²\], on average.
pub(crate) fn of_noise(answers: &[CommandAnswer]) -> f64 {
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

    /// The way of two lags of 10 rows, a row later or shorter by a tenth.
    #[test]
    fn a_shorter_stroke_is_no_later_one() {
        let way = |row: f64| 1.0 - (1.0 + row / 10.0) * (-row / 10.0).exp();
        let found = |measured: &dyn Fn(f64) -> f64| {
            let rows = (0..100u32).map(f64::from).map(|row| HeldRow {
                error: measured(row) - way(row),
                position: way(row),
                speed: row / 100.0 * (-row / 10.0).exp(),
            });
            answer((0, 0), [0.0; 2], &rows.collect::<Vec<_>>()).unwrap()
        };
        let later = found(&|row| way((row - 1.0).max(0.0)));
        assert!((0.8..1.2).contains(&later.late), "{}", later.late);
        let beside_size = later.late_beside_size;
        assert!((0.8..1.2).contains(&beside_size), "{beside_size}");
        let shorter = found(&|row| 0.9 * way(row));
        assert!(shorter.late.abs() > 0.5, "{}", shorter.late);
        assert!(shorter.late_beside_size.abs() < 1e-6);
    }

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
                HeldRow {
                    error: noise,
                    position: -15.0 * speed,
                    speed,
                }
            });
            answer((0, 0), [0.0; 2], &rows.collect::<Vec<_>>())
        };
        let answers: Vec<CommandAnswer> = (0..400).filter_map(&mut hold).collect();
        let square: f64 = answers.iter().map(|answer| answer.late.powi(2)).sum();
        let ratio = of_noise(&answers) * answers.len() as f64 / square;
        assert!((0.35..1.4).contains(&ratio), "{ratio}");
    }
}
