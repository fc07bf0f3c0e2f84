//! The estimate behind a frequency response in a band, as a row of independent values.
//!
//! All lags up to N are estimated there, and the prior makes up for what the record does not determine. Without the prior the normal equations are
//!
//! ```text
//! s = Z'D'D y,   E s = Z'D'D U h,   Cov s = σ² M,   M = Z'D'D Z
//! ```
//!
//! with U the lags up to 2N, and the offset of each run taken out of rows and output. Along the eigenvectors v of M, v's / (σ √e) are independent, of unit variance,
//! and linear in h. Of these, those are kept that the record determines better than the prior does, e > λ, and that consist of frequencies in the band. Below and
//! above it the input may have no more than errors of its commands. Noise that is not even, and these errors, count as noise that is larger everywhere, by as much as they
//! make bounds wider where they do so most.

use faer::Mat;

use super::identified_response::{IdentifiedBand, IdentifiedResponse};
use super::projection::{LENGTH, Projection, with_history};
use crate::data::{Moments, Record, Run};
use crate::diagnostics::trend_at;
use crate::error::Error;
use crate::estimation::{Coordinates, Edges, FsfBasis, filtered_input_moments, noise_filter};
use crate::numerics::{dot, symmetric_eigen, times};
use crate::results::{BandEstimate, Model};

/// Share of an eigenvector, in squares, that is in the band.
const MOSTLY: f64 = 0.5;

/// The values, of the rows of `record` that `model` was identified from by `estimate`.
pub(super) fn in_band(
    record: &Record,
    model: &Model,
    estimate: &BandEstimate,
) -> Result<Projection, Error> {
    let n = estimate.settling_samples;
    let band = IdentifiedBand::new(model);
    let equations = Equations::of_record(record, estimate)?;
    let refused = || Error::NoHistory { history: n };
    let eigen = symmetric_eigen(&equations.square()).ok_or_else(refused)?;
    let score = times(&eigen.vectors.transpose().to_owned(), &equations.score);
    let variance = equations.variance(&eigen.values, &score, estimate);
    // Test and intervals allow for what is not even noise alike.
    let variance = variance.ok_or_else(refused)? * estimate.beyond_even_noise.powi(2);
    let ends = band.ends().ok_or_else(refused)?;
    let in_band = shares_in_band(&eigen.vectors, ends);
    let kept: Vec<usize> = (0..n)
        .filter(|&i| eigen.values[i] > estimate.precision && in_band[i] > MOSTLY)
        .collect();
    let scale = |i: usize| (variance * eigen.values[i]).sqrt().recip();
    let whitening = Mat::from_fn(kept.len(), n, |k, lag| {
        eigen.vectors[(lag, kept[k])] * scale(kept[k])
    });
    Ok(Projection {
        estimate: kept.iter().map(|&i| score[i] * scale(i)).collect(),
        map: whitening * &equations.products,
        identified: IdentifiedResponse::Band(band),
    })
}

/// The share of each column, in squares, that is between these frequencies \[rad/sample\].
fn shares_in_band(columns: &Mat<f64>, [from, to]: [f64; 2]) -> Vec<f64> {
    let kernel = |apart: f64| match apart == 0.0 {
        true => (to - from) / std::f64::consts::PI,
        false => ((to * apart).sin() - (from * apart).sin()) / (std::f64::consts::PI * apart),
    };
    let size = columns.nrows();
    let by_distance: Vec<f64> = (0..size).map(|apart| kernel(apart as f64)).collect();
    let within = Mat::from_fn(size, size, |i, j| by_distance[i.abs_diff(j)]) * columns;
    let share = |i: usize| dot(within.col_as_slice(i), columns.col_as_slice(i));
    (0..columns.ncols()).map(share).collect()
}

/// Normal equations of the lags, behind D, the offsets of the runs taken out.
struct Equations {
    /// Z'U: N x 2N.
    products: Mat<f64>,
    /// Z'y.
    score: Vec<f64>,
    /// y'y.
    square_of_output: f64,
    rows: usize,
    runs: usize,
}

impl Equations {
    fn of_record(record: &Record, estimate: &BandEstimate) -> Result<Self, Error> {
        let n = estimate.settling_samples;
        let mut all = Self {
            products: Mat::zeros(n, LENGTH * n),
            score: vec![0.0; n],
            square_of_output: 0.0,
            rows: 0,
            runs: 0,
        };
        let coordinates = Coordinates::new(FsfBasis::full(n)?);
        for (index, run) in with_history(record, n)?.runs().iter().enumerate() {
            let slope = estimate.slopes.get(index).copied().unwrap_or(0.0);
            let level = (run.output().iter().zip(0..)).map(|(y, k)| y - slope * trend_at(run, k));
            let run = run.with_output(level.collect());
            all.add(&run, record.sample_period_s(), &coordinates, &estimate.ar)?;
        }
        Ok(all)
    }

    fn add(
        &mut self,
        run: &Run,
        period_s: f64,
        coordinates: &Coordinates,
        ar: &[f64],
    ) -> Result<(), Error> {
        let (n, length) = (self.products.nrows(), self.products.ncols());
        let alone = Record::new(period_s, vec![run.clone()])?;
        let moments = Moments::of_record(&alone, length + ar.len(), ar.len() + 1);
        if moments.rows() == 0 {
            return Ok(());
        }
        let d = noise_filter(ar);
        let edges = Edges::new(&moments, coordinates, ar);
        let gain: f64 = d.iter().sum();
        let with_offset: Vec<f64> = (0..length)
            .map(|lag| gain * dot(&d, &moments.u[lag..]))
            .collect();
        let per_offset: Vec<f64> = with_offset
            .iter()
            .map(|e| e / edges.offset_square)
            .collect();
        let products = filtered_input_moments(&moments.uu, length, &d);
        for (lag, with_offset) in with_offset.iter().enumerate() {
            let column = self.products.col_as_slice_mut(lag).iter_mut();
            let own = products.col_as_slice(lag).iter().zip(&per_offset);
            for (sum, (product, per_offset)) in column.zip(own) {
                *sum += product - per_offset * with_offset;
            }
        }
        for (lag, sum) in self.score.iter_mut().enumerate().take(n) {
            *sum += edges.edge[(lag, 0)] - per_offset[lag] * edges.offset_output;
        }
        self.square_of_output += edges.c - edges.offset_output.powi(2) / edges.offset_square;
        self.rows += moments.rows();
        self.runs += 1;
        Ok(())
    }

    /// M.
    fn square(&self) -> Mat<f64> {
        let n = self.products.nrows();
        self.products.as_ref().subcols(0, n).to_owned()
    }

    /// The variance of ε by the estimate under the prior, whose parameters are those that the rows determine; `None` without degrees of freedom. `values` are the
    /// eigenvalues of M, and `score` is along its eigenvectors.
    fn variance(&self, values: &[f64], score: &[f64], estimate: &BandEstimate) -> Option<f64> {
        let prior = estimate.precision;
        let (mut squares, mut degrees) = (self.square_of_output, self.rows as f64);
        for (value, score) in values.iter().map(|e| e.max(0.0)).zip(score) {
            let found = score / (value + prior);
            squares -= found * (score + prior * found);
            degrees -= value / (value + prior);
        }
        degrees -= (self.runs + estimate.ar.len()) as f64;
        (degrees >= 1.0 && squares > 0.0).then(|| squares / degrees)
    }
}
