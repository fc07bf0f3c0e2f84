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

use faer::Mat;
use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use crate::basis::dot;
use crate::convolution::causal_filter;
use crate::fft;
use crate::gls::GlsFit;
use crate::linear::times;
use crate::moments::Moments;
use crate::normal::{Information, with_one};
use crate::record::{Record, Run};
use crate::residual::ScoreTest;
use crate::rest::AgainstRest;

/// p-values below this count: far below what one would ask of a single test, because each of many
/// recordings of linear servos is tested.
pub const SIGNIFICANCE: f64 = 1e-4;

/// Percent of the motion that must be beyond any linear model before it is worth a word: less is
/// within what a servo does to itself from day to day.
pub const WORTH_MENTIONING: f64 = 1.0;

/// Samples at the beginning of a record that are looked at: what cannot be seen in them is too small
/// to matter.
const SAMPLES: usize = 1 << 15;

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

/// Tests the fit of `record` that is in `information`; `None` when the rows do not allow it.
#[must_use]
pub(crate) fn test(record: &Record, information: &Information, fit: &GlsFit) -> Option<Linearity> {
    let offered = Offered::new(record, &information.moments, fit)?;
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
    /// Whether k is a row.
    rows: Vec<bool>,
}

impl Offered {
    fn new(record: &Record, moments: &Moments, fit: &GlsFit) -> Option<Self> {
        let impulse = fit.impulse();
        let mut left = SAMPLES;
        let mut parts = Vec::new();
        for run in record.runs() {
            let part = run.part(0..run.len().min(left));
            left -= part.len();
            if part.is_empty() {
                break;
            }
            let simulated = simulate(&part, moments, &impulse, fit.solution.offset());
            parts.push((part, simulated));
        }
        let scale = Scale::of(parts.iter().map(|(_, simulated)| simulated.as_slice()))?;
        let runs = parts
            .iter()
            .map(|(run, simulated)| OfferedRun::new(run, simulated, &scale, moments, fit))
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
        let mut sum = Mat::zeros(FUNCTIONS, lags);
        for run in &self.runs {
            run.add_cross_moments(&with_one(&fit.ar), &mut sum);
        }
        sum
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
            for (k, _) in run.rows.iter().enumerate().filter(|(_, row)| **row) {
                let offered: f64 = gamma
                    .iter()
                    .zip(&run.functions)
                    .map(|(g, z)| g * z[k])
                    .sum();
                let beyond = offered - explained[run.history + k] - offset;
                square += beyond * beyond;
                count += 1;
            }
        }
        (square / count.max(1) as f64).sqrt()
    }
}

/// The simulated output relative to the centre, NaN where the input is missing.
fn simulate(run: &Run, moments: &Moments, impulse: &[f64], offset: f64) -> Vec<f64> {
    let centre = moments.centre.0;
    let input: Vec<f64> = run.input().iter().map(|u| u - centre).collect();
    causal_filter(impulse, &input, run.input_at_rest().map(|u| u - centre))
        .into_iter()
        .map(|s| s + offset)
        .collect()
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
    fn new(run: &Run, simulated: &[f64], scale: &Scale, moments: &Moments, fit: &GlsFit) -> Self {
        let d = with_one(&fit.ar);
        let history = fit.coordinates.basis.settling() + fit.ar.len();
        let centre = moments.centre;
        let before = run.input_at_rest().map_or(0.0, |u| u - centre.0);
        let mut input = vec![before; history];
        input.extend(run.input().iter().map(|u| present(u - centre.0)));
        let functions = functions(simulated, scale);
        let error: Vec<f64> = run
            .output()
            .iter()
            .zip(simulated)
            .map(|(y, s)| y - centre.1 - s)
            .collect();
        let mut rows = vec![false; run.len()];
        for span in run.complete_rows(moments.input_lags(), moments.output_lags()) {
            rows[span].fill(true);
        }
        let in_rows = |values: &[f64]| -> Vec<f64> {
            let keep = |(value, row): (f64, &bool)| if *row { value } else { 0.0 };
            filtered(values, &d)
                .into_iter()
                .zip(&rows)
                .map(keep)
                .collect()
        };
        Self {
            filtered: functions.each_ref().map(|z| in_rows(z)),
            errors: in_rows(&error),
            input,
            history,
            functions,
            rows,
        }
    }

    /// By transforms: the products of D z_j with all lags of D u at once. Rows have their whole
    /// history, so nothing that is wrapped around meets one.
    fn add_cross_moments(&self, d: &[f64], sum: &mut Mat<f64>) {
        let size = transform_size(self.input.len());
        let (forward, inverse) = (fft::forward(size), fft::inverse(size));
        let spectrum = |values: &[f64], start: usize| {
            let mut block = forward.make_input_vec();
            block[start..start + values.len()].copy_from_slice(values);
            let mut spectrum = forward.make_output_vec();
            forward
                .process(&mut block, &mut spectrum)
                .expect("buffers come from the plan");
            spectrum
        };
        let order = d.len() - 1;
        let input = spectrum(&filtered(&self.input, d)[order..], order);
        let mut products = inverse.make_output_vec();
        for (j, z) in self.filtered.iter().enumerate() {
            let mut both = spectrum(z, self.history);
            for (z, u) in both.iter_mut().zip(&input) {
                *z = *z * u.conj() / size as f64;
            }
            // Rounding is all that the imaginary parts at 0 and the highest frequency can hold.
            both[0].im = 0.0;
            if let Some(last) = both.last_mut().filter(|_| size.is_multiple_of(2)) {
                last.im = 0.0;
            }
            inverse
                .process(&mut both, &mut products)
                .expect("buffers come from the plan");
            for (lag, product) in products.iter().enumerate().take(sum.ncols()) {
                sum[(j, lag)] += product;
            }
        }
    }
}

/// s², s³, v |v|, |v|, s |v|, with v the central difference; 0 where the simulation is missing.
fn functions(simulated: &[f64], scale: &Scale) -> [Vec<f64>; FUNCTIONS] {
    let at = |k: usize| simulated.get(k).copied().filter(|s| !s.is_nan());
    let mut functions = [const { Vec::new() }; FUNCTIONS];
    for (k, &s) in simulated.iter().enumerate() {
        // At the ends of a stretch there is one neighbour only.
        let before = k.checked_sub(1).and_then(at).unwrap_or(s);
        let after = at(k + 1).unwrap_or(s);
        let (s, v) = (s / scale.position, (after - before) / (2.0 * scale.speed));
        for (function, value) in
            functions
                .iter_mut()
                .zip([s * s, s * s * s, v * v.abs(), v.abs(), s * v.abs()])
        {
            function.push(present(value));
        }
    }
    functions
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

/// The smallest even product of 2, 3 and 5 that is at least `least`: transforms of such sizes are fast.
fn transform_size(least: usize) -> usize {
    let mut best = least.next_power_of_two().max(2);
    let mut five = 1;
    while five < best {
        let mut three = five;
        while three < best {
            let two = least.div_ceil(three).next_power_of_two().max(2);
            best = best.min(two * three);
            three *= 3;
        }
        five *= 5;
    }
    best
}

#[cfg(test)]
mod tests;
