//! Quantities of models from before upwards and the position at rest were defined as they are now.
//!
//! Such a file lacks the range of the commands. Where its gain is negative it has upwards and downwards exchanged, and its offset is that of a
//! servo without dead band whose drives are equal.

use super::model::ServoModel;
use super::offset;
use super::quantities::{OFFSET, Quantity};
use crate::results::Interval;

/// An offset that differs by less, in its unit or as a share of itself, differs by rounding.
const ROUNDING: f64 = 1e-9;

/// What there is of in two directions.
const DIRECTED: [&str; 2] = ["top speed", "acceleration"];

impl ServoModel {
    /// With the quantities that its names stand for now. An offset that was another one is left open: its interval was that of the other.
    #[must_use]
    pub fn with_todays_quantities(mut self) -> Self {
        if self.commands.is_some() {
            return self;
        }
        let servo = self.parameters(0);
        if servo.gain < 0.0 {
            DIRECTED
                .iter()
                .for_each(|name| exchange(&mut self.quantities, name));
        }
        let rest = offset::at_rest(&servo, 0.0).unwrap_or(f64::NAN);
        let is_other = |found: &&mut Quantity| {
            let apart = (found.value - rest).abs();
            found.name == OFFSET && apart > ROUNDING * (1.0 + rest.abs())
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
fn exchange(quantities: &mut [Quantity], name: &str) {
    let place = |direction: &str| {
        let whole = format!("{name} {direction}");
        quantities.iter().position(|found| found.name == whole)
    };
    if let (Some(up), Some(down)) = (place("upwards"), place("downwards")) {
        quantities.swap(up, down);
        let (earlier, later) = quantities.split_at_mut(up.max(down));
        std::mem::swap(&mut earlier[up.min(down)].name, &mut later[0].name);
    }
}
