//! Whether a top speed was reached, or is extrapolated, and what the strokes show of it.

use super::ServoModel;
use crate::results::Reason;
use crate::servo_model::descent::coordinates::LoadKind;
use crate::servo_model::quantities::Quantity;
use crate::servo_model::quantities::quantity_kind::QuantityKind;

/// A servo above this part of its top speed is at it: it comes near without end, and means over 20 ms are some percent below their peak.
pub(super) const AT_TOP_SPEED: f64 = 0.9;

impl ServoModel {
    /// Whether a `quantity` is a top speed below which the servo stayed in all of the record, so that it is extrapolated. Where larger strokes were no
    /// faster, it did not.
    #[must_use]
    pub fn stayed_below(&self, quantity: &Quantity) -> bool {
        let reached = self.reached.map(|reached| reached.measured());
        self.was_below(quantity, quantity.value, reached)
    }

    /// Whether a top speed, which may be `speed`, is above those that were `reached` up and down, and the strokes do not show it.
    fn was_below(&self, quantity: &Quantity, speed: f64, reached: Option<[f64; 2]>) -> bool {
        let reached = reached.and_then(|[up, down]| match quantity.kind()? {
            QuantityKind::TopSpeedUpwards => Some(up),
            QuantityKind::TopSpeedDownwards => Some(down),
            _ => None,
        });
        let is_shown = self.limit_of_strokes(quantity.kind()).is_some();
        quantity.determined
            && !is_shown
            && reached.is_some_and(|reached| reached < AT_TOP_SPEED * speed)
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

    /// Whether a top speed stands without an interval and was not reached.
    pub(crate) fn only_extrapolates(&self, quantity: &Quantity) -> bool {
        self.covariance.valid().is_none() && self.stayed_below(quantity)
    }

    /// Leaves top speeds open that the servo did not surely come to, by the model or another fit, where errors that are not noise show that the model lacks something of it:
    /// that may extrapolate to anything. A servo of one speed has come to it in both directions where it has in one.
    pub(crate) fn leave_extrapolated_speeds_open(&mut self) {
        if self.covariance.withdrawn() != Some(Reason::ErrorsNotNoise) {
            return;
        }
        let has_one_speed = !self.terms.two_speeds && self.terms.load == LoadKind::None;
        let surely = self.reached.map(|reached| match has_one_speed {
            true => [reached.upwards.max(reached.downwards); 2],
            false => [reached.upwards, reached.downwards],
        });
        let all = self.quantities.iter();
        let extrapolates = |quantity: &Quantity| {
            let other_fits = quantity.other_fits.map_or(f64::NAN, |fits| fits.most);
            self.was_below(quantity, quantity.value.max(other_fits), surely)
        };
        let extrapolated: Vec<bool> = all.map(extrapolates).collect();
        for (quantity, extrapolated) in self.quantities.iter_mut().zip(extrapolated) {
            quantity.determined &= !extrapolated;
        }
    }

    /// Leaves out of other fits what is slower than the servo surely was: a top speed is not below a speed, but for one under a load that helps elsewhere. A value without an interval
    /// that is slower itself is none.
    pub(crate) fn leave_slower_fits_out(&mut self) {
        let has_bounds = self.covariance.valid().is_some();
        let without_load = self.terms.load == LoadKind::None;
        let Some(reached) = self.reached.filter(|_| without_load) else {
            return;
        };
        for quantity in &mut self.quantities {
            let surely = match quantity.kind() {
                Some(QuantityKind::TopSpeedUpwards) => reached.upwards,
                Some(QuantityKind::TopSpeedDownwards) => reached.downwards,
                _ => continue,
            };
            quantity.determined &= has_bounds || quantity.value >= surely;
            if let Some(fits) = &mut quantity.other_fits {
                fits.least = fits.least.max(surely.min(fits.most).min(quantity.value));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Record;
    use crate::nonlinear::SpeedLimits;
    use crate::results::Bounds;
    use crate::servo_model::{ServoModelOptions, Spread, fit};

    #[test]
    fn a_top_speed_without_an_interval_is_open_where_the_servo_stayed_below_it() {
        let input: Vec<f64> = (0..900)
            .map(|k| [0.0, 5.0, -3.0, 1.0, 4.0][k / 60 % 5])
            .collect();
        let follow = |y: &mut f64, u: &f64| {
            *y += (0.2 * (u - *y)).clamp(-0.5, 0.5);
            Some(*y)
        };
        let output: Vec<f64> = input.iter().scan(0.0, follow).collect();
        let record = Record::of_run(0.01, input, output).unwrap();
        let model = fit(&record, &ServoModelOptions::default()).unwrap();
        let kind = QuantityKind::TopSpeedUpwards;
        let is_open = |times: f64| {
            let mut model = model.clone();
            let reached = model.reached.unwrap().upwards;
            model.covariance = Bounds::Withdrawn(Reason::ErrorsNotNoise);
            model.speed_limits = SpeedLimits::default();
            let mut quantities = model.quantities.iter_mut();
            let speed = quantities.find(|of| of.kind() == Some(kind)).unwrap();
            (speed.determined, speed.value) = (true, times * reached);
            speed.other_fits = None;
            model.leave_extrapolated_speeds_open();
            !model.quantity(kind).unwrap().determined
        };
        assert!(!is_open(1.05));
        assert!(is_open(1.2));
        let mut model = model.clone();
        model.terms.load = LoadKind::None;
        let reached = model.reached.unwrap().upwards;
        let mut quantities = model.quantities.iter_mut();
        let speed = quantities.find(|of| of.kind() == Some(kind)).unwrap();
        speed.other_fits = Some(Spread {
            least: 0.5 * reached,
            most: 1.1 * reached,
        });
        model.leave_slower_fits_out();
        let fits = model.quantity(kind).and_then(|speed| speed.other_fits);
        // The top speed itself is one of them, which noise may have left below a speed that was reached.
        let least = model.quantity(kind).unwrap().value.min(reached);
        assert_eq!(fits.unwrap().least, least);
        for (times, is_one) in [(0.95, false), (1.0, true)] {
            model.covariance = Bounds::Withdrawn(Reason::ErrorsNotNoise);
            let mut quantities = model.quantities.iter_mut();
            let speed = quantities.find(|of| of.kind() == Some(kind)).unwrap();
            (speed.determined, speed.value) = (true, times * reached);
            model.leave_slower_fits_out();
            assert_eq!(model.quantity(kind).unwrap().determined, is_one, "{times}");
        }
    }
}
