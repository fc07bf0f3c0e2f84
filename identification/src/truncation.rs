//! What leaving out high frequencies can do to a step response.
//!
//! With n < N the frequencies above q = (n-1)/2 are left out. If |G| falls at least like
//! (q/l)^r above q, the step response misses at most
//!
//! ```text
//! B = max_m sum_{l>q} 2 |S(l,m)| G_q (q/l)^r
//! ```
//!
//! where G_q is the largest of |G| + 2 sd at the last three frequencies kept. The truth is often
//! several times smaller, because the terms cancel, but nothing in the data says so.

use crate::basis::Basis;

/// Frequencies at the upper end whose magnitude speaks for what is above them.
const EDGE_FREQUENCIES: usize = 3;

/// Roll-off assumed above the highest frequency kept: 20 dB/decade, as of a first-order lag.
pub const FIRST_ORDER: i32 = 1;
/// Roll-off of 40 dB/decade, as of a second-order servo.
pub const SECOND_ORDER: i32 = 2;

/// The bound B for parameters θ with standard deviations `sd`. 0 when nothing is left out.
#[must_use]
pub fn step_bias_bound(basis: &Basis, theta: &[f64], sd: &[f64], roll_off: i32) -> f64 {
    if basis.is_complete() {
        return 0.0;
    }
    let q = basis.highest();
    let edge = (q.saturating_sub(EDGE_FREQUENCIES - 1)..=q)
        .map(|l| match l {
            0 => theta[0].abs() + 2.0 * sd[0],
            l => theta[2 * l - 1].hypot(theta[2 * l]) + 2.0 * sd[2 * l - 1].hypot(sd[2 * l]),
        })
        .fold(0.0, f64::max);
    edge * unit_biases(basis.settling(), roll_off)[q]
}

/// B for G_q = 1, for every q from 0 to the highest frequency of a full bank.
pub(crate) fn unit_biases(settling: usize, roll_off: i32) -> Vec<f64> {
    let Ok(full) = Basis::full(settling) else {
        return vec![0.0];
    };
    let top = settling / 2;
    let mut sum = vec![0.0; settling];
    let mut biases = vec![0.0; top + 1];
    for (index, kernel) in full.step_kernel_magnitudes().iter().enumerate().rev() {
        let l = index + 1;
        // The frequency N/2 of an even N stands alone; all others come in pairs.
        let terms = if 2 * l == settling { 1.0 } else { 2.0 };
        let factor = terms / (l as f64).powi(roll_off);
        for (sum, kernel) in sum.iter_mut().zip(kernel) {
            *sum += factor * kernel;
        }
        let largest = sum.iter().copied().fold(0.0, f64::max);
        biases[index] = largest * (index.max(1) as f64).powi(roll_off);
    }
    biases
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bound_holds_for_a_first_order_lag_and_vanishes_when_all_is_kept() {
        let n = 101;
        let full = Basis::full(n).unwrap();
        let impulse: Vec<f64> = (0..n).map(|i| 0.1 * 0.9f64.powi(i as i32)).collect();
        let analysis = full.analysis_map();
        let theta: Vec<f64> = (0..n)
            .map(|j| (0..n).map(|i| analysis[(j, i)] * impulse[i]).sum())
            .collect();
        let truth = full.step_response(&theta);
        for frequencies in [11, 21, 51] {
            let basis = Basis::new(n, frequencies).unwrap();
            let kept = &theta[..frequencies];
            let bound = step_bias_bound(&basis, kept, &vec![0.0; frequencies], FIRST_ORDER);
            let error = basis
                .step_response(kept)
                .iter()
                .zip(&truth)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max);
            assert!(
                error <= bound && bound < 10.0 * error,
                "{frequencies}: {error} {bound}"
            );
        }
        assert_eq!(
            step_bias_bound(&full, &theta, &vec![0.0; n], FIRST_ORDER),
            0.0
        );
    }
}
