//! The noise one step ahead, across samples that are missing or not believed.

use faer::Mat;

/// Kalman's filter for v = ε/D(z), with the last d values of v as its state, the newest first.
pub(crate) struct NoisePrediction<'a> {
    ar: &'a [f64],
    /// Variance of ε.
    variance: f64,
    /// Standard deviations from which on an error is not believed.
    limit: f64,
    state: Vec<f64>,
    /// Covariance of the state; `None` where all of it is known.
    covariance: Option<Mat<f64>>,
}

impl<'a> NoisePrediction<'a> {
    /// Before a first sample nothing is known. Errors of `limit` standard deviations and more are not believed.
    pub(crate) fn new(ar: &'a [f64], variance: f64, limit: f64) -> Self {
        /// Standard deviation of the unknown past, in those of ε.
        const UNKNOWN: f64 = 1e3;
        let order = ar.len();
        let unknown = |i, j| {
            if i == j {
                UNKNOWN * UNKNOWN * variance
            } else {
                0.0
            }
        };
        Self {
            ar,
            variance,
            limit,
            state: vec![0.0; order],
            covariance: (order > 0).then(|| Mat::from_fn(order, order, unknown)),
        }
    }

    /// The size of the next error in standard deviations, `further` variance included; `None` where it is missing.
    /// One beyond the limit is not believed.
    pub(crate) fn next(&mut self, value: f64, further: f64) -> Option<f64> {
        let order = self.ar.len();
        let prediction: f64 = -self
            .ar
            .iter()
            .zip(&self.state)
            .map(|(d, v)| d * v)
            .sum::<f64>();
        let size_by = |variance: f64| (value - prediction).abs() / (variance + further).sqrt();
        // As most samples are: believed, after others that were.
        let after_known = (self.covariance.is_none()).then(|| size_by(self.variance));
        if let Some(size) = after_known.filter(|size| *size < self.limit) {
            self.remember(value);
            return Some(size);
        }
        let cross: Vec<f64> = match &self.covariance {
            None => Vec::new(),
            Some(covariance) => (0..order)
                .map(|i| {
                    -(0..order)
                        .map(|j| self.ar[j] * covariance[(i, j)])
                        .sum::<f64>()
                })
                .collect(),
        };
        let from_past: f64 = -self.ar.iter().zip(&cross).map(|(d, c)| d * c).sum::<f64>();
        let variance = self.variance + from_past.max(0.0);
        let size = size_by(variance);
        let believed = size < self.limit;
        if believed && self.covariance.is_some() {
            let gain = (value - prediction) / variance;
            for (state, cross) in self.state.iter_mut().zip(&cross) {
                *state += gain * cross;
            }
        }
        self.remember(if believed { value } else { prediction });
        self.covariance = self.next_covariance(&cross, variance, believed);
        (!value.is_nan()).then_some(size)
    }

    /// Makes `newest` the last value of v.
    fn remember(&mut self, newest: f64) {
        let mut value = newest;
        for state in &mut self.state {
            std::mem::swap(state, &mut value);
        }
    }

    fn next_covariance(&self, cross: &[f64], variance: f64, believed: bool) -> Option<Mat<f64>> {
        let order = self.ar.len();
        if order == 0 || (believed && self.covariance.is_none()) {
            return None;
        }
        let before = |i: usize, j: usize| {
            let covariance = self
                .covariance
                .as_ref()
                .map_or(0.0, |covariance| covariance[(i, j)]);
            let cross = |i: usize| cross.get(i).copied().unwrap_or(0.0);
            match believed {
                true => covariance - cross(i) * cross(j) / variance,
                false => covariance,
            }
        };
        let next = Mat::from_fn(order, order, |i, j| match (i, j, believed) {
            (0, 0, false) => variance,
            (0, _, true) | (_, 0, true) => 0.0,
            (0, k, false) | (k, 0, false) => cross.get(k - 1).copied().unwrap_or(0.0),
            _ => before(i - 1, j - 1),
        });
        let open = (0..order).any(|i| next[(i, i)] > 1e-9 * self.variance);
        open.then_some(next)
    }
}
