//! Sums of lagged products, sum_k x(k) u(k-a), for many lags a at once.
//!
//! Blocks of rows go through a fast Fourier transform and are added up as spectra; a single inverse
//! transform at the end gives every lag. That makes the cost per sample grow with log L, not with L.
//! Short stretches are summed directly.

use std::sync::Arc;

use realfft::RealToComplex;
use realfft::num_complex::Complex;

use crate::fft;

/// Stretches of fewer rows than this are summed directly: three transforms cost more.
const DIRECT_ROWS: usize = 64;

/// Accumulates sum_k u(k) u(k-a) and sum_k y(k) u(k-a) for a = 0..lags-1.
#[derive(Clone)]
pub(crate) struct LaggedSums {
    lags: usize,
    uu: Vec<f64>,
    yu: Vec<f64>,
    transform: Option<Spectra>,
}

#[derive(Clone)]
struct Spectra {
    forward: Arc<dyn RealToComplex<f64>>,
    uu: Vec<Complex<f64>>,
    yu: Vec<Complex<f64>>,
    block: Vec<f64>,
    history: Vec<Complex<f64>>,
    rows: Vec<Complex<f64>>,
}

impl LaggedSums {
    pub(crate) fn new(lags: usize) -> Self {
        Self {
            lags,
            uu: vec![0.0; lags],
            yu: vec![0.0; lags],
            transform: None,
        }
    }

    /// Points of a transform: at least four times the lags, so that most of a block is new rows.
    fn size(&self) -> usize {
        (4 * self.lags).next_power_of_two().max(2048)
    }

    /// The most rows that one call of [`LaggedSums::add`] may bring.
    pub(crate) fn block_rows(&self) -> usize {
        self.size() - self.lags + 1
    }

    /// Adds the rows of `y`; `u` holds the same rows preceded by lags-1 earlier inputs.
    pub(crate) fn add(&mut self, u: &[f64], y: &[f64]) {
        debug_assert_eq!(u.len(), y.len() + self.lags - 1);
        if y.len() < DIRECT_ROWS {
            self.add_directly(u, y);
        } else {
            self.add_transformed(u, y);
        }
    }

    fn add_directly(&mut self, u: &[f64], y: &[f64]) {
        let newest = self.lags - 1;
        for (k, &y) in y.iter().enumerate() {
            let now = u[k + newest];
            let earlier = u[k..=k + newest].iter().rev();
            for ((uu, yu), &u) in self.uu.iter_mut().zip(&mut self.yu).zip(earlier) {
                *uu += now * u;
                *yu += y * u;
            }
        }
    }

    fn add_transformed(&mut self, u: &[f64], y: &[f64]) {
        let newest = self.lags - 1;
        let size = self.size();
        let spectra = self.transform.get_or_insert_with(|| Spectra::new(size));
        spectra.block[..u.len()].copy_from_slice(u);
        spectra.block[u.len()..].fill(0.0);
        transform(&spectra.forward, &mut spectra.block, &mut spectra.history);
        for (rows, sum) in [(&u[newest..], &mut spectra.uu), (y, &mut spectra.yu)] {
            spectra.block[..newest].fill(0.0);
            spectra.block[newest..u.len()].copy_from_slice(rows);
            spectra.block[u.len()..].fill(0.0);
            transform(&spectra.forward, &mut spectra.block, &mut spectra.rows);
            for ((sum, rows), history) in sum.iter_mut().zip(&spectra.rows).zip(&spectra.history) {
                *sum += rows * history.conj();
            }
        }
    }

    /// The sums so far: (sum u(k) u(k-a), sum y(k) u(k-a)), a = 0..lags-1.
    pub(crate) fn sums(&self) -> (Vec<f64>, Vec<f64>) {
        let (mut uu, mut yu) = (self.uu.clone(), self.yu.clone());
        if let Some(spectra) = &self.transform {
            add_inverse(&spectra.uu, self.size(), &mut uu);
            add_inverse(&spectra.yu, self.size(), &mut yu);
        }
        (uu, yu)
    }
}

impl Spectra {
    fn new(size: usize) -> Self {
        let forward = fft::forward(size);
        let zeros = forward.make_output_vec();
        Self {
            uu: zeros.clone(),
            yu: zeros.clone(),
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
    let inverse = fft::inverse(size);
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
        let (mut direct, mut fast) = (LaggedSums::new(lags), LaggedSums::new(lags));
        direct.add_directly(&u, &y);
        fast.add_transformed(&u, &y);
        for (direct, fast) in [
            (direct.sums().0, fast.sums().0),
            (direct.sums().1, fast.sums().1),
        ] {
            for (direct, fast) in direct.iter().zip(&fast) {
                // 1000 products of order one.
                assert_relative_eq!(direct, fast, epsilon = 1e-11);
            }
        }
    }
}
