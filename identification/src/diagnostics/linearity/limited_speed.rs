//! Whether the errors follow a limit of the speed, whatever the noise.
//!
//! A servo that is slow to its top speed, under commands that change before it is there, makes errors that are large and smooth. A noise model
//! of a high order predicts them from one row to the next, and what is left of them behind D(z) is less than the noise of the sensor: no function of the
//! motion shows in it. The errors themselves are not hidden. So the command behind a limit of the speed,
//!
//! ```text
//! r(k) = r(k-1) + clip(G_0 u(k) - r(k-1), ± V),
//! ```
//!
//! with V a share of the fastest speed of the simulation, is held against the errors of the simulation, both without D(z). z is what a linear response of
//! the same lags, by plain least squares, leaves of r.
//!
//! How far errors in noise of any colour go together with z by chance follows from no model of the noise: the record is cut into stretches of half the
//! settling time, and z and the errors, each about its mean, have a correlation in each. In a linear servo these scatter about 0, from stretch to stretch
//! independently. Their mean over its standard error has Student's t distribution, or narrower ends than that, even where
//! some stretches are much louder than others (Bakirov & Székely 2005; Ibragimov & Müller 2010).

use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::data::{Moments, Record, Run};
use crate::diagnostics::linearity::reset_test::slower_speed_over;
use crate::diagnostics::residuals::simulation_error::{Simulated, simulated_whole};
use crate::estimation::{GlsFit, GlsOptions, RowInformation};
use crate::numerics::dot;
use crate::options::NoiseOrder;
use crate::thresholds::{EXPLAINED_BY_LIMIT, LIMITED_TO};

/// Fewest stretches whose correlations have a scatter.
const FEWEST_STRETCHES: usize = 6;

/// Share of the squares of r that rounding may leave in z: under some inputs r is a response of these lags itself.
const ROUNDING: f64 = 1e-6;

/// How well a limit of the speed explains errors.
pub(super) struct LimitedSpeed {
    /// Probability of correlations as far from 0 in a linear servo.
    pub(super) p: f64,
    /// Root mean square of the part that z explains \[output\].
    pub(super) rms: f64,
    /// The same over the rows weighted by its own square.
    pub(super) local: f64,
}

/// The errors of `fit` in `runs` against a limit of the speed; `None` where too few rows show it, or where it explains too little to be what is wrong.
pub(super) fn limited_speed(
    runs: &[Simulated<'_>],
    information: &RowInformation,
    fit: &GlsFit,
) -> Option<LimitedSpeed> {
    let moments = &information.moments;
    let limited = Record::new(moments.sample_period_s(), limited(runs, fit)).ok()?;
    let lags = [moments.input_lags(), moments.output_lags()];
    let moments = Moments::of_record(&limited, lags[0], lags[1]);
    let spread = moments.output_spread();
    let plain = GlsOptions {
        order: NoiseOrder::Order(0),
        corrected: false,
        ..GlsOptions::default()
    };
    let information = RowInformation::from_moments(moments);
    let linear = GlsFit::of(&information, &fit.coordinates, &plain)?;
    let beyond = simulated_whole(&limited, &information.moments, &linear);
    let mut found = Correlations::default();
    for (run, beyond) in runs.iter().zip(&beyond) {
        for rows in run.run.complete_rows(lags[0], lags[1]) {
            let (z, v) = (&beyond.errors[rows.clone()], &run.own_errors()[rows]);
            found.add(z, v, fit.coordinates.basis.settling() / 2);
        }
    }
    if found.squares[0] <= ROUNDING * spread {
        return None;
    }
    found.of_limit()
}

/// The commands of `runs` behind the limit of the speed, in place of the outputs; missing where these are.
fn limited<'r>(runs: &'r [Simulated<'r>], fit: &GlsFit) -> Vec<Run<'r>> {
    let step = fit.coordinates.basis.step_response(&fit.theta());
    let gain = step.last().copied().unwrap_or(0.0);
    let over = slower_speed_over(&step);
    let speeds = runs.iter().flat_map(|run| run.speed_over(over));
    let fastest = speeds.fold(0.0f64, |most, speed| most.max(speed.abs()));
    let limit = LIMITED_TO * fastest;
    let of_run = |run: &'r Simulated<'r>| {
        let run = &run.run;
        let first = run.input().iter().find(|u| !u.is_nan());
        let mut now = gain * run.input_at_rest().or(first.copied()).unwrap_or(0.0);
        let rows = run.input().iter().zip(run.output());
        let behind = rows.map(|(u, y)| {
            if !u.is_nan() {
                now += (gain * u - now).clamp(-limit, limit);
            }
            if y.is_nan() { f64::NAN } else { now }
        });
        run.with_output(behind.collect())
    };
    runs.iter().map(of_run).collect()
}

/// How z and the errors v go together.
#[derive(Default)]
struct Correlations {
    /// In each stretch.
    of_stretches: Vec<f64>,
    /// Sums of z² and v².
    squares: [f64; 2],
    /// Sum of z v.
    products: f64,
    /// Sum of z⁴.
    fourths: f64,
    count: usize,
}

impl Correlations {
    /// Adds rows in a row, in stretches of the length `stretch` or somewhat longer.
    fn add(&mut self, z: &[f64], v: &[f64], stretch: usize) {
        self.squares[0] += dot(z, z);
        self.squares[1] += dot(v, v);
        self.products += dot(z, v);
        self.fourths += z.iter().map(|z| z.powi(4)).sum::<f64>();
        self.count += z.len();
        let stretches = z.len() / stretch.max(2);
        let bounds = |i: usize| i * z.len() / stretches;
        self.of_stretches.extend(
            (0..stretches)
                .map(|i| bounds(i)..bounds(i + 1))
                .filter_map(|rows| correlation(&z[rows.clone()], &v[rows])),
        );
    }

    fn of_limit(&self) -> Option<LimitedSpeed> {
        let [of_limit, of_errors] = self.squares;
        let explained = self.products.powi(2) / (of_limit * of_errors);
        if explained.is_nan() || explained < EXPLAINED_BY_LIMIT {
            return None;
        }
        let slope = (self.products / of_limit).abs();
        Some(LimitedSpeed {
            p: self.p()?,
            rms: slope * (of_limit / self.count as f64).sqrt(),
            local: slope * (self.fourths / of_limit).sqrt(),
        })
    }

    /// Of a mean as far from 0, on either side.
    fn p(&self) -> Option<f64> {
        let found = &self.of_stretches;
        if found.len() < FEWEST_STRETCHES {
            return None;
        }
        let count = found.len() as f64;
        let mean = found.iter().sum::<f64>() / count;
        let square: f64 = found.iter().map(|r| (r - mean).powi(2)).sum();
        let error = (square / (count - 1.0) / count).sqrt();
        let student = StudentsT::new(0.0, 1.0, count - 1.0).ok()?;
        Some((2.0 * student.sf((mean / error).abs())).clamp(0.0, 1.0))
    }
}

/// Of `a` and `b`, each about its mean; `None` where one is constant.
fn correlation(a: &[f64], b: &[f64]) -> Option<f64> {
    let about_mean = |values: &[f64]| -> Vec<f64> {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.iter().map(|value| value - mean).collect()
    };
    let (a, b) = (about_mean(a), about_mean(b));
    let scale = (dot(&a, &a) * dot(&b, &b)).sqrt();
    (scale > 0.0).then(|| dot(&a, &b) / scale)
}
