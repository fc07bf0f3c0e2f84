//! The response that comes later, in the coordinates of a fit.

use crate::estimation::GlsFit;

/// The change of the response for a delay of one sample, and half of what this changes from one sample to the next, in the coordinates of
/// the fit.
pub(crate) fn slope_and_bend(fit: &GlsFit) -> [Vec<f64>; 2] {
    let impulse = fit.impulse();
    let at = |k: usize| impulse.get(k).copied().unwrap_or(0.0);
    let each = |of: &dyn Fn(f64, f64, f64) -> f64| -> Vec<f64> {
        let samples = 0..impulse.len();
        let values: Vec<f64> = samples
            .map(|k| of(at(k.wrapping_sub(1)), at(k), at(k + 1)))
            .collect();
        fit.coordinates.of_impulse(&values)
    };
    [
        each(&|before, _, after| (before - after) / 2.0),
        each(&|before, at, after| (before - 2.0 * at + after) / 2.0),
    ]
}
