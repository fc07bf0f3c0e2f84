//! Whether a step response has an end.

use crate::thresholds::STILL_RISING;

/// The share of its last value by which a step response still rises at its end, between means of eighths: a bank of few
/// frequencies has ripple. `None` where it has an end.
pub(crate) fn rise_at_end(step: &[f64]) -> Option<f64> {
    let eighth = step.len() / 8;
    let mean = |from_end: usize| {
        let end = step.len() - from_end * eighth;
        step[end - eighth..end].iter().sum::<f64>() / eighth as f64
    };
    if eighth == 0 {
        return None;
    }
    let last = mean(0);
    let [first, second] = [mean(1) - mean(2), last - mean(1)].map(|rise| rise / last);
    let whole = first + second;
    // A servo that rings rises and falls.
    (first.min(second) > 0.25 * whole && whole > STILL_RISING).then_some(whole)
}

#[cfg(test)]
mod tests {
    use super::rise_at_end;

    #[test]
    fn a_ramp_has_no_end_and_a_lag_that_has_settled_has_one() {
        let ramp: Vec<f64> = (0..80).map(f64::from).collect();
        assert!(rise_at_end(&ramp).is_some_and(|rise| (0.2..0.3).contains(&rise)));
        let lag: Vec<f64> = (0..80).map(|k| 1.0 - 0.9_f64.powi(k)).collect();
        assert_eq!(rise_at_end(&lag), None);
        assert_eq!(rise_at_end(&[1.0, 2.0]), None);
    }
}
