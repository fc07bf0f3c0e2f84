//! Welch's comparison of the means of two groups.

use crate::numerics::{pointwise_critical, square_about_mean, student_critical};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Welch's comparison of two means, variances unknown and unequal.
pub(super) struct Welch {
    /// Standard error of the difference.
    error: f64,
    distribution: StudentsT,
}

impl Welch {
    /// `None` without scatter to compare with.
    pub(super) fn new(a: &[f64], b: &[f64]) -> Option<Self> {
        let variance = |values: &[f64]| square_about_mean(values) / (values.len() as f64 - 1.0);
        Self::of_variances([variance(a), variance(b)], [a.len(), b.len()])
    }

    /// Of groups of so many values, whose variances these are.
    pub(super) fn of_variances(variances: [f64; 2], counts: [usize; 2]) -> Option<Self> {
        let [(share_a, degrees_a), (share_b, degrees_b)] = [0, 1].map(|side| {
            let count = counts[side] as f64;
            (variances[side] / count, count - 1.0)
        });
        let variance = share_a + share_b;
        let degrees =
            variance.powi(2) / (share_a.powi(2) / degrees_a + share_b.powi(2) / degrees_b);
        let welch = Self {
            error: variance.sqrt(),
            distribution: StudentsT::new(0.0, 1.0, degrees).ok()?,
        };
        (welch.error > 0.0).then_some(welch)
    }

    /// Half the width of the interval of the difference.
    pub(super) fn half_width(&self, level: f64) -> f64 {
        self.error * self.distribution.inverse_cdf((1.0 + level) / 2.0)
    }
}

/// Half the width of Student's interval of the mean of values that scatter.
pub(super) fn half_width_of_mean(values: &[f64], level: f64) -> f64 {
    let degrees = values.len() as f64 - 1.0;
    let critical = student_critical(pointwise_critical(level), &[degrees])[0];
    critical * (square_about_mean(values) / degrees / values.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn a_mean_has_the_interval_of_student() {
        let t = StudentsT::new(0.0, 1.0, 2.0).unwrap();
        let exact = t.inverse_cdf(0.995) / 3f64.sqrt();
        assert_abs_diff_eq!(
            half_width_of_mean(&[1.0, 2.0, 3.0], 0.99),
            exact,
            epsilon = 1e-9
        );
    }

    #[test]
    fn welch_agrees_with_a_worked_example() {
        // The error is sqrt(1/3 + 4/3), with 2.941 degrees of freedom.
        let welch = Welch::new(&[1.0, 2.0, 3.0], &[3.0, 5.0, 7.0]).unwrap();
        let t = StudentsT::new(0.0, 1.0, 50.0 / 17.0).unwrap();
        let exact = (5.0f64 / 3.0).sqrt() * t.inverse_cdf(0.995);
        assert_abs_diff_eq!(welch.half_width(0.99), exact, epsilon = 1e-9);
        assert!(Welch::new(&[1.0, 1.0], &[1.0, 1.0]).is_none());
    }
}
