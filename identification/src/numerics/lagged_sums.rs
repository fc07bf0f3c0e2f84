//! Sums of lagged products, sum_k x(k) u(k-a), of several sequences x with one u, for many lags a.
//!
//! Blocks of rows go through a fast Fourier transform and are added up as spectra; a single inverse
//! transform at the end gives every lag. The cost per sample grows with log L instead of L. Short
//! stretches are summed directly.

use std::sync::Arc;

use servoid_fft::{Complex, RealToComplex};

/// Stretches of fewer rows are summed directly: their transforms would cost more.
const DIRECT_ROWS: usize = 64;

/// Accumulates sum_k x(k) u(k-a) for a = 0..lags-1 and each sequence x.
#[derive(Clone)]
pub(crate) struct LaggedSums {
    lags: usize,
    /// One for each sequence.
    sums: Vec<Vec<f64>>,
    transform: Option<Spectra>,
}

#[derive(Clone)]
struct Spectra {
    forward: Arc<dyn RealToComplex<f64>>,
    /// One for each sequence.
    sums: Vec<Vec<Complex<f64>>>,
    block: Vec<f64>,
    history: Vec<Complex<f64>>,
    rows: Vec<Complex<f64>>,
}

impl LaggedSums {
    /// Empty sums.
    pub(crate) fn new(lags: usize, sequences: usize) -> Self {
        Self {
            lags,
            sums: vec![vec![0.0; lags]; sequences],
            transform: None,
        }
    }

    /// Points of a transform: at least four times the lags, so that most of each block are new rows.
    fn size(&self) -> usize {
        (4 * self.lags).next_power_of_two().max(2048)
    }

    /// Rows of one transform.
    pub(crate) fn block_rows(&self) -> usize {
        self.size() - self.lags + 1
    }

    /// Adds the rows of the `sequences`; `u` holds the same rows preceded by lags-1 earlier inputs.
    pub(crate) fn add(&mut self, u: &[f64], sequences: &[&[f64]]) {
        let (history, block) = (self.lags - 1, self.block_rows());
        let rows = u.len() - history;
        for start in (0..rows).step_by(block) {
            let end = (start + block).min(rows);
            let u = &u[start..end + history];
            let part = sequences.iter().map(|x| &x[start..end]);
            if end - start < DIRECT_ROWS {
                self.add_directly(u, part);
            } else {
                self.add_transformed(u, part);
            }
        }
    }

    fn add_directly<'a>(&mut self, u: &[f64], sequences: impl Iterator<Item = &'a [f64]>) {
        let newest = self.lags - 1;
        for (sums, x) in self.sums.iter_mut().zip(sequences) {
            for (k, x) in x.iter().enumerate() {
                let earlier = u[k..=k + newest].iter().rev();
                for (sum, u) in sums.iter_mut().zip(earlier) {
                    *sum += x * u;
                }
            }
        }
    }

    fn add_transformed<'a>(&mut self, u: &[f64], sequences: impl Iterator<Item = &'a [f64]>) {
        let (newest, size, count) = (self.lags - 1, self.size(), self.sums.len());
        let spectra = self
            .transform
            .get_or_insert_with(|| Spectra::new(size, count));
        spectra.block[..u.len()].copy_from_slice(u);
        spectra.block[u.len()..].fill(0.0);
        transform(&spectra.forward, &mut spectra.block, &mut spectra.history);
        for (x, sum) in sequences.zip(&mut spectra.sums) {
            spectra.block[..newest].fill(0.0);
            spectra.block[newest..u.len()].copy_from_slice(x);
            spectra.block[u.len()..].fill(0.0);
            transform(&spectra.forward, &mut spectra.block, &mut spectra.rows);
            for ((sum, rows), history) in sum.iter_mut().zip(&spectra.rows).zip(&spectra.history) {
                *sum += rows * history.conj();
            }
        }
    }

    /// The sums so far: for each sequence, those at lags 0..lags-1.
    pub(crate) fn sums(&self) -> Vec<Vec<f64>> {
        let mut sums = self.sums.clone();
        if let Some(spectra) = &self.transform {
            for (sums, spectrum) in sums.iter_mut().zip(&spectra.sums) {
                add_inverse(spectrum, self.size(), sums);
            }
        }
        sums
    }
}

impl Spectra {
    fn new(size: usize, sequences: usize) -> Self {
        let forward = servoid_fft::forward(size);
        let zeros = forward.make_output_vec();
        Self {
            sums: vec![zeros.clone(); sequences],
            history: zeros.clone(),
            rows: zeros,
            block: forward.make_input_vec(),
            forward,
        }
    }
}

fn transform(forward: &Arc<dyn RealToComplex<f64>>, block: &mut [f64], out: &mut [Complex<f64>]) {
    forward
        .process(block, out)
        .expect("buffers come from the plan");
}

fn add_inverse(spectrum: &[Complex<f64>], size: usize, sums: &mut [f64]) {
    let inverse = servoid_fft::inverse(size);
    let mut spectrum = spectrum.to_vec();
    let mut lags = inverse.make_output_vec();
    inverse
        .process(&mut spectrum, &mut lags)
        .expect("spectra of real signals");
    for (sum, lag) in sums.iter_mut().zip(&lags) {
        *sum += lag / size as f64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn both_ways_of_summing_agree() {
        let lags = 37;
        let u: Vec<f64> = (0..1000 + lags - 1)
            .map(|k| ((k * k) as f64 * 0.013).sin())
            .collect();
        let y: Vec<f64> = (0..1000).map(|k| (k as f64 * 0.31).cos() + 0.2).collect();
        let (mut direct, mut fast) = (LaggedSums::new(lags, 2), LaggedSums::new(lags, 2));
        let sequences = [&u[lags - 1..], &y];
        direct.add_directly(&u, sequences.into_iter());
        fast.add_transformed(&u, sequences.into_iter());
        for (direct, fast) in direct.sums().iter().zip(&fast.sums()) {
            for (direct, fast) in direct.iter().zip(fast) {
                // 1000 products of order one.
                assert_relative_eq!(direct, fast, epsilon = 1e-11);
            }
        }
    }
}
