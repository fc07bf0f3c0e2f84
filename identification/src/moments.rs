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

use faer::Mat;
use serde::{Deserialize, Serialize};

use crate::error::Error;
use crate::lagged_sums::LaggedSums;
use crate::record::{Record, Run};

/// Lagged moments of the complete rows of a record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Moments {
    sample_period_s: f64,
    /// Values are relative to this input and output.
    pub(crate) centre: (f64, f64),
    pub(crate) rows: usize,
    samples: usize,
    missing: usize,
    #[serde(with = "crate::matrix_serde")]
    pub(crate) uu: Mat<f64>,
    #[serde(with = "crate::matrix_serde")]
    pub(crate) uy: Mat<f64>,
    #[serde(with = "crate::matrix_serde")]
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
        let mut stream = MomentStream::new(record.sample_period_s(), input_lags, output_lags);
        for run in record.runs() {
            stream.push_run(run);
        }
        stream.moments()
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

    /// Sum of squares of the output about its mean.
    #[must_use]
    pub fn output_spread(&self) -> f64 {
        (self.yy[(0, 0)] - self.y[0] * self.y[0] / self.rows.max(1) as f64).max(0.0)
    }

    /// Adds the rows behind `other`, as if both had been collected together.
    ///
    /// # Errors
    /// The two have different lags or sample periods.
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

/// Collects [`Moments`] while samples arrive, in pieces of any size.
///
/// ```
/// use servoid_identification::moments::MomentStream;
/// let mut stream = MomentStream::new(0.002, 3, 1);
/// stream.push(&[0.0, 1.0], &[0.0, 0.0]);
/// stream.push(&[1.0, 0.0], &[0.5, 1.0]);
/// assert_eq!(stream.moments().rows(), 2);
/// ```
#[derive(Clone)]
pub struct MomentStream {
    sample_period_s: f64,
    input_lags: usize,
    output_lags: usize,
    centre: (Option<f64>, Option<f64>),
    /// Recent centred samples: at least input_lags of history, then those not yet summed.
    u: Vec<f64>,
    y: Vec<f64>,
    summed: usize,
    /// Samples present in a row, up to `summed`.
    present: (usize, usize),
    /// Whether the row before `summed` was complete.
    open: bool,
    sums: LaggedSums,
    /// sum u(k) y(k-j) and sum y(k) y(k-j).
    uy: Vec<f64>,
    yy: Vec<f64>,
    total: (f64, f64),
    edges: Edges,
    rows: usize,
    samples: usize,
    missing: usize,
}

impl MomentStream {
    /// An empty collection (see [`Moments::of_record`] for the lags).
    ///
    /// # Panics
    /// When a number of lags is zero, or there are more lags of the output than of the input.
    #[must_use]
    pub fn new(sample_period_s: f64, input_lags: usize, output_lags: usize) -> Self {
        assert!(
            (1..=input_lags).contains(&output_lags),
            "{output_lags} output lags do not fit {input_lags} input lags"
        );
        Self {
            sample_period_s,
            input_lags,
            output_lags,
            centre: (None, None),
            u: Vec::new(),
            y: Vec::new(),
            summed: 0,
            present: (0, 0),
            open: false,
            sums: LaggedSums::new(input_lags),
            uy: vec![0.0; output_lags],
            yy: vec![0.0; output_lags],
            total: (0.0, 0.0),
            edges: Edges::new(input_lags, output_lags),
            rows: 0,
            samples: 0,
            missing: 0,
        }
    }

    /// Adds consecutive samples of the current run, NaN where one is missing.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn push(&mut self, input: &[f64], output: &[f64]) {
        assert_eq!(input.len(), output.len(), "one output per input");
        let block = self.sums.block_rows();
        let pieces = input.chunks(block).zip(output.chunks(block));
        for (input, output) in pieces {
            self.append(input, output);
            if self.u.len() - self.summed >= block {
                self.sum_pending();
            }
        }
    }

    /// Adds a whole run.
    pub fn push_run(&mut self, run: &Run) {
        self.begin_run(run.input_at_rest());
        self.push(run.input(), run.output());
    }

    /// Begins another run: samples pushed from here on have no history, or that of an input that
    /// has been `at_rest` all along.
    pub fn begin_run(&mut self, at_rest: Option<f64>) {
        self.sum_pending();
        self.close(self.u.len());
        self.u.clear();
        self.y.clear();
        self.summed = 0;
        self.present = (0, 0);
        if let Some(input) = at_rest {
            let history = self.input_lags - 1;
            let centre = *self.centre.0.get_or_insert(input);
            self.u.resize(history, input - centre);
            self.y.resize(history, f64::NAN);
            self.summed = history;
            self.present.0 = history;
        }
    }

    /// The moments of all samples so far.
    #[must_use]
    pub fn moments(&self) -> Moments {
        let mut done = self.clone();
        done.sum_pending();
        done.close(done.u.len());
        let (uu, yu) = done.sums.sums();
        let edges = &done.edges;
        let square = |first_row: &[f64], first_column: &[f64], edge: &Mat<f64>| {
            let mut matrix = Mat::zeros(first_column.len(), first_row.len());
            for b in 0..first_row.len() {
                matrix[(0, b)] = first_row[b];
                for a in 1..first_column.len() {
                    matrix[(a, b)] = match b {
                        0 => first_column[a],
                        _ => matrix[(a - 1, b - 1)] + edge[(a - 1, b - 1)],
                    };
                }
            }
            matrix
        };
        let shifted = |total: f64, edge: &[f64]| {
            let mut sums = vec![total];
            sums.extend(edge.iter().scan(total, |sum, edge| {
                *sum += edge;
                Some(*sum)
            }));
            sums
        };
        Moments {
            sample_period_s: done.sample_period_s,
            centre: (done.centre.0.unwrap_or(0.0), done.centre.1.unwrap_or(0.0)),
            rows: done.rows,
            samples: done.samples,
            missing: done.missing,
            uu: square(&uu, &uu, &edges.uu),
            uy: square(&done.uy, &yu, &edges.uy),
            yy: square(&done.yy, &done.yy, &edges.yy),
            u: shifted(done.total.0, &edges.u),
            y: shifted(done.total.1, &edges.y),
        }
    }

    fn append(&mut self, input: &[f64], output: &[f64]) {
        self.samples += input.len();
        self.missing += input
            .iter()
            .zip(output)
            .filter(|(u, y)| u.is_nan() || y.is_nan())
            .count();
        let centre = |known: &mut Option<f64>, values: &[f64]| {
            *known = known.or_else(|| values.iter().copied().find(|value| !value.is_nan()));
            known.unwrap_or(0.0) // Nothing but missing values so far.
        };
        let centre = (
            centre(&mut self.centre.0, input),
            centre(&mut self.centre.1, output),
        );
        self.u.extend(input.iter().map(|u| u - centre.0));
        self.y.extend(output.iter().map(|y| y - centre.1));
    }

    /// Sums the complete rows among the pending samples and forgets what no later row needs.
    fn sum_pending(&mut self) {
        let (mut span, mut k) = (self.summed, self.summed);
        while k < self.u.len() {
            let (u, y) = (&self.u[k], &self.y[k]);
            self.present.0 = if u.is_nan() { 0 } else { self.present.0 + 1 };
            self.present.1 = if y.is_nan() { 0 } else { self.present.1 + 1 };
            let complete = self.present.0 >= self.input_lags && self.present.1 >= self.output_lags;
            if complete && !self.open {
                self.edges.add(&self.u, &self.y, k, 1.0);
                self.open = true;
                span = k;
            } else if !complete {
                if self.open {
                    self.add_rows(span, k);
                }
                self.close(k);
            }
            k += 1;
        }
        if self.open {
            self.add_rows(span, k);
        }
        let keep = self.u.len().saturating_sub(self.input_lags);
        self.u.drain(..keep);
        self.y.drain(..keep);
        self.summed = self.u.len();
    }

    /// Ends the stretch of complete rows, if one is open, before row `k`.
    fn close(&mut self, k: usize) {
        if self.open {
            self.edges.add(&self.u, &self.y, k, -1.0);
            self.open = false;
        }
    }

    fn add_rows(&mut self, from: usize, to: usize) {
        let history = self.input_lags - 1;
        for start in (from..to).step_by(self.sums.block_rows()) {
            let end = (start + self.sums.block_rows()).min(to);
            let (u, y) = (&self.u[start..end], &self.y[start..end]);
            self.sums.add(&self.u[start - history..end], y);
            for j in 0..self.output_lags {
                let earlier = &self.y[start - j..end - j];
                self.uy[j] += wide_dot(u, earlier);
                self.yy[j] += wide_dot(y, earlier);
            }
            self.total.0 += u.iter().sum::<f64>();
            self.total.1 += y.iter().sum::<f64>();
        }
        self.rows += to - from;
    }
}

/// What the ends of stretches contribute to the recursion over lags.
#[derive(Clone)]
struct Edges {
    uu: Mat<f64>,
    uy: Mat<f64>,
    yy: Mat<f64>,
    u: Vec<f64>,
    y: Vec<f64>,
}

impl Edges {
    fn new(input_lags: usize, output_lags: usize) -> Self {
        let (l, j) = (input_lags - 1, output_lags - 1);
        Self {
            uu: Mat::zeros(l, l),
            uy: Mat::zeros(l, j),
            yy: Mat::zeros(j, j),
            u: vec![0.0; l],
            y: vec![0.0; j],
        }
    }

    /// Adds (sign 1: a stretch begins at row k) or subtracts (sign -1: it ends before row k) the
    /// products of the samples before row k.
    fn add(&mut self, u: &[f64], y: &[f64], k: usize, sign: f64) {
        let u: Vec<f64> = u[k - self.u.len()..k].iter().rev().copied().collect();
        let y: Vec<f64> = y[k - self.y.len()..k].iter().rev().copied().collect();
        rank_one(&mut self.uu, &u, &u, sign);
        rank_one(&mut self.uy, &u, &y, sign);
        rank_one(&mut self.yy, &y, &y, sign);
        for (sum, value) in self.u.iter_mut().zip(&u).chain(self.y.iter_mut().zip(&y)) {
            *sum += sign * value;
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

/// Inner product in eight independent sums, so that it can be done in vector registers.
fn wide_dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (a_wide, b_wide) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest = crate::basis::dot(a_wide.remainder(), b_wide.remainder());
    for (a, b) in a_wide.zip(b_wide) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    sums.iter().sum::<f64>() + rest
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
