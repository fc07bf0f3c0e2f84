//! Evidence on whether the errors of a servo model are noise.

use super::coordinates::Point;
use super::stretches::Stretch;
use super::uncertainty::Uncertainty;
use crate::data::Record;
use crate::results::Bounds;

/// x
pub(super) fn level(level: f64, _record: &Record, _parts: &[Stretch], _point: &Point, _found: &Uncertainty) -> Bounds<f64> {
    Bounds::Valid(level)
}
