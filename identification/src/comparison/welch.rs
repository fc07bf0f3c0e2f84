//! Welch's comparison of the means of two groups.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Welch's comparison of two means, variances unknown and unequal.
pub(super) struct Welch {
    pub(super) difference: f64,
    /// Standard error of the difference.
    error: f64,
    distribution: StudentsT,
}

impl Welch {
    /// `None` without scatter to compare with.
    pub(super) fn new(a: &[f64], b: &[f64]) -> Option<Self> {
        let moments = |values: &[f64]| {
            let count = values.len() as f64;
            let mean = values.iter().sum::<f64>() / count;
            let square: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
            (mean, square / (count - 1.0) / count, count - 1.0)
        };
        let ((mean_a, share_a, degrees_a), (mean_b, share_b, degrees_b)) = (moments(a), moments(b));
        let variance = share_a + share_b;
        let degrees =
            variance.powi(2) / (share_a.powi(2) / degrees_a + share_b.powi(2) / degrees_b);
        let welch = Self {
            difference: mean_a - mean_b,
            error: variance.sqrt(),
            distribution: StudentsT::new(0.0, 1.0, degrees).ok()?,
        };
        (welch.difference / welch.error)
            .is_finite()
            .then_some(welch)
    }

    /// Two-sided p of equal means.
    pub(super) fn p(&self) -> f64 {
        2.0 * self.distribution.sf((self.difference / self.error).abs())
    }

    /// Half the width of the interval of the difference.
    pub(super) fn half_width(&self, level: f64) -> f64 {
        self.error * self.distribution.inverse_cdf((1.0 + level) / 2.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn welch_agrees_with_a_worked_example() {
        // t = 3 / sqrt(1/3 + 4/3) = 2.3238, 2.941 degrees of freedom.
        let p = Welch::new(&[1.0, 2.0, 3.0], &[3.0, 5.0, 7.0]).unwrap().p();
        let exact = 2.0
            * StudentsT::new(0.0, 1.0, 50.0 / 17.0)
                .unwrap()
                .sf(3.0 / (5.0f64 / 3.0).sqrt());
        assert_abs_diff_eq!(p, exact, epsilon = 1e-12);
        assert!(Welch::new(&[1.0, 1.0], &[1.0, 1.0]).is_none());
    }
}
