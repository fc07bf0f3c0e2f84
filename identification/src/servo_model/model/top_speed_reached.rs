//! Whether a top speed was reached, or is extrapolated.

use super::ServoModel;
use crate::servo_model::quantities::Quantity;
use crate::servo_model::quantities::quantity_kind::QuantityKind;

/// A servo above this part of its top speed is at it: it comes near without end, and means over 20 ms are some percent below their peak.
const AT_TOP_SPEED: f64 = 0.9;

impl ServoModel {
    /// Whether a `quantity` is a top speed below which the servo stayed in all of the record, so that it is extrapolated. Where larger strokes were no
    /// faster, it did not.
    #[must_use]
    pub fn stayed_below(&self, quantity: &Quantity) -> bool {
        let limits = self.speed_limits;
        let of_direction = match quantity.kind() {
            Some(QuantityKind::TopSpeedUpwards) => Some((0, limits.upwards)),
            Some(QuantityKind::TopSpeedDownwards) => Some((1, limits.downwards)),
            _ => None,
        };
        let Some(((way, limit), reached)) = of_direction.zip(self.reached) else {
            return false;
        };
        let is_shown = limit.is_some() && self.covariance.valid().is_none();
        let reached = reached.measured()[way];
        quantity.determined && !is_shown && reached < AT_TOP_SPEED * quantity.value
    }

    /// Whether a top speed stands without an interval and was not reached: a model that lacks something of the servo may extrapolate to anything.
    pub(crate) fn only_extrapolates(&self, quantity: &Quantity) -> bool {
        self.covariance.valid().is_none() && self.stayed_below(quantity)
    }
}
