//! How sure the estimate is.
//!
//! The errors of the simulation are taken as autoregressive noise. The estimate is that of least squares, so its
//! covariance is H⁻¹ M H⁻¹ with H = J'J and M the covariance of J'e, where J are the derivatives of the outputs.
//! M follows from the noise model; and from the products J'e of the blocks, which allow for noise that changes
//! with the motion (P. J. Huber 1967; a sandwich by blocks). The larger of the two holds in every direction. What the
//! equation may lack without the record showing it is added as an error that is constant over windows, and as those of
//! [parts of a known shape](crate::servo_model::uncertainty::hidden_parts).

use super::discrepancy;
use super::hidden_parts::hidden_parts;
use super::noise_at_rest::NoiseAtRest;
use super::possible_servo::PossibleServo;
use super::{known_beforehand, run_offsets};
use crate::estimation::{autoregressive, noise_filter};
use crate::numerics::{
    backward_solve, chi_square_upper_tail, cholesky, forward_solve, inverse_of_square,
    symmetric_eigen,
};
use crate::servo_model::descent::coordinates::Point;
use crate::servo_model::descent::error_row::Row;
use crate::servo_model::descent::fit::Problem;
use crate::servo_model::descent::step::MOST;
use crate::servo_model::motion::simulated_motion::ServoMotion;
use faer::Mat;

/// Highest order of the noise model.
const HIGHEST_ORDER: usize = 20;

/// A coordinate whose own slopes are below this share of all of its slopes is not seen in the output.
const UNSEEN: f64 = 1e-9;

/// Such a share is rounding: the coordinate has no variance, however large.
const ROUNDING: f64 = 1e-13;

/// Degrees of freedom of a servo outside of the equation: the speed at which its friction at rest is gone, and one for the choice
/// among several.
const FURTHER: usize = 2;

/// The uncertainty of a fit.
pub(crate) struct Uncertainty {
    /// Covariance of the coordinates; 0 for those without slopes of their own.
    pub(super) covariance: Mat<f64>,
    /// Whether the record shows each coordinate, beside those before it.
    pub(super) seen: Vec<bool>,
    /// Changes of all coordinates that change no output of the record: by one in each whose own slopes are rounding, and what of the
    /// others makes up for it.
    pub(super) unseen: Vec<Vec<f64>>,
    /// d_1..d_d of the noise.
    pub(crate) ar: Vec<f64>,
    /// Standard deviation of the white noise behind it.
    pub(crate) sigma: f64,
    /// Errors of the simulation and their derivatives, by stretch.
    pub(crate) rows: Vec<Vec<Row>>,
    /// The motion of the simulation.
    pub(crate) motion: ServoMotion,
    /// The noise of the sensor; `None` where too little is at rest to show it.
    pub(crate) at_rest: Option<NoiseAtRest>,
    /// Samples over which errors of the equation are taken as constant.
    pub(super) window: usize,
    /// Whether the errors are those of a part that the equation does not have, beyond chance.
    pub(super) has_hidden_part: bool,
    /// Upper limit of the root mean square of the error of the equation \[output\].
    pub(crate) discrepancy: f64,
}

/// The errors of rows, NaN where missing.
fn errors(rows: &[Vec<Row>]) -> Vec<Vec<f64>> {
    let of_stretch = |rows: &Vec<Row>| rows.iter().map(|row| row.error).collect();
    rows.iter().map(of_stretch).collect()
}

impl Uncertainty {
    /// Errors of the simulation, by stretch, NaN where missing.
    pub(crate) fn errors(&self) -> Vec<Vec<f64>> {
        errors(&self.rows)
    }

    /// How much the model lacks at the most \[output, rms\]; `None` where nothing at rest shows what of the errors is noise.
    pub(crate) fn lacking(&self) -> Option<f64> {
        let noise = self.at_rest.as_ref()?;
        noise
            .averages_out(discrepancy::WINDOWS * self.window)
            .then(|| self.discrepancy.min(self.root_mean_square()))
    }

    /// Root mean square of the errors of the simulation \[output\].
    pub(crate) fn root_mean_square(&self) -> f64 {
        root_mean_square(&self.errors())
    }

    /// Whether the errors of `other` are smaller than by a chance of this `significance`, as far as the noise at rest shows.
    pub(crate) fn is_beaten_by(&self, other: &Self, significance: f64) -> bool {
        let Some(noise) = &self.at_rest else {
            return false;
        };
        let gained = noise.white_squares(&self.errors()) - noise.white_squares(&other.errors());
        chi_square_upper_tail(gained, FURTHER) < significance
    }

    /// The servo `point`, which this is the uncertainty of.
    pub(crate) fn servo_at(&self, point: Point) -> PossibleServo {
        PossibleServo {
            point,
            covariance: self.covariance.clone(),
            unseen: self.unseen.clone(),
        }
    }
}

/// The uncertainty of `point`.
pub(crate) fn uncertainty(problem: &Problem<'_>, point: &Point, blocks: usize) -> Uncertainty {
    let missing = Row {
        error: f64::NAN,
        slope: [0.0; MOST],
        by_zero: 0.0,
    };
    let empty = |stretch: &crate::servo_model::stretches::Stretch| {
        vec![missing.clone(); stretch.input.len()]
    };
    let mut rows: Vec<Vec<Row>> = problem.stretches.iter().map(empty).collect();
    problem.each_slope(point, |s, k, error, slope, by_zero| {
        rows[s][k] = Row {
            error,
            slope: *slope,
            by_zero,
        };
    });
    if !point.run_offsets.is_empty() {
        run_offsets::eliminate(problem.stretches, &mut rows, point.run_offsets.len());
    }
    let all = errors(&rows);
    let (ar, sigma) = noise(&all);
    let motion = ServoMotion::new(problem.stretches, &all, problem.grid.period_s);
    let at_rest = NoiseAtRest::new(&motion, &all);
    let window = discrepancy::window(point, &problem.grid);
    let discrepancy = match &at_rest {
        Some(noise) => discrepancy::upper_limit(&all, &motion, noise, window),
        // Nothing says what of the errors is noise.
        None => root_mean_square(&all),
    };
    let known = rows.iter().flatten().filter(|row| !row.error.is_nan());
    let normal = sum_of_products(point.values.len(), known.map(|row| &row.slope));
    let has_slopes = with_own_slopes(&normal, ROUNDING);
    let kept: Vec<usize> = (0..has_slopes.len()).filter(|&i| has_slopes[i]).collect();
    let part =
        |whole: &Mat<f64>| Mat::from_fn(kept.len(), kept.len(), |i, j| whole[(kept[i], kept[j])]);
    let modelled = by_noise_model(&rows, &ar, sigma, point.values.len());
    let blockwise = by_blocks(problem, &rows, blocks, point.values.len());
    let of_windows = by_windows(&rows, window, discrepancy, point.values.len());
    let hidden_parts = at_rest.as_ref().map_or_else(Vec::new, |noise| {
        let motion = (&rows[..], &motion.simulated[..]);
        hidden_parts(problem.stretches, point, &problem.grid, motion, noise)
    });
    let hidden = hidden_parts.iter().map(|part| &part.hidden);
    let hidden = sum_of_products(point.values.len(), hidden);
    let of_equation = part(&of_windows) + part(&hidden);
    let middle = larger(&part(&modelled), &part(&blockwise)) + of_equation;
    let mut covariance = Mat::zeros(has_slopes.len(), has_slopes.len());
    let mut unseen = Vec::new();
    if let Some(lower) = cholesky(&part(&normal)) {
        unseen = compensated(&normal, &has_slopes, &lower);
        let of_kept = sandwich(&lower, &middle);
        for (a, &i) in kept.iter().enumerate() {
            for (b, &j) in kept.iter().enumerate() {
                covariance[(i, j)] = of_kept[(a, b)];
            }
        }
    }
    let (covariance, unseen) = known_beforehand::within_known(point, (covariance, unseen));
    Uncertainty {
        covariance,
        seen: with_own_slopes(&normal, UNSEEN),
        unseen,
        ar,
        sigma,
        rows,
        motion,
        at_rest,
        window,
        has_hidden_part: hidden_parts.iter().any(|part| part.is_seen),
        discrepancy,
    }
}

/// H⁻¹ M H⁻¹ for H = LL' with the `lower` L, as the square of H⁻¹R for the `middle` M = RR': where the slopes of two coordinates are hardly different, a product of inverses is rounding, and may have variances below 0.
fn sandwich(lower: &Mat<f64>, middle: &Mat<f64>) -> Mat<f64> {
    let Some(root) = cholesky(middle) else {
        let inverse = inverse_of_square(lower);
        return &inverse * middle * &inverse;
    };
    let size = root.nrows();
    let solved = |j: usize| {
        let column: Vec<f64> = (0..size).map(|i| root[(i, j)]).collect();
        backward_solve(lower, &forward_solve(lower, &column))
    };
    let columns: Vec<Vec<f64>> = (0..size).map(solved).collect();
    let half = Mat::from_fn(size, size, |i, j| columns[j][i]);
    &half * half.transpose()
}

/// Root mean square of all that are known.
fn root_mean_square(errors: &[Vec<f64>]) -> f64 {
    let known = || errors.iter().flatten().filter(|e| !e.is_nan());
    (known().map(|e| e * e).sum::<f64>() / known().count() as f64).sqrt()
}

/// An autoregressive model of the errors, its order by Bayes' criterion.
fn noise(errors: &[Vec<f64>]) -> (Vec<f64>, f64) {
    let count = errors.iter().flatten().filter(|e| !e.is_nan()).count();
    let highest = HIGHEST_ORDER.min(count / 10);
    let present = |e: &f64| if e.is_nan() { 0.0 } else { *e };
    let at_lag = |lag: usize| -> f64 {
        let of_stretch = |e: &Vec<f64>| -> f64 {
            let late = e.iter().skip(lag);
            late.zip(e).map(|(a, b)| present(a) * present(b)).sum()
        };
        errors.iter().map(of_stretch).sum()
    };
    let products: Vec<f64> = (0..=highest).map(at_lag).collect();
    autoregressive(&products, count)
}

/// Covariance of J'e for errors ε/D: σ² times the products of D⁻¹ run backwards over J.
fn by_noise_model(rows: &[Vec<Row>], ar: &[f64], sigma: f64, count: usize) -> Mat<f64> {
    let d = noise_filter(ar);
    let mut filtered: Vec<[f64; MOST]> = Vec::new();
    for stretch in rows {
        let from = filtered.len();
        filtered.extend(stretch.iter().map(|row| row.slope));
        let late = &mut filtered[from..];
        for k in (0..late.len()).rev() {
            for (i, d) in d.iter().enumerate().skip(1) {
                if let Some(next) = late.get(k + i).copied() {
                    for (value, next) in late[k].iter_mut().zip(next) {
                        *value -= d * next;
                    }
                }
            }
        }
    }
    let products = sum_of_products(count, filtered.iter());
    Mat::from_fn(count, count, |i, j| sigma * sigma * products[(i, j)])
}

/// Covariance of J'e from its parts in the blocks.
fn by_blocks(problem: &Problem<'_>, rows: &[Vec<Row>], blocks: usize, count: usize) -> Mat<f64> {
    let mut parts = vec![[0.0; MOST]; blocks];
    for (stretch, rows) in problem.stretches.iter().zip(rows) {
        for (k, row) in rows
            .iter()
            .enumerate()
            .filter(|(_, row)| !row.error.is_nan())
        {
            let part = &mut parts[stretch.block(k)];
            for (sum, slope) in part.iter_mut().zip(row.slope) {
                *sum += slope * row.error;
            }
        }
    }
    sum_of_products(count, parts.iter())
}

/// Covariance of J'e for errors of the equation of size `discrepancy` that are constant over windows.
fn by_windows(rows: &[Vec<Row>], window: usize, discrepancy: f64, count: usize) -> Mat<f64> {
    let windows = rows.iter().flat_map(|rows| rows.chunks(window));
    let sum = |rows: &[Row]| {
        let mut sum = [0.0; MOST];
        for row in rows.iter().filter(|row| !row.error.is_nan()) {
            for (sum, slope) in sum.iter_mut().zip(row.slope) {
                *sum += discrepancy * slope;
            }
        }
        sum
    };
    let sums: Vec<[f64; MOST]> = windows.map(sum).collect();
    sum_of_products(count, sums.iter())
}

/// Sum of the outer products of vectors.
fn sum_of_products<'a>(count: usize, vectors: impl Iterator<Item = &'a [f64; MOST]>) -> Mat<f64> {
    let mut sums = [[0.0; MOST]; MOST];
    for vector in vectors {
        for i in 0..count {
            for j in 0..=i {
                sums[i][j] += vector[i] * vector[j];
            }
        }
    }
    Mat::from_fn(count, count, |i, j| sums[i.max(j)][i.min(j)])
}

/// Coordinates whose slopes are not combinations of those of the coordinates before, but for this `share` of them.
fn with_own_slopes(normal: &Mat<f64>, share: f64) -> Vec<bool> {
    let count = normal.nrows();
    let mut own_slopes: Vec<bool> = Vec::new();
    for i in 0..count {
        let mut with: Vec<usize> = (0..i).filter(|&j| own_slopes[j]).collect();
        with.push(i);
        let scale = |a: usize, b: usize| (normal[(a, a)] * normal[(b, b)]).sqrt();
        let correlation = Mat::from_fn(with.len(), with.len(), |a, b| {
            normal[(with[a], with[b])] / scale(with[a], with[b])
        });
        // The last pivot is the share of its slopes that the others do not have.
        let last = with.len() - 1;
        let own = cholesky(&correlation).map(|lower| lower[(last, last)]);
        own_slopes.push(own.is_some_and(|own| own * own > share));
    }
    own_slopes
}

/// For each coordinate without slopes of its own, the change of all by which the outputs stay: `lower` is Cholesky's factor of the normal
/// matrix of the others.
fn compensated(normal: &Mat<f64>, has_slopes: &[bool], lower: &Mat<f64>) -> Vec<Vec<f64>> {
    let of = |wanted: bool| (0..has_slopes.len()).filter(move |&i| has_slopes[i] == wanted);
    let kept: Vec<usize> = of(true).collect();
    let change = |i: usize| {
        let products: Vec<f64> = kept.iter().map(|&j| normal[(j, i)]).collect();
        let others = backward_solve(lower, &forward_solve(lower, &products));
        let mut all = vec![0.0; has_slopes.len()];
        all[i] = 1.0;
        for (&j, other) in kept.iter().zip(others) {
            all[j] = -other;
        }
        all
    };
    of(false).map(change).collect()
}

/// The smallest covariance, up to rounding, that is at least as large as both in every direction: where `other` has more
/// than `base`, that of `other`.
fn larger(base: &Mat<f64>, other: &Mat<f64>) -> Mat<f64> {
    let Some(lower) = cholesky(base) else {
        return other.clone();
    };
    let whitener = crate::numerics::inverse_of_lower(&lower);
    let relative = &whitener * other * whitener.transpose();
    let Some(eigen) = symmetric_eigen(&relative) else {
        return base.clone();
    };
    let vectors = &lower * eigen.vectors;
    Mat::from_fn(base.nrows(), base.nrows(), |i, j| {
        let term = |k: usize| vectors[(i, k)] * eigen.values[k].max(1.0) * vectors[(j, k)];
        (0..base.nrows()).map(term).sum::<f64>()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two slopes that differ by a millionth of themselves: their squares H = [[1, 1], [1, 1 + ε²]], and M = H. Then H⁻¹ M H⁻¹ is H⁻¹, by hand [[1 + 1/ε², -1/ε²], [-1/ε², 1/ε²]].
    #[test]
    fn slopes_that_are_hardly_different_leave_variances_above_zero() {
        let own: f64 = 1e-12;
        let square = Mat::from_fn(2, 2, |i, j| if i + j == 2 { 1.0 + own } else { 1.0 });
        let found = sandwich(&cholesky(&square).unwrap(), &square);
        let by_hand = [[1.0 + 1.0 / own, -1.0 / own], [-1.0 / own, 1.0 / own]];
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            // 1 + ε² is rounded to 1e-16, a ten-thousandth of ε².
            let off = (found[(i, j)] / by_hand[i][j] - 1.0).abs();
            assert!(off < 1e-3, "{i} {j}: {} {off}", found[(i, j)]);
        }
        assert_eq!(found[(0, 1)], found[(1, 0)]);
    }
}
