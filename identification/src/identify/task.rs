//! What is to be identified, and how.

use crate::data::Record;
use crate::estimation::MAX_AUTO_ORDER;
use crate::options::{NoiseOrder, Options};

/// The data and the options of one identification.
#[derive(Clone, Copy)]
pub(super) struct Task<'a> {
    /// `None` where moments came without their record.
    pub(super) record: Option<&'a Record>,
    pub(super) options: &'a Options,
}

/// Lags that the noise model may need.
pub(super) fn noise_lags(order: NoiseOrder) -> usize {
    match order {
        NoiseOrder::Auto => MAX_AUTO_ORDER,
        NoiseOrder::Order(order) => order,
    }
}
