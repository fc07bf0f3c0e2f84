//! A possible servo that was drawn at random: its quantities are its own, and intervals and fit those of the estimate.

use super::ServoModel;
use crate::results::Interval;
use crate::servo_model::quantities::value;

impl ServoModel {
    /// With the values of its own numbers; without the quantities that it has not.
    pub(super) fn with_its_own_values(mut self) -> Self {
        let servo = self.parameters(0);
        let middle = self.commands.map_or(0.0, |commands| commands.middle());
        self.quantities.retain_mut(|quantity| {
            let own = (quantity.kind()).and_then(|kind| value(kind, &servo, middle));
            if let Some(own) = own {
                quantity.value = own;
                quantity.interval = quantity.interval.map(|interval| Interval {
                    value: Some(own),
                    ..interval
                });
            }
            own.is_some()
        });
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Record;
    use crate::servo_model::descent::coordinates::Coordinate;
    use crate::servo_model::quantities::Quantity;
    use crate::servo_model::quantities::quantity_kind::QuantityKind;
    use crate::servo_model::{ServoModelOptions, fit};

    /// The estimate, taken for a draw, has the quantities of the estimate, and one with half the gain, that gain beside the intervals of the estimate.
    #[test]
    fn a_draw_has_its_own_values_and_the_intervals_of_the_estimate() {
        let levels = [0.0, 5.0, -3.0, 1.0, 4.0];
        let input: Vec<f64> = (0..900).map(|k| levels[k / 60 % 5]).collect();
        let follow = |y: &mut f64, (k, u): (usize, &f64)| {
            *y += (0.2 * (u - *y)).clamp(-0.3, 0.3);
            Some(*y + 0.01 * (0.7 * (k * k) as f64).sin())
        };
        let output: Vec<f64> = input.iter().enumerate().scan(0.0, follow).collect();
        let record = Record::of_run(0.01, input, output).unwrap();
        let estimate = fit(&record, &ServoModelOptions::default()).unwrap();
        let drawn = |gain: f64| {
            let mut model = estimate.clone();
            model.drawn = true;
            let mut coordinates = model.coordinates.iter();
            let place = coordinates.position(|at| *at == Coordinate::Gain);
            model.values[place.unwrap()] *= gain;
            model.with_todays_quantities()
        };
        for (own, of) in drawn(1.0).quantities.iter().zip(&estimate.quantities) {
            assert_eq!(own.name, of.name);
            // To rounding, as in the next.
            assert!((own.value - of.value).abs() <= 1e-9 * (1.0 + of.value.abs()));
        }
        let gain = |model: &ServoModel| model.quantity(QuantityKind::Gain).unwrap().clone();
        let (half, whole) = (gain(&drawn(0.5)), gain(&estimate));
        assert!((half.value - 0.5 * whole.value).abs() < 1e-9);
        let ends = |of: &Quantity| of.interval.valid().map(|found| (found.lower, found.upper));
        assert_eq!(ends(&half), ends(&whole));
    }
}
