//! Whether the data contradict the prior (Hausman, Econometrica 1978).
//!
//! Under the prior the difference between the free estimate and the one with the prior has a covariance that is known, that of the
//! free one less that of the other: V - K (K + V)^-1 V = V (K + V)^-1 V.

use faer::Mat;

/// The largest difference of the two step responses, `free` and `regularised` being impulse responses, in standard deviations.
/// `of_noise` is L^-1 V with L L' = K + V.
pub(super) fn contradiction(free: &[f64], regularised: &[f64], of_noise: &Mat<f64>) -> f64 {
    let size = free.len();
    let mut whitened = vec![0.0; size];
    let (mut difference, mut largest) = (0.0, 0.0f64);
    for k in 0..size {
        difference += free[k] - regularised[k];
        let column = of_noise.col_as_slice(k);
        whitened
            .iter_mut()
            .zip(column)
            .for_each(|(sum, w)| *sum += w);
        let variance: f64 = whitened.iter().map(|w| w * w).sum();
        if variance > 0.0 {
            largest = largest.max(difference.abs() / variance.sqrt());
        }
    }
    largest
}
