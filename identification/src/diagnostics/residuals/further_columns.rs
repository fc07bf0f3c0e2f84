//! Cross moments of further columns with the rows of the regression.
//!
//! Behind the noise filter D, a regression on the last N inputs has the rows
//!
//! ```text
//! z(k) = [T' (D u(k), D u(k-1), ..., D u(k-N+1))', D(1)]',     (p+1) x 1,
//! ```
//!
//! T being the N x p map from its p coordinates to the impulse response, and D(1) the filtered column of the offset. What a further column x adds to the
//! regression follows from its own moments and from
//!
//! ```text
//! C = sum_k z(k) x(k),     one column of C for each x,     (p+1) x columns.
//! ```
//!
//! The sums over the rows are formed for the N lags first, and brought into coordinates together.

use faer::Mat;

use crate::estimation::{Coordinates, GlsFit, noise_filter};
use crate::numerics::LaggedSums;

/// C, while it is summed.
pub(crate) struct FurtherColumns<'f> {
    coordinates: &'f Coordinates,
    /// D(1).
    gain: f64,
    /// sum_k D u(k-a) x(k): N x columns.
    by_lag: Mat<f64>,
    /// sum_k D(1) x(k).
    with_offset: Vec<f64>,
}

impl<'f> FurtherColumns<'f> {
    /// Of so many columns beside the rows of `fit`, 0 so far.
    pub(crate) fn new(fit: &'f GlsFit, columns: usize) -> Self {
        Self {
            coordinates: &fit.coordinates,
            gain: noise_filter(&fit.ar).iter().sum(),
            by_lag: Mat::zeros(fit.coordinates.basis.settling(), columns),
            with_offset: vec![0.0; columns],
        }
    }

    /// Adds successive samples of the columns with these `places`. The `columns` are filtered and 0 but in the rows of the regression. `input` is filtered, too,
    /// and ends with the same samples; of those before, it has N-1 at the least.
    pub(crate) fn add(&mut self, input: &[f64], places: &[usize], columns: &[&[f64]]) {
        let Some(samples) = columns.first().map(|column| column.len()) else {
            return;
        };
        let lags = self.by_lag.nrows();
        let mut sums = LaggedSums::new(lags, columns.len());
        sums.add(&input[input.len() - samples + 1 - lags..], columns);
        for ((sums, column), &place) in sums.sums().iter().zip(columns).zip(places) {
            self.add_sums(place, sums, self.gain * column.iter().sum::<f64>());
        }
    }

    /// Adds to the column with this `place` what is known without its samples: its sums with the lags of the filtered input, and with the filtered offset.
    pub(crate) fn add_sums(&mut self, place: usize, by_lag: &[f64], with_offset: f64) {
        let totals = self.by_lag.col_as_slice_mut(place).iter_mut();
        totals.zip(by_lag).for_each(|(total, sum)| *total += sum);
        self.with_offset[place] += with_offset;
    }

    /// C.
    pub(crate) fn cross_moments(self) -> Mat<f64> {
        in_coordinates(self.coordinates, self.by_lag, &self.with_offset)
    }
}

/// Columns of products with N lags and with the offset, N x columns, in the coordinates of a fit, the offset last: (p+1) x columns.
pub(crate) fn in_coordinates(
    coordinates: &Coordinates,
    by_lag: Mat<f64>,
    with_offset: &[f64],
) -> Mat<f64> {
    let by_coordinate = coordinates.compress(by_lag);
    let p = by_coordinate.nrows();
    Mat::from_fn(p + 1, with_offset.len(), |i, j| match i {
        i if i < p => by_coordinate[(i, j)],
        _ => with_offset[j],
    })
}

/// The obvious way, for tests: each row is built, and its products are summed.
#[cfg(test)]
pub(crate) mod row_by_row {
    use faer::Mat;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use crate::data::{Moments, Record, Run};
    use crate::estimation::{
        Coordinates, FsfBasis, GlsFit, GlsOptions, RowInformation, noise_filter,
    };
    use crate::options::NoiseOrder;

    const LAGS: usize = 31;
    const ORDER: usize = 2;

    /// Two runs, of which one begins at rest, with samples missing in both; and a fit of fewer frequencies than lags, in noise of second order.
    pub(in crate::diagnostics) fn fitted() -> (Record<'static>, Moments, GlsFit) {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let mut random = move || random.random_range(-0.5..0.5);
        let mut run = |samples: usize| {
            let mut input: Vec<f64> = (0..samples).map(|_| 3.0 + random()).collect();
            let mut noise = [0.0; 2];
            let mut output: Vec<f64> = (0..samples)
                .map(|k| {
                    noise = [0.9 * noise[0] - 0.4 * noise[1] + 0.1 * random(), noise[0]];
                    let recent = (k.saturating_sub(5)..k).map(|k| input[k]).sum::<f64>();
                    0.2 * recent + noise[0]
                })
                .collect();
            input[150] = f64::NAN;
            output[300] = f64::NAN;
            Run::new(input, output).unwrap()
        };
        let runs = vec![run(400), run(500).with_input_at_rest(3.0)];
        let record = Record::new(0.01, runs).unwrap();
        let moments = Moments::of_record(&record, LAGS + ORDER, ORDER + 1);
        let coordinates = Coordinates::new(FsfBasis::new(LAGS, 15).unwrap());
        let options = GlsOptions {
            order: NoiseOrder::Order(ORDER),
            ..GlsOptions::default()
        };
        let information = RowInformation::from_moments(moments.clone());
        let fit = GlsFit::of(&information, &coordinates, &options).unwrap();
        (record, moments, fit)
    }

    /// What a column adds to a regression.
    pub(in crate::diagnostics) struct Summed {
        /// Its column of C.
        pub(in crate::diagnostics) cross: Vec<f64>,
        /// sum_k x(k)².
        pub(in crate::diagnostics) own: f64,
    }

    /// Of the column x of a run and sample.
    pub(in crate::diagnostics) fn summed(
        record: &Record<'_>,
        moments: &Moments,
        fit: &GlsFit,
        x: impl Fn(usize, usize) -> f64,
    ) -> Summed {
        let d = noise_filter(&fit.ar);
        let p = fit.coordinates.len();
        let identity = Mat::<f64>::identity(p, p);
        let map = fit.coordinates.impulses(identity);
        let mut cross = vec![0.0; p + 1];
        let mut own = 0.0;
        for (index, run) in record.runs().iter().enumerate() {
            let rows = run.complete_rows(moments.input_lags(), moments.output_lags());
            for k in rows.into_iter().flatten() {
                let u = |lag: usize| run.input_at(k as isize - lag as isize) - moments.centre.0;
                let behind = |a: usize| (0..d.len()).map(|i| d[i] * u(a + i)).sum::<f64>();
                let lags: Vec<f64> = (0..LAGS).map(behind).collect();
                let x = x(index, k);
                for (j, cross) in cross[..p].iter_mut().enumerate() {
                    *cross += (0..LAGS).map(|a| map[(a, j)] * lags[a]).sum::<f64>() * x;
                }
                cross[p] += d.iter().sum::<f64>() * x;
                own += x * x;
            }
        }
        Summed { cross, own }
    }

    /// Sums of some 800 products of order one, in another order.
    pub(in crate::diagnostics) fn require_close(found: &[f64], slow: &[f64]) {
        assert_eq!(found.len(), slow.len());
        for (found, slow) in found.iter().zip(slow) {
            approx::assert_abs_diff_eq!(found, slow, epsilon = 1e-10);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::row_by_row::{fitted, require_close, summed};
    use super::*;
    use crate::diagnostics::residuals::filtered_rows::{filtered, only, with_history};

    /// Two columns that both runs have, and one of the second run alone, which is given from its sample 100 to 199.
    #[test]
    fn cross_moments_are_those_that_rows_make() {
        let (record, moments, fit) = fitted();
        let d = noise_filter(&fit.ar);
        let history = fit.coordinates.basis.settling() - 1 + fit.ar.len();
        let shared = |place: usize, k: usize| (0.1 * (place + 1) as f64 * k as f64).sin() + 0.3;
        let mut columns = FurtherColumns::new(&fit, 3);
        for (index, run) in record.runs().iter().enumerate() {
            let input = filtered(&with_history(run, history, moments.centre.0), &d);
            let rows = run.complete_rows(moments.input_lags(), moments.output_lags());
            let of = |place: usize| only(&rows, (0..run.len()).map(|k| shared(place, k)).collect());
            columns.add(&input, &[0, 1], &[&of(0), &of(1)]);
            if index == 1 {
                columns.add(&input[..history + 200], &[2], &[&of(2)[100..200]]);
            }
        }
        let found = columns.cross_moments();
        let own = |run: usize, k: usize| match run == 1 && (100..200).contains(&k) {
            true => shared(2, k),
            false => 0.0,
        };
        for place in 0..3 {
            let slow = summed(&record, &moments, &fit, |run, k| match place {
                2 => own(run, k),
                place => shared(place, k),
            });
            require_close(found.col_as_slice(place), &slow.cross);
        }
    }
}
