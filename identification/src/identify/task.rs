//! What is to be identified, and how.

use super::disturbances::Disturbances;
use crate::data::Record;
use crate::options::Options;

/// The data and the options of one identification.
#[derive(Clone, Copy)]
pub(super) struct Task<'a> {
    /// `None` where moments came without their record.
    pub(super) record: Option<&'a Record<'a>>,
    /// The same with its disturbances.
    pub(super) recorded: Option<&'a Record<'a>>,
    pub(super) options: &'a Options,
    /// Whether bounds are those of the servo's mean, or those of its runs.
    pub(super) of_servo: bool,
    /// Whether the response may go on beyond a settling time that is given. Where a caller states it, it does not.
    pub(super) may_go_on: bool,
    /// What was taken out of the record.
    pub(super) disturbances: &'a Disturbances,
}
