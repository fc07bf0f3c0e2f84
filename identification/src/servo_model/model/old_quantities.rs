//! Quantities of models from before they were defined as they are now.
//!
//! A file without the range of the commands has upwards and downwards exchanged where its gain is negative, and its offset is that of a
//! servo without dead band whose drives are equal. Accelerations were those of the drive alone, without load.

use super::ServoModel;
use crate::results::Interval;
use crate::servo_model::quantities::quantity_kind::QuantityKind;
use crate::servo_model::quantities::{Quantity, value};

/// A value that differs by less, in its unit or as a share of itself, differs by rounding.
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

/// What stood for something else.
const REDEFINED: [QuantityKind; 3] = [
    QuantityKind::Offset,
    QuantityKind::AccelerationUpwards,
    QuantityKind::AccelerationDownwards,
];

impl ServoModel {
    /// With the quantities that its names stand for now. One that was another is left open: its interval was that of the other. Those of a
    /// servo that was drawn have its own values, and the intervals of the estimate.
    #[must_use]
    pub fn with_todays_quantities(mut self) -> Self {
        if self.drawn {
            return self.with_its_own_values();
        }
        let servo = self.parameters(0);
        if self.commands.is_none() && servo.gain < 0.0 {
            for directions in DIRECTED {
                exchange(&mut self.quantities, directions);
            }
        }
        let middle = self.commands.map_or(0.0, |commands| commands.middle());
        for quantity in &mut self.quantities {
            let today = quantity.kind().filter(|kind| REDEFINED.contains(kind));
            if let Some(kind) = today {
                open_another(quantity, value(kind, &servo, middle));
            }
        }
        self
    }
}

/// Opens `quantity` where it is not `today`.
fn open_another(quantity: &mut Quantity, today: Option<f64>) {
    let today = today.unwrap_or(f64::NAN);
    if (quantity.value - today).abs() <= ROUNDING * (1.0 + today.abs()) {
        return;
    }
    quantity.value = today;
    quantity.determined = false;
    quantity.interval = quantity
        .interval
        .map(|_| Interval::new(today, f64::NAN, f64::NAN));
    quantity.other_fits = None;
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
