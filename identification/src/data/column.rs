//! Figures of a column, whose missing values are NaN.
//!
//! ```
//! use servoid_identification::column::{extent, mean, median, span};
//! assert_eq!(mean(&[1.0, f64::NAN, 4.0]), Some(2.5));
//! assert_eq!(mean(&[f64::NAN]), None);
//! assert_eq!(extent([3.0, f64::NAN, -1.0].into_iter()), Some((-1.0, 3.0)));
//! assert_eq!(span([3.0, f64::NAN, -1.0].into_iter()), Some(4.0));
//! assert_eq!(span([2.0, 2.0].into_iter()), None);
//! assert_eq!(median(vec![3.0, 1.0, 7.0]), Some(3.0));
//! ```

pub use crate::numerics::median;

/// The mean of what is not missing; `None` where all of it is.
#[must_use]
pub fn mean(values: &[f64]) -> Option<f64> {
    let present = values.iter().filter(|value| !value.is_nan());
    let count = present.clone().count();
    (count > 0).then(|| present.sum::<f64>() / count as f64)
}

/// The lowest and the highest value; `None` where all is missing.
#[must_use]
pub fn extent(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let present = values.filter(|value| !value.is_nan());
    present.fold(None, |extent, value| {
        let (low, high) = extent.unwrap_or((value, value));
        Some((low.min(value), high.max(value)))
    })
}

/// From the lowest to the highest value; `None` where these are one, or all is missing.
#[must_use]
pub fn span(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (low, high) = extent(values)?;
    (high > low).then_some(high - low)
}
