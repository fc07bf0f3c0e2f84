//! Lagged moments of input and output: all that identification needs to know of a record, in one
//! pass and a size that does not depend on its length.
//!
//! For the complete rows k of a record the moments are
//!
//! ```text
//! R[a,b] = sum u(k-a) u(k-b)     r[a,j] = sum u(k-a) y(k-j)     Y[i,j] = sum y(k-i) y(k-j)
//! s[a]   = sum u(k-a)            t[j]   = sum y(k-j)            m = number of rows
//! ```
//!
//! with a, b < L lags of the input and i, j < J of the output. Over one stretch k0..k1 of rows only
//! the first row of each needs the data, because
//!
//! ```text
//! X[a+1,b+1] = X[a,b] + x(k0-1-a) z(k0-1-b) - x(k1-1-a) z(k1-1-b)
//! ```
//!
//! so a stretch contributes its lagged sums and two short edges. Moments add up over stretches (a
//! gap ends one), over runs and over recordings. Values are taken relative to the first sample, so
//! that a large constant part costs no digits.

mod stream;

pub use stream::MomentStream;

use faer::Mat;
use serde::{Deserialize, Serialize};

use crate::data::record::{Record, Run};
use crate::error::Error;

/// Lagged moments of the complete rows of a record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Moments {
    sample_period_s: f64,
    #[serde(default)]
    sample_phase_s: f64,
    /// Values are relative to this input and output.
    pub(crate) centre: (f64, f64),
    pub(crate) rows: usize,
    samples: usize,
    missing: usize,
    #[serde(with = "crate::numerics::matrix_rows")]
    pub(crate) uu: Mat<f64>,
    #[serde(with = "crate::numerics::matrix_rows")]
    pub(crate) uy: Mat<f64>,
    #[serde(with = "crate::numerics::matrix_rows")]
    pub(crate) yy: Mat<f64>,
    pub(crate) u: Vec<f64>,
    pub(crate) y: Vec<f64>,
}

impl Moments {
    /// The moments of all runs of `record` for `input_lags` lags of the input and `output_lags`
    /// (at most as many) of the output. A model with settling time N and noise order d needs N+d
    /// and d+1.
    #[must_use]
    pub fn of_record(record: &Record, input_lags: usize, output_lags: usize) -> Self {
        let mut stream = MomentStream::new(record.sample_period_s(), input_lags, output_lags)
            .with_sample_phase(record.sample_phase_s());
        for run in record.runs() {
            stream.push_run(run);
        }
        stream.into_moments()
    }

    /// L: lags of the input.
    #[must_use]
    pub fn input_lags(&self) -> usize {
        self.uu.nrows()
    }

    /// J: lags of the output, the present sample included.
    #[must_use]
    pub fn output_lags(&self) -> usize {
        self.yy.nrows()
    }

    /// Number of complete rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Samples seen, missing ones included.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// Samples that lacked the input or the output.
    #[must_use]
    pub fn missing(&self) -> usize {
        self.missing
    }

    /// Time between samples \[s\].
    #[must_use]
    pub fn sample_period_s(&self) -> f64 {
        self.sample_period_s
    }

    /// Time from an edge of the input to the first sample that counts as after it \[s\].
    #[must_use]
    pub fn sample_phase_s(&self) -> f64 {
        self.sample_phase_s
    }

    /// Sum of squares of the output about its mean.
    #[must_use]
    pub fn output_spread(&self) -> f64 {
        (self.yy[(0, 0)] - self.y[0] * self.y[0] / self.rows.max(1) as f64).max(0.0)
    }

    /// Adds the rows behind `other`, as if both had been collected together.
    ///
    /// # Errors
    /// The two have different lags, sample periods or sample phases.
    pub fn merge(&mut self, other: &Self) -> Result<(), Error> {
        if (self.input_lags(), self.output_lags()) != (other.input_lags(), other.output_lags()) {
            return Err(Error::LagMismatch {
                left: self.input_lags(),
                right: other.input_lags(),
            });
        }
        if self.sample_period_s != other.sample_period_s {
            return Err(Error::PeriodMismatch {
                expected: self.sample_period_s,
                found: other.sample_period_s,
            });
        }
        if self.sample_phase_s != other.sample_phase_s {
            return Err(Error::PhaseMismatch {
                expected: self.sample_phase_s,
                found: other.sample_phase_s,
            });
        }
        let mut other = other.clone();
        if self.rows == 0 {
            self.centre = other.centre;
        }
        other.move_centre(self.centre);
        self.accumulate(&other, 1.0);
        Ok(())
    }

    /// The moments of fewer input lags over all rows of `record` that are complete for them, when
    /// `self` holds those of more. The few rows that the longer history costs are added one by one;
    /// where they are many, a new pass is made.
    pub(crate) fn with_fewer_lags(&self, record: &Record, input_lags: usize) -> Self {
        let outputs = self.output_lags();
        let gained: Vec<(&Run, usize)> = record
            .runs()
            .iter()
            .flat_map(|run| {
                let long = run.complete_rows(self.input_lags(), outputs);
                let mut long = long.into_iter().peekable();
                run.complete_rows(input_lags, outputs)
                    .into_iter()
                    .flat_map(move |span| {
                        // A long stretch lies within a short one and ends with it, so what it lacks
                        // is the beginning.
                        let start = long.next_if(|long| long.end == span.end);
                        (span.start..start.map_or(span.end, |long| long.start))
                            .map(move |k| (run, k))
                    })
            })
            .collect();
        if gained.len() > Self::ROWS_ADDED_SINGLY {
            return Self::of_record(record, input_lags, outputs);
        }
        let mut moments = self.truncated(input_lags, outputs);
        for (run, k) in gained {
            moments.add_row(run, k);
        }
        moments
    }

    /// Rows that cost less one by one than another pass over the data.
    const ROWS_ADDED_SINGLY: usize = 500;

    fn add_row(&mut self, run: &Run, k: usize) {
        let inputs: Vec<f64> = (0..self.input_lags())
            .map(|a| run.input_at(k as isize - a as isize) - self.centre.0)
            .collect();
        let outputs: Vec<f64> = (0..self.output_lags())
            .map(|j| run.output()[k - j] - self.centre.1)
            .collect();
        rank_one(&mut self.uu, &inputs, &inputs, 1.0);
        rank_one(&mut self.uy, &inputs, &outputs, 1.0);
        rank_one(&mut self.yy, &outputs, &outputs, 1.0);
        let sums = self
            .u
            .iter_mut()
            .zip(&inputs)
            .chain(self.y.iter_mut().zip(&outputs));
        sums.for_each(|(sum, value)| *sum += value);
        self.rows += 1;
    }

    /// Adds the rows behind `part`, which has the same lags and centre.
    pub(crate) fn add(&mut self, part: &Self) {
        debug_assert_eq!(self.centre, part.centre);
        self.accumulate(part, 1.0);
    }

    /// Takes the rows behind `part` out again. Both must have been collected with the same centre
    /// and lags.
    pub(crate) fn without(&self, part: &Self) -> Self {
        debug_assert_eq!(self.centre, part.centre);
        let mut rest = self.clone();
        rest.accumulate(part, -1.0);
        rest
    }

    fn accumulate(&mut self, other: &Self, sign: f64) {
        self.uu += faer::Scale(sign) * &other.uu;
        self.uy += faer::Scale(sign) * &other.uy;
        self.yy += faer::Scale(sign) * &other.yy;
        for (sum, value) in self
            .u
            .iter_mut()
            .zip(&other.u)
            .chain(self.y.iter_mut().zip(&other.y))
        {
            *sum += sign * value;
        }
        let count = |mine: usize, theirs| {
            if sign > 0.0 {
                mine + theirs
            } else {
                mine - theirs
            }
        };
        self.rows = count(self.rows, other.rows);
        self.samples = count(self.samples, other.samples);
        self.missing = count(self.missing, other.missing);
    }

    /// Expresses the moments relative to another centre.
    fn move_centre(&mut self, centre: (f64, f64)) {
        let (du, dy) = (self.centre.0 - centre.0, self.centre.1 - centre.1);
        let rows = self.rows as f64;
        let (u, y) = (&self.u, &self.y);
        let shift = |matrix: &mut Mat<f64>, x: &[f64], dx: f64, z: &[f64], dz: f64| {
            for b in 0..matrix.ncols() {
                for a in 0..matrix.nrows() {
                    matrix[(a, b)] += dz * x[a] + dx * z[b] + rows * dx * dz;
                }
            }
        };
        shift(&mut self.uu, u, du, u, du);
        shift(&mut self.uy, u, du, y, dy);
        shift(&mut self.yy, y, dy, y, dy);
        self.u.iter_mut().for_each(|sum| *sum += rows * du);
        self.y.iter_mut().for_each(|sum| *sum += rows * dy);
        self.centre = centre;
    }

    /// The moments of fewer lags over the same rows.
    #[must_use]
    pub(crate) fn truncated(&self, input_lags: usize, output_lags: usize) -> Self {
        let part = |matrix: &Mat<f64>, rows, columns| {
            matrix.as_ref().submatrix(0, 0, rows, columns).to_owned()
        };
        Self {
            uu: part(&self.uu, input_lags, input_lags),
            uy: part(&self.uy, input_lags, output_lags),
            yy: part(&self.yy, output_lags, output_lags),
            u: self.u[..input_lags].to_vec(),
            y: self.y[..output_lags].to_vec(),
            ..*self
        }
    }

    /// Moments of rows Z'Z, Z = [u(k)..u(k-L+1) | 1 | y(k)..y(k-J+1)], given as the square matrix
    /// of all inner products.
    pub(crate) fn from_products(template: &Self, products: &Mat<f64>) -> Self {
        let (l, j) = (template.input_lags(), template.output_lags());
        let part = |row, column, rows, columns| {
            products
                .as_ref()
                .submatrix(row, column, rows, columns)
                .to_owned()
        };
        Self {
            uu: part(0, 0, l, l),
            uy: part(0, l + 1, l, j),
            yy: part(l + 1, l + 1, j, j),
            u: (0..l).map(|a| products[(l, a)]).collect(),
            y: (0..j).map(|a| products[(l, l + 1 + a)]).collect(),
            ..*template
        }
    }
}

fn rank_one(matrix: &mut Mat<f64>, rows: &[f64], columns: &[f64], sign: f64) {
    for (b, column) in columns.iter().enumerate() {
        let scale = sign * column;
        for (entry, row) in matrix.col_as_slice_mut(b).iter_mut().zip(rows) {
            *entry += scale * row;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// The definition, term by term.
    fn by_definition(record: &Record, l: usize, j: usize, centre: (f64, f64)) -> Mat<f64> {
        let mut products = Mat::zeros(l + 1 + j, l + 1 + j);
        for run in record.runs() {
            for k in run.complete_rows(l, j).into_iter().flatten() {
                let row: Vec<f64> = (0..l)
                    .map(|a| run.input_at(k as isize - a as isize) - centre.0)
                    .chain([1.0])
                    .chain((0..j).map(|a| run.output()[k - a] - centre.1))
                    .collect();
                for a in 0..row.len() {
                    for b in 0..row.len() {
                        products[(a, b)] += row[a] * row[b];
                    }
                }
            }
        }
        products
    }

    fn close(a: &Mat<f64>, b: &Mat<f64>, scale: f64) {
        for i in 0..a.nrows() {
            for k in 0..a.ncols() {
                // Sums of a few thousand products.
                assert_relative_eq!(a[(i, k)], b[(i, k)], epsilon = 1e-12 * scale);
            }
        }
    }

    fn gappy_record() -> Record {
        let run = |seed: u64, samples: usize| {
            let mut state = seed;
            let mut noise = || {
                state = state
                    .wrapping_mul(6364136223846793005)
                    .wrapping_add(1442695040888963407);
                (state >> 33) as f64 / 2f64.powi(31) - 0.5
            };
            let mut u: Vec<f64> = (0..samples).map(|_| 2048.0 + 100.0 * noise()).collect();
            let mut y: Vec<f64> = (0..samples).map(|_| 7.0 + noise()).collect();
            u[samples / 3] = f64::NAN;
            y[samples / 2] = f64::NAN;
            y[samples / 2 + 3] = f64::NAN;
            Run::new(u, y).unwrap()
        };
        let runs = vec![
            run(1, 3000),
            run(2, 40).with_input_at_rest(2050.0),
            run(3, 700),
        ];
        Record::new(0.002, runs).unwrap()
    }

    #[test]
    fn moments_are_what_their_definition_says_with_gaps_runs_and_rest() {
        let record = gappy_record();
        let (l, j) = (23, 4);
        let moments = Moments::of_record(&record, l, j);
        assert_eq!(moments.rows(), record.count_rows(l, j));
        let expected = by_definition(&record, l, j, moments.centre);
        let expected = Moments::from_products(&moments, &expected);
        let scale = moments.uu[(0, 0)];
        close(&moments.uu, &expected.uu, scale);
        close(&moments.uy, &expected.uy, scale);
        close(&moments.yy, &expected.yy, scale);
        for (a, b) in moments
            .u
            .iter()
            .zip(&expected.u)
            .chain(moments.y.iter().zip(&expected.y))
        {
            assert_relative_eq!(a, b, epsilon = 1e-12 * scale);
        }
    }

    #[test]
    fn fewer_lags_can_be_had_from_more() {
        let record = gappy_record();
        let direct = Moments::of_record(&record, 23, 4);
        let derived = Moments::of_record(&record, 41, 4).with_fewer_lags(&record, 23);
        assert_eq!(derived.rows(), direct.rows());
        close(&derived.uu, &direct.uu, direct.uu[(0, 0)]);
        close(&derived.uy, &direct.uy, direct.uu[(0, 0)]);
        close(&derived.yy, &direct.yy, direct.uu[(0, 0)]);
    }

    #[test]
    fn pieces_of_any_size_and_merging_give_the_same() {
        let record = gappy_record();
        let whole = Moments::of_record(&record, 23, 4);
        let mut stream = MomentStream::new(0.002, 23, 4);
        for run in record.runs() {
            stream.begin_run(run.input_at_rest());
            for (u, y) in run.input().chunks(777).zip(run.output().chunks(777)) {
                stream.push(u, y);
                let _ = stream.moments(); // Looking does not disturb.
            }
        }
        let streamed = stream.moments();
        assert_eq!(
            (streamed.rows(), streamed.missing()),
            (whole.rows(), whole.missing())
        );
        close(&streamed.uu, &whole.uu, whole.uu[(0, 0)]);
        close(&streamed.uy, &whole.uy, whole.uu[(0, 0)]);

        let mut merged: Option<Moments> = None;
        for run in record.runs() {
            let alone = Record::new(0.002, vec![run.clone()]).unwrap();
            let moments = Moments::of_record(&alone, 23, 4);
            match &mut merged {
                None => merged = Some(moments),
                Some(merged) => merged.merge(&moments).unwrap(),
            }
        }
        let merged = merged.unwrap();
        assert_eq!(merged.rows(), whole.rows());
        close(&merged.uu, &whole.uu, whole.uu[(0, 0)]);
        close(&merged.uy, &whole.uy, whole.uu[(0, 0)]);
        close(&merged.yy, &whole.yy, whole.uu[(0, 0)]);
    }

    #[test]
    fn saving_and_loading_loses_nothing() {
        let moments = Moments::of_record(&gappy_record(), 9, 3);
        let text = serde_json::to_string(&moments).unwrap();
        let loaded: Moments = serde_json::from_str(&text).unwrap();
        close(&loaded.uu, &moments.uu, moments.uu[(0, 0)]);
        assert_eq!(loaded.rows(), moments.rows());
    }
}
