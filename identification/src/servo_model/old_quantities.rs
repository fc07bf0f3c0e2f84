//! Quantities of models from before upwards and the position at rest were defined as they are now.
//!
//! Such a file lacks the range of the commands. Where its gain is negative it has upwards and downwards exchanged, and its offset is that of a
//! servo without dead band whose drives are equal.

use super::model::ServoModel;
use super::offset;
use super::quantities::Quantity;
use super::quantity_kind::QuantityKind;
use crate::results::Interval;

/// An offset that differs by less, in its unit or as a share of itself, differs by rounding.
const ROUNDING: f64 = 1e-9;

/// What there is of in two directions.
const DIRECTED: [[QuantityKind; 2]; 2] = [
    [
        QuantityKind::TopSpeedUpwards,
        QuantityKind::TopSpeedDownwards,
    ],
    [
        QuantityKind::AccelerationUpwards,
        QuantityKind::AccelerationDownwards,
    ],
];

impl ServoModel {
    /// With the quantities that its names stand for now. An offset that was another one is left open: its interval was that of the other.
    #[must_use]
    pub fn with_todays_quantities(mut self) -> Self {
        if self.commands.is_some() {
            return self;
        }
        let servo = self.parameters(0);
        if servo.gain < 0.0 {
            for directions in DIRECTED {
                exchange(&mut self.quantities, directions);
            }
        }
        let rest = offset::at_rest(&servo, 0.0).unwrap_or(f64::NAN);
        let is_other = |found: &&mut Quantity| {
            let apart = (found.value - rest).abs();
            found.kind() == Some(QuantityKind::Offset) && apart > ROUNDING * (1.0 + rest.abs())
        };
        if let Some(quantity) = self.quantities.iter_mut().find(is_other) {
            quantity.value = rest;
            quantity.determined = false;
            quantity.interval = quantity
                .interval
                .map(|_| Interval::new(rest, f64::NAN, f64::NAN));
            quantity.other_fits = None;
        }
        self
    }
}

/// Exchanges the two directions of a quantity.
fn exchange(quantities: &mut [Quantity], directions: [QuantityKind; 2]) {
    let place = |kind| {
        quantities
            .iter()
            .position(|found| found.kind() == Some(kind))
    };
    if let [Some(up), Some(down)] = directions.map(place) {
        quantities.swap(up, down);
        let (earlier, later) = quantities.split_at_mut(up.max(down));
        std::mem::swap(&mut earlier[up.min(down)].name, &mut later[0].name);
    }
}
