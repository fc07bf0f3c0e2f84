//! The noise filter of a long fit, which has to be roughly right only.

use crate::data::Moments;
use crate::estimation::{NoiseFit, best_order, residual_moments_of_lags};
use crate::numerics::largest_difference;
use crate::options::NoiseOrder;

/// Passes over fit and noise.
const PASSES: usize = 4;

/// Change of a coefficient below which the passes end.
const TOLERANCE: f64 = 1e-2;

/// D(z) of the residuals of `fit`, which gives impulse response and offset for a filter, in turn with the fit.
/// `None` when that is not determined.
pub(crate) fn alternate(
    moments: &Moments,
    order: NoiseOrder,
    fit: impl Fn(&[f64]) -> Option<(Vec<f64>, f64)>,
) -> Option<Vec<f64>> {
    let mut ar = Vec::new();
    for pass in 0..PASSES {
        let (impulse, offset) = fit(&ar)?;
        let next = filter(moments, &impulse, offset, order, pass == 0);
        let change = largest_difference(&ar, &next);
        ar = next;
        if change < TOLERANCE {
            break;
        }
    }
    Some(ar)
}

/// The highest order at the first pass, then by the criterion or as fixed.
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
    match order {
        NoiseOrder::Auto if !first => {
            noise.coefficients(best_order(&noise.candidates(moments.rows())))
        }
        _ => noise.coefficients(max),
    }
}
