//! The simulation of a record by a fit, and its errors.
//!
//! Tests of the errors look at the beginning of a record only.

use faer::Mat;

use super::residual_tests::ScoreTest;
use crate::data::{Moments, Record, Run};
use crate::estimation::{GlsFit, RowInformation};
use crate::numerics::{causal_filter, dot};

/// Sum of squares of the simulation error of a fit, over the rows of `information`.
pub(crate) fn square(information: &RowInformation, fit: &GlsFit) -> f64 {
    information.residual_moments(&fit.impulse(), fit.solution.offset(), 0)[(0, 0)].max(0.0)
}

/// Samples at the beginning of a record that are looked at: what cannot be seen in them is too small
/// to matter.
pub(crate) const SAMPLES: usize = 1 << 15;

/// One run, or its beginning; simulation and errors are relative to the centre of the moments.
pub(crate) struct Simulated<'a> {
    pub(crate) run: Run<'a>,
    /// ŷ(k); NaN where an input is missing.
    pub(crate) output: Vec<f64>,
    /// y(k) - ŷ(k); NaN where either is missing.
    pub(crate) errors: Vec<f64>,
    /// What a gain, a delay and an offset of its own leave of the errors, where there are several runs.
    own_errors: Option<Vec<f64>>,
}

impl Simulated<'_> {
    /// The change of the output per sample: half the difference of its neighbours; at the ends of a stretch
    /// there is one neighbour only. NaN where the output is.
    pub(crate) fn speed(&self) -> Vec<f64> {
        self.speed_over(1)
    }

    /// The same, of neighbours that are `apart` samples away.
    pub(crate) fn speed_over(&self, apart: usize) -> Vec<f64> {
        let twice = 2.0 * apart as f64;
        (0..self.output.len())
            .map(|k| {
                let now = self.output[k];
                let neighbour = |k: usize| match self.output.get(k) {
                    Some(s) if !s.is_nan() => *s,
                    _ => now,
                };
                (neighbour(k + apart) - neighbour(k.wrapping_sub(apart))) / twice
            })
            .collect()
    }

    /// The errors but for what runs differ by: of a single run, all of them.
    pub(crate) fn own_errors(&self) -> &[f64] {
        self.own_errors.as_deref().unwrap_or(&self.errors)
    }

    /// Whether there are other runs beside it.
    pub(crate) fn is_one_of_several(&self) -> bool {
        self.own_errors.is_some()
    }

    /// What a gain, a delay and an offset of its own leave of the errors.
    fn without_own_numbers(&self) -> Vec<f64> {
        let row = |k: usize, speed: &[f64]| [self.output[k], speed[k], 1.0];
        let speed = self.speed();
        let mut moments = Mat::<f64>::zeros(3, 3);
        let mut score = [0.0; 3];
        for (k, error) in self.errors.iter().enumerate().filter(|(_, e)| !e.is_nan()) {
            let row = row(k, &speed);
            for i in 0..3 {
                score[i] += row[i] * error;
                for j in 0..3 {
                    moments[(i, j)] += row[i] * row[j];
                }
            }
        }
        let Some(found) = ScoreTest::new(&moments, &moments, &score) else {
            return self.errors.clone();
        };
        let left = |(k, error): (usize, &f64)| error - dot(&row(k, &speed), &found.coefficients);
        self.errors.iter().enumerate().map(left).collect()
    }
}

/// Root mean square of what [`Simulated::own_errors`] are free of.
pub(crate) fn explained_by_runs(runs: &[Simulated<'_>]) -> f64 {
    let (mut square, mut count) = (0.0, 0usize);
    for run in runs {
        let own = run.own_errors();
        for (error, own) in run.errors.iter().zip(own).filter(|(e, _)| !e.is_nan()) {
            square += (error - own).powi(2);
            count += 1;
        }
    }
    (square / count.max(1) as f64).sqrt()
}

/// The runs of a record up to [`SAMPLES`], by the response of `fit`, which is one of `moments`. Under the prior of a smooth input all of them: a sweep comes to
/// its last frequencies at its end.
pub(crate) fn simulated<'a>(
    record: &'a Record<'a>,
    moments: &Moments,
    fit: &GlsFit,
) -> Vec<Simulated<'a>> {
    let samples = match fit.precision > 0.0 {
        true => usize::MAX,
        false => SAMPLES,
    };
    simulated_up_to(samples, record, moments, fit)
}

/// All runs of a record, as [`simulated`].
pub(crate) fn simulated_whole<'a>(
    record: &'a Record<'a>,
    moments: &Moments,
    fit: &GlsFit,
) -> Vec<Simulated<'a>> {
    simulated_up_to(usize::MAX, record, moments, fit)
}

fn simulated_up_to<'a>(
    samples: usize,
    record: &'a Record<'a>,
    moments: &Moments,
    fit: &GlsFit,
) -> Vec<Simulated<'a>> {
    let (impulse, offset) = (fit.impulse(), fit.solution.offset());
    let centre = moments.centre;
    let mut runs: Vec<Simulated<'a>> = beginnings(record.runs(), samples)
        .map(|run| {
            let input: Vec<f64> = run.input().iter().map(|u| u - centre.0).collect();
            let at_rest = run.input_at_rest().map(|u| u - centre.0);
            let mut output = causal_filter(&impulse, &input, at_rest);
            for value in &mut output {
                *value += offset;
            }
            let of_output = |(y, s): (&f64, &f64)| y - centre.1 - s;
            let errors = run.output().iter().zip(&output).map(of_output).collect();
            Simulated {
                run,
                output,
                errors,
                own_errors: None,
            }
        })
        .collect();
    if runs.len() > 1 {
        for run in &mut runs {
            run.own_errors = Some(run.without_own_numbers());
        }
    }
    runs
}

/// The first `samples` samples of `runs`, run by run.
pub(crate) fn beginnings<'a>(runs: &'a [Run<'a>], samples: usize) -> impl Iterator<Item = Run<'a>> {
    runs.iter()
        .scan(samples, |left, run| {
            let taken = run.len().min(*left);
            *left -= taken;
            Some(run.part(0..taken))
        })
        .filter(|run| !run.is_empty())
}

/// ε(k) = D(z) v(k) of the simulation errors v; NaN where a value or its history is missing.
pub(crate) fn one_step_errors(errors: &[f64], ar: &[f64]) -> Vec<f64> {
    let order = ar.len();
    let mut filtered = vec![f64::NAN; errors.len().min(order)];
    filtered.extend(errors.windows(order + 1).map(|window| {
        let (past, now) = window.split_at(order);
        now[0] + past.iter().rev().zip(ar).map(|(v, d)| d * v).sum::<f64>()
    }));
    filtered
}
