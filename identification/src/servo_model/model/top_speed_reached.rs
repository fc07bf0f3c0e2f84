//! Whether a top speed was reached, or is extrapolated, and what the strokes show of it.

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
        let reached = self.reached.and_then(|reached| match quantity.kind()? {
            QuantityKind::TopSpeedUpwards => Some(reached.measured()[0]),
            QuantityKind::TopSpeedDownwards => Some(reached.measured()[1]),
            _ => None,
        });
        let is_shown = self.limit_of_strokes(quantity.kind()).is_some();
        quantity.determined
            && !is_shown
            && reached.is_some_and(|reached| reached < AT_TOP_SPEED * quantity.value)
    }

    /// The limit that the strokes of the record show for this top speed \[output/s\], where the model has no interval of it.
    #[must_use]
    pub fn limit_of_strokes(&self, kind: Option<QuantityKind>) -> Option<f64> {
        let limit = match kind? {
            QuantityKind::TopSpeedUpwards => self.speed_limits.upwards,
            QuantityKind::TopSpeedDownwards => self.speed_limits.downwards,
            _ => None,
        };
        limit.filter(|_| self.covariance.valid().is_none())
    }

    /// Whether a top speed stands without an interval and was not reached: a model that lacks something of the servo may extrapolate to anything.
    pub(crate) fn only_extrapolates(&self, quantity: &Quantity) -> bool {
        self.covariance.valid().is_none() && self.stayed_below(quantity)
    }
}
