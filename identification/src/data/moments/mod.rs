//! Lagged moments of input and output, in one pass over the record.
//!
//! Identification needs nothing else of a record, and their size does not depend on its length.
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

mod from_record;
mod lagged;
mod stream;

pub use lagged::Moments;
pub use stream::MomentStream;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::record::{Record, Run};
    use approx::assert_relative_eq;
    use faer::Mat;

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

    fn gappy_record() -> Record<'static> {
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
    fn moments_follow_their_definition_with_gaps_runs_and_rest() {
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
    fn pieces_of_any_size_give_the_same() {
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
