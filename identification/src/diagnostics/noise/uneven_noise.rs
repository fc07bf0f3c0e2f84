//! Noise that is not even: larger in motion, or larger in one part of the record than in another.
//!
//! Time stamps that jitter add the jitter times the speed to the output, and a sensor may be noisier in motion.
//! Then the errors one step ahead have the variance
//!
//! ```text
//! E ε(k)² = s_b² + τ² q(k),     q(k) = sum_i d_i² v(k-i)²
//! ```
//!
//! with the level s_b of the part b of the record, the speed v of the simulation \[output per sample\] and τ, the
//! jitter \[samples\]. Least squares is still unbiased, but its covariance is no longer σ² A^-1. It is
//!
//! ```text
//! A^-1 S A^-1,     S = sum_kl s_b(k) s_b(l) γ(k-l) z(k) z(l)' + τ² sum_j v(j)² x(j) x(j)',     x(j) = sum_i d_i z(j+i)
//! ```
//!
//! with the filtered rows z (a sandwich: Eicker 1967, White 1980). Noise in motion is white before the filter, so
//! it reaches d+1 rows at once: hence x. D whitens both noises together, so what is white in the mean is not white
//! at rest: γ(i) = -τ² mean v² sum_j d_j d_(j+i) for 0 < i <= d. A variance of a few numbers is used in place of each single ε², because
//! a point of a step response rests on as many errors as the reference has edges, which are far too few. These numbers are estimates, too:
//! where τ² has much of a variance, its own uncertainty is in the degrees of freedom.
//!
//! The fit takes the share h(k) = z(k)' A^-1 z(k), the leverage, of the square of each error. Behind the only edge of a record it is nearly 1, and
//! that part is no quieter than the others for it.

use faer::Mat;
use serde::{Deserialize, Serialize};

use crate::data::Moments;
use crate::diagnostics::residuals::filtered_rows::filtered;
use crate::diagnostics::residuals::further_columns::in_coordinates;
use crate::diagnostics::residuals::simulation_error::{Simulated, one_step_errors};
use crate::estimation::{EstimatedPart, GlsFit, noise_filter};
use crate::numerics::{
    chi_square_upper_tail, dot, normal_upper_quantile, outer_square, two_digits,
};
use crate::thresholds::RESIDUAL_SIGNIFICANCE;

/// Parts of the record that may differ in their noise.
const PARTS: usize = 8;

/// Rows of the sandwich: it is a ratio, for which the beginning of a long record is enough.
const ROWS: usize = 1 << 13;

/// By how much the noise varies.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct UnevenNoise {
    /// Standard deviation of further noise in motion, as the jitter of the time of sampling that would cause it
    /// \[s\]; 0 where there is none beyond chance.
    pub jitter_s: f64,
    /// Largest over smallest standard deviation of the noise in the parts of the record; 1 where they differ by
    /// no more than chance.
    pub loudest_over_quietest: f64,
}

impl UnevenNoise {
    /// In words.
    pub(crate) fn in_words(&self) -> String {
        let in_motion = (self.jitter_s > 0.0).then(|| {
            format!(
                "larger in motion, as times of sampling that scatter by {} ms would make it",
                two_digits(1000.0 * self.jitter_s)
            )
        });
        let in_parts = (self.loudest_over_quietest > 1.0).then(|| {
            format!(
                "{:.1} times as large in the loudest part of the record as in the quietest",
                self.loudest_over_quietest
            )
        });
        let found: Vec<String> = in_motion.into_iter().chain(in_parts).collect();
        format!("The noise is not even: it is {}.", found.join(", and "))
    }
}

/// A row of the regression: its place, its error and its speed.
struct Row {
    run: usize,
    sample: usize,
    part: usize,
    square: f64,
    /// q(k).
    motion: f64,
    /// 1 - h(k): what the fit leaves of the square, in the mean.
    left: f64,
}

/// Whether the noise is even; where it is not, the covariance of `fit` becomes that of uneven noise.
pub(crate) fn allow_for_uneven_noise(
    runs: &[Simulated<'_>],
    moments: &Moments,
    fit: &mut GlsFit,
) -> Option<UnevenNoise> {
    let speeds: Vec<Vec<f64>> = runs.iter().map(squared_speed).collect();
    let mut rows = rows(runs, &speeds, moments, fit);
    if rows.len() < 2 * PARTS {
        return None;
    }
    let mean_motion = rows.iter().map(|row| row.motion).sum::<f64>() / rows.len() as f64;
    let (in_motion, relative_variance) = motion_variance(&rows).unwrap_or_default();
    let absorbed = fit.rows as f64 / fit.degrees_of_freedom();
    let in_motion = (in_motion * absorbed).min(most_in_motion(fit, mean_motion));
    let evenly_taken = NoiseLevels::of(&rows, in_motion);
    if in_motion == 0.0 && evenly_taken.are_even {
        return None;
    }
    if fit.precision > 0.0 {
        return Some(allow_for_loudest(&rows, moments, fit, in_motion));
    }
    let regression = Rows { runs, moments, fit };
    let columns = regression.of_each(&rows);
    let by_coordinate = &fit.solution.inverse * &columns;
    for (index, row) in rows.iter_mut().enumerate() {
        let leverage = dot(
            columns.col_as_slice(index),
            by_coordinate.col_as_slice(index),
        );
        row.left = 1.0 - leverage.min(1.0);
    }
    let levels = NoiseLevels::of(&rows, in_motion);
    if in_motion == 0.0 && levels.are_even {
        return None;
    }
    let found = Found {
        in_motion,
        mean_motion,
        levels,
    };
    let (at_rest, moving) = regression.meat(&rows, columns, &speeds, &found);
    let inverse = &fit.solution.inverse;
    let between = |meat: Mat<f64>| &(inverse * meat) * inverse;
    let at_rest = between(at_rest) - inverse;
    let moving = moving.map(|moving| EstimatedPart {
        covariance: between(moving),
        relative_variance,
    });
    fit.spread_further(1.0, Some(at_rest));
    if let Some(moving) = moving {
        fit.spread_by(moving);
    }
    Some(UnevenNoise {
        jitter_s: in_motion.sqrt() * moments.sample_period_s(),
        loudest_over_quietest: found.levels.loudest_over_quietest(),
    })
}

/// Stretches of the record of which the loudest counts under the prior of a smooth input: the frequencies of a sweep come one after the other, and each has the
/// noise of its own time.
const STRETCHES: usize = 64;

/// The covariance of `fit` as in noise that is everywhere as in the loudest stretch.
fn allow_for_loudest(
    rows: &[Row],
    moments: &Moments,
    fit: &mut GlsFit,
    in_motion: f64,
) -> UnevenNoise {
    let mean_square = |rows: &[Row]| {
        let sum: f64 = rows.iter().map(|row| row.square).sum();
        sum / rows.len().max(1) as f64
    };
    let stretches: Vec<f64> = (rows.chunks(rows.len().div_ceil(STRETCHES)))
        .map(mean_square)
        .collect();
    let loudest = stretches.iter().copied().fold(0.0, f64::max);
    let quietest = stretches.iter().copied().fold(loudest, f64::min);
    let ratio = (loudest / mean_square(rows)).max(1.0);
    fit.spread_further(ratio, None);
    UnevenNoise {
        jitter_s: in_motion.sqrt() * moments.sample_period_s(),
        loudest_over_quietest: (loudest / quietest).sqrt(),
    }
}

/// The largest τ² that leaves noise at rest at every frequency: τ² mean v² |D|² is below the variance of ε.
fn most_in_motion(fit: &GlsFit, mean_motion: f64) -> f64 {
    const FREQUENCIES: usize = 64;
    /// Share of the variance of ε, at the frequency where there is most.
    const MOST: f64 = 0.95;
    let d = noise_filter(&fit.ar);
    let power = |k: usize| {
        let omega = std::f64::consts::PI * k as f64 / FREQUENCIES as f64;
        let part = |of: fn(f64) -> f64| -> f64 {
            d.iter()
                .zip(0..)
                .map(|(d, i)| d * of(omega * f64::from(i)))
                .sum()
        };
        part(f64::cos).powi(2) + part(f64::sin).powi(2)
    };
    let largest = (0..=FREQUENCIES).map(power).fold(0.0, f64::max);
    MOST * fit.variance * dot(&d, &d) / (largest * mean_motion).max(f64::MIN_POSITIVE)
}

/// The noise that was found.
struct Found {
    /// τ².
    in_motion: f64,
    /// Mean of q.
    mean_motion: f64,
    levels: NoiseLevels,
}

/// v(k)² of a run; 0 where the simulation is missing.
pub(crate) fn squared_speed(run: &Simulated<'_>) -> Vec<f64> {
    let square = |v: f64| if v.is_nan() { 0.0 } else { v * v };
    run.speed().into_iter().map(square).collect()
}

/// q(k) = sum_i d_i² v(k-i)², from v².
pub(crate) fn motion(squared_speed: &[f64], ar: &[f64]) -> Vec<f64> {
    let squares: Vec<f64> = noise_filter(ar).iter().map(|d| d * d).collect();
    filtered(squared_speed, &squares)
}

/// The first rows of the regression, from all of which the fit takes the same share until their leverage is known.
fn rows(runs: &[Simulated<'_>], speeds: &[Vec<f64>], moments: &Moments, fit: &GlsFit) -> Vec<Row> {
    let left = fit.degrees_of_freedom() / fit.rows as f64;
    let mut rows = Vec::new();
    for (index, (run, speed)) in runs.iter().zip(speeds).enumerate() {
        let errors = one_step_errors(&run.errors, &fit.ar);
        let motion = motion(speed, &fit.ar);
        let complete = run
            .run
            .complete_rows(moments.input_lags(), moments.output_lags());
        for k in complete.into_iter().flatten() {
            rows.push(Row {
                run: index,
                sample: k,
                part: 0,
                square: errors[k] * errors[k],
                motion: motion[k],
                left,
            });
        }
    }
    if fit.precision == 0.0 {
        rows.truncate(ROWS);
    }
    let count = rows.len();
    for (i, row) in rows.iter_mut().enumerate() {
        row.part = i * PARTS / count;
    }
    rows
}

/// τ² and its relative variance, where squared errors are related to q beyond chance. Parts may differ in their level.
fn motion_variance(rows: &[Row]) -> Option<(f64, f64)> {
    let mean = |of: &dyn Fn(&Row) -> f64| -> Vec<f64> {
        let mut sums = [(0.0, 0.0); PARTS];
        for row in rows {
            sums[row.part].0 += of(row);
            sums[row.part].1 += 1.0;
        }
        sums.iter().map(|(sum, count)| sum / count).collect()
    };
    let (squares, motions) = (mean(&|row| row.square), mean(&|row| row.motion));
    let (mut product, mut own, mut variance) = (0.0, 0.0, 0.0);
    for row in rows {
        let motion = row.motion - motions[row.part];
        let term = (row.square - squares[row.part]) * motion;
        product += term;
        own += motion * motion;
        variance += term * term;
    }
    let beyond_chance = product > normal_upper_quantile(RESIDUAL_SIGNIFICANCE) * variance.sqrt();
    (beyond_chance && own > 0.0).then(|| (product / own, variance / (product * product)))
}

/// Sums over the rows of a part of the record.
#[derive(Clone, Copy, Default)]
struct Part {
    rows: f64,
    /// Of squared errors, those of motion taken out.
    squares: f64,
    /// Of what the fit leaves of them.
    left: f64,
    left_squared: f64,
}

/// The noise of the parts, that of motion taken out.
struct NoiseLevels {
    /// s_b².
    variance: Vec<f64>,
    are_even: bool,
}

impl NoiseLevels {
    fn of(rows: &[Row], in_motion: f64) -> Self {
        let of_rest = |row: &Row| row.square - in_motion * row.motion * row.left;
        let mut parts = [Part::default(); PARTS];
        for row in rows {
            let part = &mut parts[row.part];
            part.rows += 1.0;
            part.squares += of_rest(row);
            part.left += row.left;
            part.left_squared += row.left * row.left;
        }
        let sum = |of: fn(&Part) -> f64| parts.iter().map(of).sum::<f64>();
        let mean = sum(|part| part.squares) / sum(|part| part.left);
        let spread = rows
            .iter()
            .map(|row| (of_rest(row) - mean * row.left).powi(2));
        let spread = spread.sum::<f64>() / sum(|part| part.left_squared);
        let seen = parts.iter().filter(|part| part.left_squared > 0.0);
        let chi_square = seen.map(|part| {
            let more = part.squares - mean * part.left;
            more * more / (spread * part.left_squared)
        });
        let are_even = chi_square_upper_tail(chi_square.sum(), PARTS - 1) > RESIDUAL_SIGNIFICANCE;
        // What the fit takes of a part shows nothing of it, and counts as the mean. A part cannot be quieter than a hundredth of that and still be noise.
        let level = |part: &Part| match are_even {
            true => mean.max(0.0),
            false => {
                let taken = part.rows - part.left;
                ((part.squares + mean * taken) / part.rows).max(0.01 * mean)
            }
        };
        Self {
            variance: parts.iter().map(level).collect(),
            are_even,
        }
    }

    fn loudest_over_quietest(&self) -> f64 {
        let of =
            |choose: fn(f64, f64) -> f64, start| self.variance.iter().copied().fold(start, choose);
        match self.are_even {
            true => 1.0,
            false => (of(f64::max, 0.0) / of(f64::min, f64::INFINITY)).sqrt(),
        }
    }
}

/// The rows of the regression.
struct Rows<'a> {
    runs: &'a [Simulated<'a>],
    moments: &'a Moments,
    fit: &'a GlsFit,
}

impl Rows<'_> {
    /// z of each row, in columns.
    fn of_each(&self, rows: &[Row]) -> Mat<f64> {
        let each: Vec<_> = rows.iter().map(|row| (row.run, row.sample, 1.0)).collect();
        self.columns(&each, &[1.0])
    }

    /// The parts of S of the noise at rest and in motion, over the variance of the fit, for as many rows as the fit has. `even` has z of each row.
    fn meat(
        &self,
        rows: &[Row],
        mut even: Mat<f64>,
        speeds: &[Vec<f64>],
        found: &Found,
    ) -> (Mat<f64>, Option<Mat<f64>>) {
        let scale = self.fit.rows as f64 / rows.len() as f64 / self.fit.variance;
        for (column, row) in rows.iter().enumerate() {
            let deviation = (scale * found.levels.variance[row.part]).sqrt();
            for value in even.col_as_slice_mut(column) {
                *value *= deviation;
            }
        }
        if found.in_motion == 0.0 {
            return (outer_square(&even), None);
        }
        let d = noise_filter(&self.fit.ar);
        let at_rest = &even * correlated(&even, &self.correlation_at_rest(&d, found));
        // Rest has no part in the sum over motion.
        let largest = speeds.iter().flatten().copied().fold(0.0, f64::max);
        let moving: Vec<_> = rows
            .iter()
            .filter(|row| speeds[row.run][row.sample] > 1e-4 * largest)
            .map(|row| {
                let variance = found.in_motion * speeds[row.run][row.sample];
                (row.run, row.sample, (scale * variance).sqrt())
            })
            .collect();
        let moving = self.columns(&moving, &d);
        (at_rest, Some(outer_square(&moving)))
    }

    /// γ(1) .. γ(d), relative to the noise at rest.
    fn correlation_at_rest(&self, d: &[f64], found: &Found) -> Vec<f64> {
        let mean_speed = found.mean_motion / dot(d, d);
        let levels = &found.levels.variance;
        let at_rest = levels.iter().sum::<f64>() / levels.len() as f64;
        let together = |i: usize| dot(&d[i..], &d[..d.len() - i]);
        (1..d.len())
            .map(|i| -found.in_motion * mean_speed * together(i) / at_rest)
            .collect()
    }

    /// w x of rows with weights w, one in each column, x(k) = sum_i f_i z(k+i); the offset last.
    fn columns(&self, rows: &[(usize, usize, f64)], f: &[f64]) -> Mat<f64> {
        let coordinates = &self.fit.coordinates;
        let n = coordinates.basis.settling();
        let d = noise_filter(&self.fit.ar);
        let gain = d.iter().sum::<f64>() * f.iter().sum::<f64>();
        let mut lags = Mat::<f64>::zeros(n, rows.len());
        for (column, &(run, sample, weight)) in rows.iter().enumerate() {
            let input = self.inputs(run, sample, n, &d, f);
            for (value, input) in lags.col_as_slice_mut(column).iter_mut().zip(input) {
                *value = weight * input;
            }
        }
        let offsets: Vec<f64> = rows.iter().map(|(_, _, weight)| weight * gain).collect();
        in_coordinates(coordinates, lags, &offsets)
    }

    /// sum_ij f_i d_j u(k+i-j-a), a = 0..n.
    fn inputs(&self, run: usize, k: usize, n: usize, d: &[f64], f: &[f64]) -> Vec<f64> {
        let run = &self.runs[run].run;
        let centre = self.moments.centre.0;
        let at = |k: isize| {
            let within = k < run.len() as isize;
            let value = if within {
                run.input_at(k) - centre
            } else {
                0.0
            };
            if value.is_nan() { 0.0 } else { value }
        };
        let mut filter = vec![0.0; d.len() + f.len() - 1];
        for (i, fi) in f.iter().enumerate() {
            for (j, dj) in d.iter().enumerate() {
                filter[f.len() - 1 - i + j] += fi * dj;
            }
        }
        let ahead = (f.len() - 1) as isize;
        let inputs: Vec<f64> = (0..n + filter.len() - 1)
            .map(|a| at(k as isize + ahead - a as isize))
            .collect();
        (0..n)
            .map(|a| dot(&filter, &inputs[a..a + filter.len()]))
            .collect()
    }
}

/// Γ Z' for rows in the columns of Z, whose neighbours have the correlations γ(1), γ(2), ... with each other.
fn correlated(columns: &Mat<f64>, correlation: &[f64]) -> Mat<f64> {
    let mut turned = columns.transpose().to_owned();
    let source = turned.clone();
    let count = turned.nrows();
    for column in 0..turned.ncols() {
        let from = source.col_as_slice(column);
        let to = turned.col_as_slice_mut(column);
        for (gamma, lag) in correlation.iter().zip(1..count) {
            for k in lag..count {
                to[k] += gamma * from[k - lag];
                to[k - lag] += gamma * from[k];
            }
        }
    }
    turned
}
