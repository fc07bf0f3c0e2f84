//! Generalised least squares (GLS): alternating fits of the response and of the noise model.
//!
//! With D fixed, the response is least squares on D-filtered rows. With the response fixed, D is least
//! squares on the residuals of the same rows (Clarke 1967; Söderström 1975). Both half steps lower the same
//! sum of squares J(θ, D), so J never rises.
//!
//! Residuals are smaller than the noise, because the fitted parameters absorb part of it. Their moments are
//! corrected for the absorbed part, E\[i,j\] += σ² tr(R_ij (Z'Z)^-1), before the final D is fitted. This is
//! the idea of restricted likelihood. Without it, bounds would be too narrow with many parameters.

use std::sync::Arc;

use faer::{ColRef, Mat};

use crate::estimation::lag_products::LagProducts;
use crate::estimation::least_squares::{Coordinates, RowInformation, Solution};
use crate::estimation::noise_model::NoiseFit;
use crate::estimation::noise_order::{OrderCandidate, best_order};
use crate::numerics::{dot, largest_difference, times};
use crate::options::NoiseOrder;

/// Passes in which the order may change. Afterwards it is fixed, so that two orders of nearly equal BIC
/// cannot alternate for ever.
const FREE_ORDER_PASSES: usize = 6;

/// Passes with corrected residual moments. Further passes change nothing relevant.
const CORRECTED_PASSES: usize = 3;

/// Options of the alternation.
#[derive(Debug, Clone, PartialEq)]
pub struct GlsOptions {
    /// Order of D.
    pub order: NoiseOrder,
    /// Largest change of a coefficient of D at convergence.
    pub tolerance: f64,
    /// Largest number of passes.
    pub max_iterations: usize,
    /// Whether the residual moments are corrected for the fitted parameters.
    pub corrected: bool,
    /// Coefficients of D to start from.
    pub start: Vec<f64>,
}

impl Default for GlsOptions {
    fn default() -> Self {
        Self {
            order: NoiseOrder::Auto,
            tolerance: 1e-8,
            max_iterations: 100,
            corrected: true,
            start: Vec::new(),
        }
    }
}

/// What a covariance has beside that of even noise.
#[derive(Clone, Default)]
pub struct FurtherSpread {
    /// Added to (Z_D'Z_D)^-1: noise that is not even, or cut at its tails, and what was estimated for each run.
    pub noise: Option<Mat<f64>>,
    /// The parts of [`Self::noise`] whose size is less sure than that of the whole: noise that grows with motion, answers and levels that scatter.
    pub estimated: Vec<EstimatedPart>,
    /// By how much a slow end that is not in the response moves the coordinates and the offset, in standard deviations of ε.
    pub slow_end: Option<Vec<f64>>,
    /// What differs from run to run.
    pub runs: Option<RunSpread>,
    /// What the ends of the noise add to the relative variance of a variance: a third of the excess kurtosis of an estimate, because
    /// Student's t with ν degrees of freedom has the excess 6/ν and a relative variance 2/ν.
    pub tails: f64,
}

/// A part of a covariance whose size was estimated by itself.
#[derive(Clone)]
pub struct EstimatedPart {
    /// Its covariance of the coordinates and the offset, over the variance of ε.
    pub covariance: Mat<f64>,
    /// Variance of the estimate of its size, relative to the square of that.
    pub relative_variance: f64,
}

/// Differences between the runs of one servo, as far as the mean of these runs has them.
#[derive(Clone)]
pub struct RunSpread {
    /// Directions of the coordinates and the offset, one in each column, of which each has one standard deviation of ε.
    pub directions: Mat<f64>,
    /// The same, of the quantities that scatter, as if they did so independently.
    pub quantities: Mat<f64>,
    /// Degrees of freedom: runs less one.
    pub degrees: f64,
}

/// A generalised least-squares fit.
#[derive(Clone)]
pub struct GlsFit {
    /// The bank and its coordinates.
    pub coordinates: Coordinates,
    /// Least squares with the final D.
    pub solution: Solution,
    /// d_1..d_d.
    pub ar: Vec<f64>,
    /// Covariance of d_1..d_d.
    pub ar_covariance: Mat<f64>,
    /// Variance of ε: RSS / (rows - parameters - d), the offset being one of the parameters.
    pub variance: f64,
    /// What the covariance has beside (Z_D'Z_D)^-1.
    pub further: FurtherSpread,
    /// Of the prior of the lags ([`RowInformation::precision`]).
    pub(crate) precision: f64,
    /// Number of rows used.
    pub rows: usize,
    /// Number of passes.
    pub iterations: usize,
    /// Whether D converged.
    pub converged: bool,
    /// The noise orders considered, with their criterion.
    pub orders: Vec<OrderCandidate>,
}

impl GlsFit {
    /// Fits response and noise. `None` when the rows do not determine the response.
    pub fn of(
        information: &RowInformation,
        coordinates: &Coordinates,
        options: &GlsOptions,
    ) -> Option<Self> {
        let lags = information.moments.input_lags() - coordinates.basis.settling();
        let available = lags.min(information.moments.output_lags() - 1);
        let max_order = options.order.highest().min(available);
        let spread = information.moments.output_spread();
        let mut ar = options.start.clone();
        ar.truncate(available);
        let mut orders = Vec::new();
        let (mut iterations, mut converged) = (0, false);
        while iterations < options.max_iterations && !converged {
            iterations += 1;
            let solution = information.solve_coordinates(coordinates, &ar)?;
            let next = match noise_of(information, coordinates, &solution, max_order, None) {
                Some(noise) => {
                    let order = match options.order {
                        NoiseOrder::Order(_) => max_order,
                        NoiseOrder::Auto if iterations > FREE_ORDER_PASSES => ar.len(),
                        NoiseOrder::Auto => {
                            orders = noise.candidates(information.rows());
                            best_order(&orders)
                        }
                    };
                    noise.coefficients(order)
                }
                None => Vec::new(), // The fit is exact: there is no noise to model.
            };
            converged = spread == 0.0 || largest_difference(&ar, &next) <= options.tolerance;
            ar = next;
        }
        let mut solution = information.solve(coordinates, &ar)?;
        let precision = information.precision();
        let variance = |solution: &Solution, order: usize| {
            let parameters = determined(solution, precision);
            solution.rss / degrees_of_freedom(information.rows(), parameters, order)
        };
        if options.corrected && !ar.is_empty() {
            for _ in 0..CORRECTED_PASSES {
                let correction = Some((&solution.inverse, variance(&solution, ar.len())));
                let found = &solution.coordinates;
                let noise = noise_of(information, coordinates, found, ar.len(), correction);
                let Some(noise) = noise else { break };
                let corrected = noise.coefficients(ar.len());
                let Some(next) = information.solve(coordinates, &corrected) else {
                    break;
                };
                ar = corrected;
                solution = next;
            }
        }
        let variance = variance(&solution, ar.len());
        let correction = options.corrected.then_some((&solution.inverse, variance));
        let found = &solution.coordinates;
        let ar_covariance = noise_of(information, coordinates, found, ar.len(), correction)
            .map_or_else(
                || Mat::zeros(ar.len(), ar.len()),
                |noise| faer::Scale(variance) * noise.unit_covariance(ar.len()),
            );
        Some(Self {
            coordinates: coordinates.clone(),
            solution,
            ar,
            ar_covariance,
            variance,
            further: FurtherSpread::default(),
            precision,
            rows: information.rows(),
            iterations,
            converged,
            orders,
        })
    }

    /// Degrees of freedom of the variance: rows - parameters - offset - d.
    pub fn degrees_of_freedom(&self) -> f64 {
        degrees_of_freedom(
            self.rows,
            determined(&self.solution, self.precision),
            self.ar.len(),
        )
    }

    /// The impulse response, N samples.
    pub fn impulse(&self) -> Vec<f64> {
        self.coordinates.impulse(self.solution.response())
    }

    /// θ.
    pub fn theta(&self) -> Vec<f64> {
        match self.coordinates.theta_map() {
            Some(map) => times(&map, self.solution.response()),
            None => self.solution.response().to_vec(),
        }
    }

    /// The part of it that is of the noise.
    pub(crate) fn noise_covariance(&self) -> Mat<f64> {
        match &self.further.noise {
            Some(noise) => &self.solution.inverse + noise,
            None => self.solution.inverse.clone(),
        }
    }

    /// Covariance of the coordinates and the offset, over the variance of ε.
    pub(crate) fn unit_covariance(&self) -> Mat<f64> {
        let mut covariance = self.noise_covariance();
        if let Some(moved) = &self.further.slow_end {
            let moved = ColRef::from_slice(moved);
            covariance += moved * moved.transpose();
        }
        if let Some(runs) = &self.further.runs {
            covariance += &runs.directions * runs.directions.transpose();
        }
        covariance
    }

    /// Whether the covariance of the noise is that of even noise.
    pub(crate) fn has_even_noise(&self) -> bool {
        self.further.noise.is_none()
    }

    /// Adds to the covariance `ratio` - 1 times what it is, and `more`.
    pub(crate) fn spread_further(&mut self, ratio: f64, more: Option<Mat<f64>>) {
        let mut further = faer::Scale(ratio - 1.0) * &self.solution.inverse;
        if let Some(noise) = self.further.noise.take() {
            further += faer::Scale(ratio) * noise;
        }
        if let Some(more) = more {
            further += more;
        }
        self.further.noise = Some(further);
    }

    /// Adds a part to the covariance whose size was estimated by itself.
    pub(crate) fn spread_by(&mut self, part: EstimatedPart) {
        self.spread_further(1.0, Some(part.covariance.clone()));
        self.further.estimated.push(part);
    }

    /// Covariance of θ and, as last row and column, the offset: (n+1) x (n+1).
    pub fn covariance(&self) -> Mat<f64> {
        let p = self.coordinates.len();
        let mut covariance = match self.coordinates.theta_map() {
            None => self.unit_covariance(),
            Some(map) => {
                let bordered = Mat::from_fn(p + 1, p + 1, |i, j| match (i, j) {
                    (i, j) if i < p && j < p => map[(i, j)],
                    (i, j) => f64::from(u8::from(i == j)),
                });
                &bordered * self.unit_covariance() * bordered.transpose()
            }
        };
        for j in 0..=p {
            for i in 0..=j {
                let value = self.variance * (covariance[(i, j)] + covariance[(j, i)]) / 2.0;
                covariance[(i, j)] = value;
                covariance[(j, i)] = value;
            }
        }
        covariance
    }

    /// The least squares of the same bank as if the noise were white; `None` where the rows do not determine it.
    pub(crate) fn in_white_noise(&self, information: &RowInformation) -> Option<Self> {
        Some(Self {
            solution: information.solve(&self.coordinates, &[])?,
            ar: Vec::new(),
            ..self.clone()
        })
    }

    /// The offset c of y = G u + c; that of the solution is relative to the centre of the moments.
    pub fn offset(&self, information: &RowInformation) -> f64 {
        let gain: f64 = self.impulse().iter().sum();
        let (u, y) = information.moments.centre;
        self.solution.offset() + y - gain * u
    }
}

fn degrees_of_freedom(rows: usize, parameters: f64, order: usize) -> f64 {
    (rows as f64 - (parameters + (1 + order) as f64)).max(1.0)
}

/// The number of coordinates that the rows determine, and not the prior: all where there is none.
fn determined(solution: &Solution, precision: f64) -> f64 {
    let count = solution.response().len();
    if precision == 0.0 {
        return count as f64;
    }
    let by_prior: f64 = (0..count).map(|k| solution.inverse[(k, k)]).sum();
    count as f64 - precision * by_prior
}

/// The noise fit to the residuals of `solution` (coordinates and offset). With the inverse and the variance
/// of ε, their moments are corrected for the fitted parameters.
fn noise_of(
    information: &RowInformation,
    coordinates: &Coordinates,
    solution: &[f64],
    order: usize,
    correction: Option<(&Mat<f64>, f64)>,
) -> Option<NoiseFit> {
    let (offset, response) = solution.split_last()?;
    let mut moments = information.residual_moments_of(coordinates, response, *offset, order);
    if let Some((inverse, variance)) = correction {
        let absorbed = absorbed_noise(information, coordinates, inverse, order);
        moments += faer::Scale(variance) * absorbed;
    }
    NoiseFit::new(&moments, information.moments.output_spread())
}

/// tr(R_ij (Z'Z)^-1), i, j = 0..=order: the part of the lagged noise moments, per unit variance, that the
/// fitted parameters absorb.
fn absorbed_noise(
    information: &RowInformation,
    coordinates: &Coordinates,
    inverse: &Mat<f64>,
    order: usize,
) -> Mat<f64> {
    let moments = &information.moments;
    let p = coordinates.len();
    let block = inverse.as_ref().submatrix(0, 0, p, p).to_owned();
    let border: Vec<f64> = (0..p).map(|k| inverse[(k, p)]).collect();
    let border = coordinates.impulse(&border);
    let traces = Traces::new(information, coordinates, block);
    let mut absorbed = Mat::zeros(order + 1, order + 1);
    for i in 0..=order {
        for j in 0..=i {
            let response = traces.of(i, j);
            let edges = dot(&border, &moments.u[i..]) + dot(&border, &moments.u[j..]);
            let value = response + edges + moments.rows as f64 * inverse[(p, p)];
            absorbed[(i, j)] = value;
            absorbed[(j, i)] = value;
        }
    }
    absorbed
}

/// tr(R_ij T C T') for a covariance C of the coordinates.
enum Traces<'a> {
    /// As tr(T'R_ij T C).
    InCoordinates(Arc<LagProducts>, Mat<f64>),
    /// With the covariance of the impulse response.
    ByLags(&'a Mat<f64>, Mat<f64>),
}

impl<'a> Traces<'a> {
    fn new(
        information: &'a RowInformation,
        coordinates: &Coordinates,
        covariance: Mat<f64>,
    ) -> Self {
        match information.lag_products(coordinates) {
            Some(products) => Self::InCoordinates(products, covariance),
            None => Self::ByLags(&information.moments.uu, coordinates.expand(covariance)),
        }
    }

    fn of(&self, i: usize, j: usize) -> f64 {
        match self {
            Self::InCoordinates(products, covariance) => {
                let product = products.at(i, j);
                (0..covariance.ncols())
                    .map(|k| dot(covariance.col_as_slice(k), product.col_as_slice(k)))
                    .sum()
            }
            Self::ByLags(uu, covariance) => (0..covariance.ncols())
                .map(|b| dot(covariance.col_as_slice(b), &uu.col_as_slice(b + j)[i..]))
                .sum(),
        }
    }
}
