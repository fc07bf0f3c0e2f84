//! The fit, through moments if they are accurate enough, else through QR.

use super::conditioning::is_accurate;
use super::least_squares::{Coordinates, RowInformation};
use super::qr::triangular_factor;
use super::{GlsFit, GlsOptions};
use crate::data::{Moments, Record};
use crate::options::NoiseOrder;

/// Change of the noise model that counts as rest, in standard deviations that a coefficient has
/// at least, 1/sqrt(rows).
const REST: f64 = 1e-3;

/// The fit to `moments`, and the rows that it was made from, with D of this order from `start` on. QR takes over where
/// moments are not accurate enough and the `record` that they are of is at hand. `None` when the rows do not determine the
/// response.
pub(crate) fn accurate_fit(
    moments: &Moments,
    record: Option<&Record>,
    coordinates: &Coordinates,
    order: NoiseOrder,
    start: &[f64],
) -> Option<(RowInformation, GlsFit)> {
    let from = |start: &[f64]| GlsOptions {
        order,
        start: start.to_vec(),
        tolerance: REST / (moments.rows() as f64).sqrt(),
        ..GlsOptions::default()
    };
    let information = RowInformation::from_moments(moments.clone());
    let fast = GlsFit::of(&information, coordinates, &from(start))
        .filter(|fit| record.is_none() || is_accurate(&information, fit));
    if let Some(fit) = fast {
        return Some((information, fit));
    }
    let information = RowInformation::from_factor(moments, triangular_factor(record?, moments));
    let fit = GlsFit::of(&information, coordinates, &from(&[]))?;
    Some((information, fit))
}
