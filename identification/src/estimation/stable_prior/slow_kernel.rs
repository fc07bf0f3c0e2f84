//! What is known of the slow kernel before the data: servos creep a little, over several times the time of their motion.
//!
//! Without this the likelihood chooses between a slow end and none, and in slow noise, which hides it, often none: the band would then
//! say for certain what the data leave open. With it, a slow end of this size is in the band unless the data exclude it.

use super::kernel::{Kernel, NUMBERS};

/// Size of a slow end, as a share of the gain, and the factor that one standard deviation of it is.
const SHARE: f64 = 0.05;
const SHARE_FACTOR: f64 = 3.0;
/// How many times longer than the motion it takes, and the factor that one standard deviation of it is.
const TIMES: f64 = 8.0;
const TIMES_FACTOR: f64 = 3.0;

/// The expectation of a slow end, beside a response with this gain.
pub(super) struct SlowEndPrior {
    pub(super) gain: f64,
}

impl SlowEndPrior {
    /// The start of a search: as expected, beside the `fast` kernel.
    pub(super) fn expected(&self, fast: &Kernel) -> Kernel {
        let slow = Kernel {
            log_size: 0.0,
            log_decay: fast.log_decay + TIMES.ln(),
            log_length: fast.log_length + TIMES.ln(),
        };
        Kernel {
            log_size: self.log_variance() - slow.log_step_variance().0,
            ..slow
        }
    }

    /// ln of the variance of the slow end's own step response, as expected.
    fn log_variance(&self) -> f64 {
        2.0 * (SHARE * self.gain).abs().max(f64::MIN_POSITIVE).ln()
    }

    /// -2 ln of the density of the numbers of both kernels, but for a constant, and its derivatives.
    pub(super) fn penalty(&self, fast: &Kernel, slow: &Kernel) -> (f64, [f64; 2 * NUMBERS]) {
        let (log_variance, slopes) = slow.log_step_variance();
        let size_sd = 2.0 * SHARE_FACTOR.ln();
        let size = (log_variance - self.log_variance()) / size_sd;
        let times_sd = TIMES_FACTOR.ln();
        let times = (slow.log_decay - fast.log_decay - TIMES.ln()) / times_sd;
        let of_size = |slope: f64| 2.0 * size / size_sd * slope;
        let of_times = 2.0 * times / times_sd;
        let gradient = [
            0.0,
            -of_times,
            0.0,
            of_size(slopes[0]),
            of_size(slopes[1]) + of_times,
            of_size(slopes[2]),
        ];
        (size * size + times * times, gradient)
    }
}
