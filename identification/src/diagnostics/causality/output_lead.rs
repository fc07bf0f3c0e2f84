//! Whether the output moves before the input.
//!
//! A servo moves after its command. Where the output of a record is more like the input that comes later than like any that came
//! before, the two columns are exchanged, or the input follows the output:
//!
//! ```text
//! r(m) = correlation of u(k - m) and y(k);   max |r(m)| over m < 0  against  max |r(m)| over m >= 0
//! ```
//!
//! It needs no model, so it also speaks where none describes the record.

use crate::data::{Record, Run};
use crate::diagnostics::residuals::simulation_error::{SAMPLES, beginnings};
use crate::numerics::dot;
use crate::thresholds::{LEADING_ADVANTAGE, LEADING_CORRELATION};

/// Largest lag and lead \[samples\].
const LAGS: usize = 400;

/// A part of the longest run that lags and leads may have: the rest is what they are judged by.
const SHARE: usize = 4;

/// How far the output is ahead.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct OutputLead {
    /// Time by which the output is ahead of the input where the two are most alike \[s\].
    pub(crate) lead_s: f64,
    /// Correlation there.
    pub(crate) correlation: f64,
    /// Largest correlation with the input ahead.
    pub(crate) otherwise: f64,
}

/// The lead of the output, where it has one.
pub(crate) fn output_lead(record: &Record) -> Option<OutputLead> {
    let runs: Vec<Centred> = centred(&beginnings(record.runs(), SAMPLES).collect::<Vec<_>>());
    let longest = runs.iter().map(|run| run.input.len()).max()?;
    let lags = LAGS.min(longest / SHARE);
    let best = |ahead: fn(&Centred, usize) -> Sums, from: usize| {
        let at = |lag: usize| {
            let all = runs.iter().map(|run| ahead(run, lag));
            (lag, all.fold(Sums::default(), Sums::plus).correlation())
        };
        let all = (from..=lags).map(at);
        all.max_by(|(_, a), (_, b)| a.total_cmp(b))
    };
    let (_, otherwise) = best(|run, lag| run.sums(0, lag), 0)?;
    let (lead, correlation) = best(|run, lead| run.sums(lead, 0), 1)?;
    // At the end of the search the likeness is that of two trends.
    let found = lead < lags
        && correlation > LEADING_CORRELATION
        && correlation.powi(2) - otherwise.powi(2) > LEADING_ADVANTAGE;
    found.then(|| OutputLead {
        lead_s: lead as f64 * record.sample_period_s(),
        correlation,
        otherwise,
    })
}

/// A run less the means of the record; 0 where a sample is missing.
struct Centred {
    input: Vec<f64>,
    output: Vec<f64>,
}

fn centred<'a>(runs: &[Run<'a>]) -> Vec<Centred> {
    let less_mean = |of: for<'r> fn(&'r Run<'a>) -> &'r [f64]| -> Vec<Vec<f64>> {
        let known = || runs.iter().flat_map(of).filter(|value| !value.is_nan());
        let mean = known().sum::<f64>() / known().count().max(1) as f64;
        let less = |value: &f64| if value.is_nan() { 0.0 } else { value - mean };
        runs.iter()
            .map(|run| of(run).iter().map(less).collect())
            .collect()
    };
    let (inputs, outputs) = (less_mean(Run::input), less_mean(Run::output));
    let both = inputs.into_iter().zip(outputs);
    both.map(|(input, output)| Centred { input, output })
        .collect()
}

impl Centred {
    /// Of the pairs of input and output from these samples on.
    fn sums(&self, input_from: usize, output_from: usize) -> Sums {
        let count = self.input.len().saturating_sub(input_from.max(output_from));
        let (input, output) = (
            &self.input[input_from.min(self.input.len())..][..count],
            &self.output[output_from.min(self.output.len())..][..count],
        );
        Sums {
            both: dot(input, output),
            input: dot(input, input),
            output: dot(output, output),
        }
    }
}

/// Sums of products.
#[derive(Clone, Copy, Default)]
struct Sums {
    both: f64,
    input: f64,
    output: f64,
}

impl Sums {
    fn plus(self, other: Self) -> Self {
        Self {
            both: self.both + other.both,
            input: self.input + other.input,
            output: self.output + other.output,
        }
    }

    /// Its size; 0 where one of the two does not change.
    fn correlation(self) -> f64 {
        let scale = (self.input * self.output).sqrt();
        if scale > 0.0 {
            self.both.abs() / scale
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    /// A lag of 8 samples behind levels that are held for 15 samples, and a sine whose lag is a quarter of its period.
    #[test]
    fn exchanged_columns_lead_and_right_ones_do_not() {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(5);
        let levels: Vec<f64> = (0..60)
            .flat_map(|_| [random.random_range(-1.0..1.0); 15])
            .collect();
        let lag = |u: &[f64]| -> Vec<f64> {
            let noise = |y: f64, x: f64| y + 0.3 * x;
            let y: Vec<f64> = u
                .iter()
                .scan(0.0, |y, u| {
                    *y += (u - *y) / 8.0;
                    Some(*y)
                })
                .collect();
            let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(6);
            y.into_iter()
                .map(|y| noise(y, random.random_range(-1.0..1.0)))
                .collect()
        };
        let position = lag(&levels);
        let lead = |u: &[f64], y: &[f64]| output_lead(&Record::of_run(0.01, u, y).unwrap());
        assert_eq!(lead(&levels, &position), None);
        let found = lead(&position, &levels).unwrap();
        assert!((0.02..0.1).contains(&found.lead_s), "{found:?}");
        let sine = |from: f64| -> Vec<f64> {
            (0..900)
                .map(|k| ((f64::from(k) - from) / 10.0).sin())
                .collect()
        };
        assert_eq!(lead(&sine(0.0), &sine(15.7)), None);
        assert_eq!(lead(&sine(0.0), &sine(47.1)), None);
    }
}
