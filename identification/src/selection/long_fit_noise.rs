//! The noise filter of a long fit, which has to be roughly right only.

use crate::data::Moments;
use crate::estimation::{NoiseFit, best_order, residual_moments_of_lags};
use crate::numerics::largest_difference;
use crate::options::NoiseOrder;

/// Passes over fit and noise.
const PASSES: usize = 4;

/// Change of a coefficient below which the passes end.
const TOLERANCE: f64 = 1e-2;

/// A fit in turn with D(z) of its residuals, until D is near the one that the fit has: that D, and the fit. `solution` gives impulse response and
/// offset of a fit. `None` when a fit is not determined.
pub(crate) fn alternate<Fit>(
    moments: &Moments,
    order: NoiseOrder,
    fit: impl Fn(&[f64]) -> Option<Fit>,
    solution: impl Fn(&Fit) -> (Vec<f64>, f64),
) -> Option<(Vec<f64>, Fit)> {
    let mut ar = Vec::new();
    let mut fitted = fit(&ar)?;
    for pass in 0..PASSES {
        let (impulse, offset) = solution(&fitted);
        let next = filter(moments, &impulse, offset, order, pass == 0);
        if largest_difference(&ar, &next) < TOLERANCE {
            break;
        }
        fitted = fit(&next)?;
        ar = next;
    }
    Some((ar, fitted))
}

/// By the criterion or as fixed. What the criterion does not take for white at the first pass has the highest order there.
fn filter(
    moments: &Moments,
    impulse: &[f64],
    offset: f64,
    order: NoiseOrder,
    first: bool,
) -> Vec<f64> {
    let max = order.highest().min(moments.output_lags() - 1);
    let residuals = residual_moments_of_lags(moments, impulse, offset, max);
    let Some(noise) = NoiseFit::new(&residuals, moments.output_spread()) else {
        return Vec::new();
    };
    let chosen = match order {
        NoiseOrder::Auto => match best_order(&noise.candidates(moments.rows())) {
            0 => 0,
            _ if first => max,
            best => best,
        },
        NoiseOrder::Order(_) => max,
    };
    noise.coefficients(chosen)
}
