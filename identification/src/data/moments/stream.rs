//! Moments in one pass, also while samples arrive.
//!
//! Only the sums and the last L samples are kept. Memory is constant, and the moments so far cost a few
//! milliseconds at any time.

use faer::Mat;

use super::lagged::Moments;
use crate::data::record::Run;
use crate::numerics::{LaggedSums, add_outer_product, dot};

/// Collects [`Moments`] while samples arrive, in pieces of any size.
///
/// A live display pushes each frame as it arrives, and asks for a model whenever it draws one. A settling
/// time of N samples and a noise order of d need N + d lags of the input and d + 1 of the output. The test
/// of the input's independence needs ten more lags of the input. With a fixed N a model takes a few milliseconds; the automatic choice from L lags
/// takes longer, growing with L³.
///
/// ```
/// use servoid_identification::MomentStream;
/// use servoid_identification::{identify_moments, Options, Settling};
/// # let u: Vec<f64> = (0..1200).map(|k| if (k * k / 900) % 2 == 0 { 5.0 } else { -5.0 }).collect();
/// # let y: Vec<f64> = u.iter().enumerate().scan(0.0, |y, (k, u)| {
/// #     *y += 0.2 * (u - *y); Some(*y + 0.01 * ((k * 7919 % 101) as f64 - 50.0) / 50.0)
/// # }).collect();
/// # let frames = u.chunks(10).zip(y.chunks(10));
///
/// let options = Options { settling: Settling::Samples(61), ..Options::default() };
/// // N = 61, noise of order 0 to 8; the sensor is read 0.5 ms after an edge, every 2 ms.
/// let mut stream = MomentStream::new(0.002, 61 + 8, 8 + 1).with_sample_phase(0.0005);
/// let mut shown = 0;
/// for (number, (input, output)) in frames.enumerate() {
///     stream.push(input, output); // Ten samples; NaN where one was lost.
///     if number % 25 == 24 {
///         match identify_moments(&stream.moments(), &options) {
///             Ok(found) => shown += found.model.step.value.len(),
///             Err(not_yet) => println!("{not_yet}"), // Too few samples so far: go on.
///         }
///     }
/// }
/// assert_eq!(shown, 4 * 61);
/// ```
#[derive(Clone)]
pub struct MomentStream {
    sample_period_s: f64,
    sample_phase_s: f64,
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
    /// sum u(k) u(k-a) and sum y(k) u(k-a).
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
    pub fn new(sample_period_s: f64, input_lags: usize, output_lags: usize) -> Self {
        assert!(
            (1..=input_lags).contains(&output_lags),
            "{output_lags} output lags do not fit {input_lags} input lags"
        );
        Self {
            sample_period_s,
            sample_phase_s: 0.0,
            input_lags,
            output_lags,
            centre: (None, None),
            u: Vec::new(),
            y: Vec::new(),
            summed: 0,
            present: (0, 0),
            open: false,
            sums: LaggedSums::new(input_lags, 2),
            uy: vec![0.0; output_lags],
            yy: vec![0.0; output_lags],
            total: (0.0, 0.0),
            edges: Edges::new(input_lags, output_lags),
            rows: 0,
            samples: 0,
            missing: 0,
        }
    }

    /// States that samples are taken `seconds` after the edge of the input (see [`Record::with_sample_phase`](crate::Record::with_sample_phase)).
    ///
    /// # Panics
    /// When `seconds` is negative or not finite.
    #[must_use]
    pub fn with_sample_phase(mut self, seconds: f64) -> Self {
        assert!(
            seconds >= 0.0 && seconds.is_finite(),
            "a sample phase of {seconds} s is no time after an edge"
        );
        self.sample_phase_s = seconds;
        self
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

    /// Begins another run. Its samples have no history, or that of an input which was constant at
    /// `at_rest`.
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
    pub fn moments(&self) -> Moments {
        self.clone().into_moments()
    }

    /// The moments of all samples; ends the collection.
    pub fn into_moments(mut self) -> Moments {
        let done = &mut self;
        done.sum_pending();
        done.close(done.u.len());
        let sums = done.sums.sums();
        let (uu, yu) = (&sums[0], &sums[1]);
        let edges = &done.edges;
        let square = |first_row: &[f64], first_column: &[f64], edge: &Mat<f64>| {
            let mut matrix = Mat::<f64>::zeros(first_column.len(), first_row.len());
            let mut column = first_column.to_vec();
            for (b, first) in first_row.iter().enumerate() {
                if b > 0 {
                    column.rotate_right(1);
                    for (sum, edge) in column[1..].iter_mut().zip(edge.col_as_slice(b - 1)) {
                        *sum += edge;
                    }
                }
                column[0] = *first;
                matrix.col_as_slice_mut(b).copy_from_slice(&column);
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
            sample_phase_s: done.sample_phase_s,
            centre: (done.centre.0.unwrap_or(0.0), done.centre.1.unwrap_or(0.0)),
            rows: done.rows,
            samples: done.samples,
            missing: done.missing,
            uu: square(uu, uu, &edges.uu),
            uy: square(&done.uy, yu, &edges.uy),
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

    /// Sums the complete rows among the pending samples, and drops samples that no later row needs.
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
        let (u, y) = (&self.u[from..to], &self.y[from..to]);
        self.sums.add(&self.u[from - history..to], &[u, y]);
        for j in 0..self.output_lags {
            let earlier = &self.y[from - j..to - j];
            self.uy[j] += dot(u, earlier);
            self.yy[j] += dot(y, earlier);
        }
        self.total.0 += u.iter().sum::<f64>();
        self.total.1 += y.iter().sum::<f64>();
        self.rows += to - from;
    }
}

/// Contributions of the ends of stretches to the recursion over lags.
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
        add_outer_product(&mut self.uu, &u, &u, sign);
        add_outer_product(&mut self.uy, &u, &y, sign);
        add_outer_product(&mut self.yy, &y, &y, sign);
        for (sum, value) in self.u.iter_mut().zip(&u).chain(self.y.iter_mut().zip(&y)) {
            *sum += sign * value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_does_not_grow_with_the_samples() {
        let mut stream = MomentStream::new(0.002, 60, 3);
        let mut most = 0;
        for k in 0..200_000u32 {
            stream.push(&[f64::from(k % 7)], &[f64::from(k % 5)]);
            most = most.max(stream.u.capacity()).max(stream.y.capacity());
        }
        // The history of a row and a block that is not summed yet; a vector may double to get there.
        let needed = stream.input_lags + 2 * stream.sums.block_rows();
        assert!(most <= 2 * needed, "{most} samples kept");
        assert_eq!(stream.moments().samples(), 200_000);
    }
}
