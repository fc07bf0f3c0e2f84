//! Whether what the model leaves over is a function of what it explains.
//!
//! A linear servo leaves over noise, which knows nothing of the input. One that is limited in speed,
//! has play or reaches its two ends differently leaves over something that follows the motion, and
//! a noise model that is flexible enough explains it away one step ahead: whiteness and
//! independence of further *lags* of the input may pass, and the bounds are far too narrow all the
//! same. So functions of the simulated output s and its speed v that no linear model has are
//! offered to the regression,
//!
//! ```text
//! D(z) (y - ŷ)(k) = D(z) Σ_j γ_j z_j(k) + ε(k),    z = s², s³, v |v|, |v|, s |v|,
//! ```
//!
//! together with all the parameters of the model (Ramsey's RESET, 1969). Because the z_j depend on
//! the data through the fitted response alone, which is independent of the residuals, the usual F
//! statistic of γ = 0 has its F distribution for any z (Milliken & Graybill 1970), given D.
//!
//! A bank that leaves out frequencies leaves over their share of the motion, which no function of lags
//! can be told from: there a small p says that the errors are not noise, but not why
//! ([`Linearity::complete`]).
//!
//! Significance is not size: in a long record anything is significant. [`Linearity::misfit_percent`]
//! is the part of the motion that γ explains and no linear model of this settling time could.

use std::ops::Range;

use faer::Mat;
use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use crate::basis::dot;
use crate::convolution::causal_filter;
use crate::gls::GlsFit;
use crate::lagged_sums::LaggedSums;
use crate::linear::times;
use crate::moments::Moments;
use crate::normal::{Information, with_one};
use crate::residual::ScoreTest;
use crate::rest::AgainstRest;
use crate::simulated::Simulated;

/// p-values below this count: far below what one would ask of a single test, because each of many
/// recordings of linear servos is tested.
pub const SIGNIFICANCE: f64 = 1e-4;

/// Percent of the motion that must be beyond any linear model before it is worth a word: less is
/// within what a servo does to itself from day to day.
pub const WORTH_MENTIONING: f64 = 1.0;

/// Functions of the simulated motion that are offered.
const FUNCTIONS: usize = 5;

/// What the test found.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Linearity {
    /// Probability of a relation to functions of the motion at least as strong if the servo is
    /// linear.
    pub p: f64,
    /// Root mean square of what these functions explain and no linear model does, of that of the
    /// output about its mean \[%\]. Without a finding, noise alone makes it about
    /// sqrt(5/rows) times the noise.
    pub misfit_percent: f64,
    /// Whether the model has all frequencies, so that what follows the motion cannot be those left
    /// out.
    pub complete: bool,
    /// How the errors compare with the noise at rest; `None` where no rest was recorded, or where the
    /// response may be longer than what the model has of it, which leaves errors of its own.
    #[serde(default)]
    pub rest: Option<AgainstRest>,
}

impl Linearity {
    /// Whether errors are shown to follow the motion, by an amount that matters.
    #[must_use]
    pub fn errors_follow_motion(&self) -> bool {
        self.by_functions() || self.against_rest().is_some()
    }

    /// Whether functions of the motion explain errors, by an amount that matters.
    #[must_use]
    pub fn by_functions(&self) -> bool {
        self.p < SIGNIFICANCE && self.misfit_percent > WORTH_MENTIONING
    }

    /// How much larger errors are in motion than at rest, if that is shown, by an amount that matters.
    #[must_use]
    pub fn against_rest(&self) -> Option<AgainstRest> {
        self.rest
            .filter(|rest| rest.p < SIGNIFICANCE && rest.misfit_percent > WORTH_MENTIONING)
    }

    /// Whether the servo is shown not to be linear, by an amount that matters.
    #[must_use]
    pub fn is_rejected(&self) -> bool {
        self.complete && self.errors_follow_motion()
    }
}

/// Tests the fit that is in `information` on what it makes of its record; `None` when the rows do not allow
/// it.
#[must_use]
pub(crate) fn test(
    runs: &[Simulated<'_>],
    information: &Information,
    fit: &GlsFit,
) -> Option<Linearity> {
    let offered = Offered::new(runs, &information.moments, fit)?;
    let (found, response) = offered.regress(fit)?;
    let (k, free) = (found.degrees as f64, fit.degrees_of_freedom());
    let unexplained = fit.solution.rss - found.reduction;
    if free <= k || unexplained <= 0.0 {
        return None;
    }
    let f = (found.reduction / k) / (unexplained / (free - k));
    let distribution = FisherSnedecor::new(k, free - k).ok()?;
    let misfit = offered.misfit(fit, &found.coefficients, &response);
    let motion = (information.moments.output_spread() / information.rows() as f64).sqrt();
    Some(Linearity {
        p: distribution.sf(f).clamp(0.0, 1.0),
        misfit_percent: 100.0 * misfit / motion,
        complete: fit.coordinates.basis.has_all_frequencies(),
        rest: None,
    })
}

/// The functions of the motion, run by run.
struct Offered {
    runs: Vec<OfferedRun>,
}

/// One run: everything is relative to the centre of the moments.
struct OfferedRun {
    /// u, with its history before the run; 0 where it is missing.
    input: Vec<f64>,
    /// Samples of history at the beginning of `input`.
    history: usize,
    /// z_j(k), 0 where the simulation is missing.
    functions: [Vec<f64>; FUNCTIONS],
    /// D(z) z_j(k); 0 but in the rows of the regression.
    filtered: [Vec<f64>; FUNCTIONS],
    /// D(z) (y - ŷ)(k); 0 but in the rows of the regression.
    errors: Vec<f64>,
    /// The rows of the regression.
    rows: Vec<Range<usize>>,
}

impl Offered {
    fn new(runs: &[Simulated<'_>], moments: &Moments, fit: &GlsFit) -> Option<Self> {
        let scale = Scale::of(runs.iter().map(|run| run.output.as_slice()))?;
        let runs = runs
            .iter()
            .map(|run| OfferedRun::new(run, &scale, moments, fit))
            .collect();
        Some(Self { runs })
    }

    /// The regression on the functions beside the parameters of the fit, from cross moments alone;
    /// and what the fit's own parameters, the offset last, take over of the functions.
    fn regress(&self, fit: &GlsFit) -> Option<(ScoreTest, Vec<f64>)> {
        let by_lag = self.cross_moments(fit);
        let by_coordinate = match fit.coordinates.impulse_map() {
            Some(map) => by_lag * map,
            None => by_lag,
        };
        let p = fit.coordinates.len();
        let cross = Mat::from_fn(FUNCTIONS, p + 1, |j, i| {
            if i < p {
                by_coordinate[(j, i)]
            } else {
                self.with_offset(fit, j)
            }
        });
        let own = self.own_moments();
        let taken_over = &cross * &fit.solution.inverse;
        let left = &own - &taken_over * cross.transpose();
        let found = ScoreTest::new(&left, &own, &self.score())?;
        let response = times(&taken_over.transpose().to_owned(), &found.coefficients);
        Some((found, response))
    }

    /// Sum over the rows of D z_j(k) times D u(k-m): FUNCTIONS x N.
    fn cross_moments(&self, fit: &GlsFit) -> Mat<f64> {
        let lags = fit.coordinates.basis.settling();
        let d = with_one(&fit.ar);
        let mut sums = LaggedSums::new(lags, FUNCTIONS);
        for run in &self.runs {
            let input = filtered(&run.input, &d);
            let functions = run.filtered.each_ref().map(Vec::as_slice);
            sums.add(&input[run.history + 1 - lags..], &functions);
        }
        let sums = sums.sums();
        Mat::from_fn(FUNCTIONS, lags, |j, lag| sums[j][lag])
    }

    /// Sum over the rows of D z_j(k) times D 1.
    fn with_offset(&self, fit: &GlsFit, function: usize) -> f64 {
        let gain: f64 = with_one(&fit.ar).iter().sum();
        let sum: f64 = self
            .runs
            .iter()
            .flat_map(|run| &run.filtered[function])
            .sum();
        gain * sum
    }

    fn own_moments(&self) -> Mat<f64> {
        Mat::from_fn(FUNCTIONS, FUNCTIONS, |i, j| {
            let product = |run: &OfferedRun| dot(&run.filtered[i], &run.filtered[j]);
            self.runs.iter().map(product).sum()
        })
    }

    fn score(&self) -> Vec<f64> {
        (0..FUNCTIONS)
            .map(|j| {
                let product = |run: &OfferedRun| dot(&run.filtered[j], &run.errors);
                self.runs.iter().map(product).sum()
            })
            .collect()
    }

    /// Root mean square over the rows of Σ γ_j z_j less what the model explains of it.
    fn misfit(&self, fit: &GlsFit, gamma: &[f64], response: &[f64]) -> f64 {
        let (offset, coordinates) = response.split_last().unwrap_or((&0.0, &[]));
        let impulse = fit.coordinates.impulse(coordinates);
        let (mut square, mut count) = (0.0, 0usize);
        for run in &self.runs {
            let explained = causal_filter(&impulse, &run.input, None);
            let explained = &explained[run.history..];
            for rows in &run.rows {
                let mut beyond: Vec<f64> = explained[rows.clone()]
                    .iter()
                    .map(|explained| -explained - offset)
                    .collect();
                for (g, z) in gamma.iter().zip(&run.functions) {
                    for (beyond, z) in beyond.iter_mut().zip(&z[rows.clone()]) {
                        *beyond += g * z;
                    }
                }
                square += dot(&beyond, &beyond);
                count += beyond.len();
            }
        }
        (square / count.max(1) as f64).sqrt()
    }
}

/// What brings position and speed to a size of one.
struct Scale {
    position: f64,
    speed: f64,
}

impl Scale {
    /// `None` when nothing moves.
    fn of<'a>(runs: impl Iterator<Item = &'a [f64]>) -> Option<Self> {
        let (mut position, mut speed, mut count) = (0.0, 0.0, 0usize);
        for simulated in runs {
            for pair in simulated
                .windows(2)
                .filter(|pair| !(pair[0] + pair[1]).is_nan())
            {
                position += pair[1] * pair[1];
                speed += (pair[1] - pair[0]).powi(2);
                count += 1;
            }
        }
        (position > 0.0 && speed > 0.0).then(|| Self {
            position: (position / count as f64).sqrt(),
            speed: (speed / count as f64).sqrt(),
        })
    }
}

impl OfferedRun {
    fn new(simulated: &Simulated<'_>, scale: &Scale, moments: &Moments, fit: &GlsFit) -> Self {
        let d = with_one(&fit.ar);
        let history = fit.coordinates.basis.settling() + fit.ar.len();
        let (run, centre) = (&simulated.run, moments.centre.0);
        let before = run.input_at_rest().map_or(0.0, |u| u - centre);
        let mut input = vec![before; history];
        input.extend(run.input().iter().map(|u| present(u - centre)));
        let functions = functions(&simulated.output, scale);
        let rows = run.complete_rows(moments.input_lags(), moments.output_lags());
        let in_rows = |values: &[f64]| only(&rows, filtered(values, &d));
        Self {
            filtered: functions.each_ref().map(|z| in_rows(z)),
            errors: in_rows(&simulated.errors),
            input,
            history,
            functions,
            rows,
        }
    }
}

/// `values` in `rows`, 0 elsewhere.
fn only(rows: &[Range<usize>], mut values: Vec<f64>) -> Vec<f64> {
    let mut kept = 0;
    for row in rows {
        values[kept..row.start].fill(0.0);
        kept = row.end;
    }
    values[kept..].fill(0.0);
    values
}

/// s², s³, v |v|, |v|, s |v|, with v the central difference; 0 where the simulation is missing.
fn functions(simulated: &[f64], scale: &Scale) -> [Vec<f64>; FUNCTIONS] {
    let moving: Vec<(f64, f64)> = (0..simulated.len())
        .map(|k| {
            let s = simulated[k];
            // At the ends of a stretch there is one neighbour only.
            let neighbour = |k: usize| match simulated.get(k) {
                Some(s) if !s.is_nan() => *s,
                _ => s,
            };
            let change = neighbour(k + 1) - neighbour(k.wrapping_sub(1));
            (s / scale.position, change / (2.0 * scale.speed))
        })
        .collect();
    [
        each(&moving, |s, _| s * s),
        each(&moving, |s, _| s * s * s),
        each(&moving, |_, v| v * v.abs()),
        each(&moving, |_, v| v.abs()),
        each(&moving, |s, v| s * v.abs()),
    ]
}

fn each(moving: &[(f64, f64)], function: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    moving
        .iter()
        .map(|(s, v)| present(function(*s, *v)))
        .collect()
}

fn present(value: f64) -> f64 {
    if value.is_nan() { 0.0 } else { value }
}

/// sum_i d_i x(k-i) for each k, what is before the first value left out. A pass for each i, so that
/// each can be done in vector registers.
fn filtered(values: &[f64], d: &[f64]) -> Vec<f64> {
    let mut filtered = vec![0.0; values.len()];
    for (i, di) in d.iter().enumerate() {
        for (sum, value) in filtered.iter_mut().skip(i).zip(values) {
            *sum += di * value;
        }
    }
    filtered
}

#[cfg(test)]
mod tests;
