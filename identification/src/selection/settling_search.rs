//! What a settling time is chosen from.

use crate::data::{Moments, Record};
use crate::options::NoiseOrder;

/// The data at hand, and the limits of the search.
#[derive(Clone, Copy)]
pub(crate) struct Search<'a> {
    /// With `longest` input lags and those that the noise order needs.
    pub(crate) moments: &'a Moments,
    /// `None` where moments came without their record: then other moments cannot be collected.
    pub(crate) record: Option<&'a Record<'a>>,
    /// The longest N considered \[samples, odd\].
    pub(crate) longest: usize,
    /// Order of the noise model.
    pub(crate) order: NoiseOrder,
    /// How often each error comes, of those that are no noise: 1 where all are noise. What a test takes for evidence has to be as much in one of them.
    pub(crate) repeats: f64,
}
