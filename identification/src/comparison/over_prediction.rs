//! By how much the first servo, driven like the second, goes farther than the second.
//!
//! P holds the samples of the second record at one end of its command, from a settling time w after
//! the edge to the next edge. With a the output there and â that of the first model driven by the
//! second record's own input, both from the sensor's zero,
//!
//! ```text
//! over-prediction  1 - sum_P a / sum_P â        at the plus end, and at the minus end
//! travel           1 - (a+ - a-) / (â+ - â-)    needs no zero
//! ```
//!
//! Plateaus are the units of scatter: with a_j the mean of plateau j, w_j its length, K their number,
//! s² = K/(K-1) sum (w_j (a_j - a))² / (sum w_j)², the interval is Student's with K-1 degrees of freedom
//! around (s/â)² + v (a/â²)² + (s_zero/â)² + (s_scale a/â)², v the variance of â and s_scale that of the ratio of both scales. Drift and scatter between runs are not in
//! it. It is wider by what the first model misses of its own record's plateaus, likewise: a line does not rest where a servo does that begins elsewhere, or is driven by
//! pulses that it knows at their ends.

use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::data::{EXACTLY, Hold, Record, Run, holds, mean_output};
use crate::numerics::{four_digits, with_unit};
use crate::results::{Interval, Model};

/// Over-prediction of the second servo by the first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OverPrediction {
    /// At the largest command \[%\]; empty where that is 0, of which nothing is a share, and where the output of a side neither goes to both sides of its zero nor
    /// has it where the command has its own: a sensor whose zero is another one.
    pub plus_percent: Interval,
    /// At the smallest command \[%\], likewise.
    pub minus_percent: Interval,
    /// Of the travel between the two \[%\].
    pub travel_percent: Interval,
    /// w \[samples\].
    pub wait_samples: usize,
    /// The definition of these percentages.
    pub definition: String,
}

/// The first servo, as far as the intervals rest on it.
pub(crate) struct Predictor<'a> {
    /// Model of the first servo.
    pub(crate) model: &'a Model,
    /// Standard deviation of its output at rest, at the largest and smallest command.
    pub(crate) sd_at_rest: [f64; 2],
    /// Standard deviation of the zero of the sensor between the two records.
    pub(crate) zero_sd: f64,
    /// Standard deviation of the ratio of their scales.
    pub(crate) scale_sd: f64,
    pub(crate) wait: usize,
    pub(crate) level: f64,
    /// Of input and output, for sentences; empty where they are not known.
    pub(crate) units: [&'a str; 2],
}

/// One end of the command.
struct End {
    /// Mean output, its standard deviation, plateaus.
    mean: f64,
    sd: f64,
    plateaus: usize,
    /// Mean prediction.
    predicted: f64,
}

/// An output at a command of zero beyond this share of the travel is that of a sensor whose zero is another one.
const OFF_ZERO: f64 = 0.1;

/// Whether the output counts from a zero that means something: it goes to both sides of it, or has it where the command has its own.
fn counts_from_zero([low, high]: [f64; 2], (minus, plus): (f64, f64)) -> bool {
    let travel = plus - minus;
    let at_zero = minus - travel / (high - low) * low;
    minus * plus <= 0.0 || (low * high >= 0.0 && at_zero.abs() <= OFF_ZERO * travel.abs())
}

/// Of the second record `b`, by the model of the first, `a`; `None` when the second has no two ends with two plateaus each.
pub(crate) fn over_prediction(
    [a, b]: [&Record; 2],
    predictor: &Predictor<'_>,
) -> Option<OverPrediction> {
    let found = of_record(b, predictor)?;
    Some(match of_record(a, predictor) {
        Some(own) => found.reaching(&own),
        None => found,
    })
}

impl OverPrediction {
    /// Wider by what the first model misses of its `own` record.
    fn reaching(self, own: &Self) -> Self {
        let wider = |of: Interval, own: Interval| match own.value.map(f64::abs) {
            Some(missed) if missed.is_finite() => of.reaching(missed, missed),
            _ => of,
        };
        Self {
            plus_percent: wider(self.plus_percent, own.plus_percent),
            minus_percent: wider(self.minus_percent, own.minus_percent),
            travel_percent: wider(self.travel_percent, own.travel_percent),
            ..self
        }
    }
}

/// Of one record.
fn of_record(record: &Record, predictor: &Predictor<'_>) -> Option<OverPrediction> {
    let levels: Vec<f64> = record
        .runs()
        .iter()
        .flat_map(|run| {
            holds(run, EXACTLY)
                .into_iter()
                .filter(|hold| hold.samples.len() > predictor.wait)
        })
        .map(|hold| hold.level)
        .collect();
    let high = levels.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let low = levels.iter().copied().fold(f64::INFINITY, f64::min);
    if high <= low {
        return None;
    }
    let (plus, minus) = (
        End::new(record, predictor, high)?,
        End::new(record, predictor, low)?,
    );
    let zero = predictor.zero_sd;
    let ends = [(minus.mean, plus.mean), (minus.predicted, plus.predicted)];
    let has_zero = (ends.iter()).all(|ends| counts_from_zero([low, high], *ends));
    let side = |level: f64, end: &End, sd_at_rest: f64| {
        if level == 0.0 || !has_zero {
            return Interval::new(f64::NAN, f64::NAN, f64::NAN);
        }
        let (a, b) = (end.mean, end.predicted);
        let variance = (end.sd / b).powi(2)
            + (sd_at_rest * a / (b * b)).powi(2)
            + (zero / b).powi(2)
            + (predictor.scale_sd * a / b).powi(2);
        interval(
            1.0 - a / b,
            variance.sqrt(),
            end.plateaus - 1,
            predictor.level,
        )
    };
    let (travel, predicted) = (plus.mean - minus.mean, plus.predicted - minus.predicted);
    // The zero cancels, and so does the offset; the gain's part adds up.
    let sd_predicted = predictor.sd_at_rest[0].hypot(predictor.sd_at_rest[1]);
    let variance = (plus.sd.hypot(minus.sd) / predicted).powi(2)
        + (sd_predicted * travel / (predicted * predicted)).powi(2)
        + (predictor.scale_sd * travel / predicted).powi(2);
    let degrees = plus.plateaus.min(minus.plateaus) - 1;
    let [input, output] = predictor.units;
    let with = |number: f64, unit: &str| with_unit(four_digits(number), unit);
    Some(OverPrediction {
        plus_percent: side(high, &plus, predictor.sd_at_rest[0]),
        minus_percent: side(low, &minus, predictor.sd_at_rest[1]),
        travel_percent: interval(
            1.0 - travel / predicted,
            variance.sqrt(),
            degrees,
            predictor.level,
        ),
        wait_samples: predictor.wait,
        definition: format!(
            "(predicted - measured) / predicted of the plateaus at {} (plus) and {} (minus), from \
             {} samples after the edge, of these recordings; predicted by the first model from the second's own input; {} and {} \
             plateaus; intervals are wider by what that model misses of its own plateaus; zero of the sensor {}",
            with(high, input),
            with(low, input),
            predictor.wait,
            plus.plateaus,
            minus.plateaus,
            if !has_zero {
                "not near that of the command, so that nothing is said of the two ends".to_owned()
            } else if zero > 0.0 {
                format!("known to {} (standard deviation)", with(zero, output))
            } else {
                "taken as exact".to_owned()
            }
        ),
    })
}

impl End {
    fn new(record: &Record, predictor: &Predictor<'_>, level: f64) -> Option<Self> {
        let mut plateaus: Vec<(f64, f64, f64)> = Vec::new();
        for run in record.runs() {
            let predicted = Run::new(run.input(), predictor.model.simulate(run)).ok()?;
            for Hold {
                samples,
                level: at,
                before,
            } in holds(run, EXACTLY)
            {
                let settled = samples.start + predictor.wait..samples.end;
                if at != level || before.is_none() || settled.len() < 2 {
                    continue;
                }
                // A prediction without full history is missing, and so is what goes with it.
                let known = settled.start
                    + predicted.output()[settled.clone()]
                        .iter()
                        .take_while(|y| y.is_nan())
                        .count();
                let settled = known..settled.end;
                let means =
                    mean_output(run, settled.clone()).zip(mean_output(&predicted, settled.clone()));
                if let Some((measured, predicted)) = means {
                    plateaus.push((settled.len() as f64, measured, predicted));
                }
            }
        }
        let count = plateaus.len();
        if count < 2 {
            return None;
        }
        let weight: f64 = plateaus.iter().map(|p| p.0).sum();
        let mean = |of: fn(&(f64, f64, f64)) -> f64| {
            plateaus.iter().map(|p| p.0 * of(p)).sum::<f64>() / weight
        };
        let (measured, predicted) = (mean(|p| p.1), mean(|p| p.2));
        let square: f64 = plateaus
            .iter()
            .map(|p| (p.0 * (p.1 - measured)).powi(2))
            .sum();
        let correction = count as f64 / (count - 1) as f64;
        Some(Self {
            mean: measured,
            sd: (correction * square).sqrt() / weight,
            plateaus: count,
            predicted,
        })
    }
}

/// In percent.
fn interval(value: f64, sd: f64, degrees: usize, level: f64) -> Interval {
    let critical = StudentsT::new(0.0, 1.0, degrees as f64)
        .map_or(f64::INFINITY, |t| t.inverse_cdf(0.5 + level / 2.0));
    let half = critical * sd;
    Interval::new(
        100.0 * value,
        100.0 * (value - half),
        100.0 * (value + half),
    )
}
