//! The mean of several vectors, and how sure it is by how they differ.

/// The mean of R vectors x_r.
pub(crate) struct SampleMean {
    pub(crate) value: Vec<f64>,
    /// d_r, of each vector from the mean.
    distances: Vec<Vec<f64>>,
}

impl SampleMean {
    /// Of vectors of one length; `None` of fewer than two.
    pub(crate) fn of(all: &[Vec<f64>]) -> Option<Self> {
        let first = all.first().filter(|_| all.len() > 1)?;
        let mean = |i: usize| all.iter().map(|x| x[i]).sum::<f64>() / all.len() as f64;
        let value: Vec<f64> = (0..first.len()).map(mean).collect();
        let distance = |x: &Vec<f64>| x.iter().zip(&value).map(|(x, mean)| x - mean).collect();
        Some(Self {
            distances: all.iter().map(distance).collect(),
            value,
        })
    }

    /// The covariance of two of its entries: sum_r d_r d_r' / (R (R - 1)).
    pub(crate) fn covariance(&self, i: usize, k: usize) -> f64 {
        let products = self.distances.iter().map(|d| d[i] * d[k]);
        products.sum::<f64>() / (self.distances.len() as f64 * self.degrees())
    }

    /// Degrees of freedom of that: R - 1.
    pub(crate) fn degrees(&self) -> f64 {
        self.distances.len() as f64 - 1.0
    }
}

#[cfg(test)]
mod tests {
    use super::SampleMean;

    #[test]
    fn a_mean_is_as_sure_as_its_standard_error() {
        let found = SampleMean::of(&[vec![1.0, 5.0], vec![2.0, 3.0], vec![6.0, 1.0]]).unwrap();
        assert_eq!(found.value, [3.0, 3.0]);
        // 4, 1 and 9 over 6; 4 and 4; and -4, 0 and -6.
        assert!((found.covariance(0, 0) - 14.0 / 6.0).abs() < 1e-12);
        assert!((found.covariance(1, 1) - 8.0 / 6.0).abs() < 1e-12);
        assert!((found.covariance(0, 1) + 10.0 / 6.0).abs() < 1e-12);
        assert_eq!(found.degrees(), 2.0);
        assert!(SampleMean::of(&[vec![1.0]]).is_none());
    }
}
