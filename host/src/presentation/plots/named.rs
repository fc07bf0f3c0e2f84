//! Names, colours and axis labels that all figures of models share.

use super::figure::Ink;
use servoid_identification::results::Model;

/// A model with the name that its curves carry.
#[derive(Clone, Copy, Debug)]
pub struct Named<'a> {
    /// What the legend calls it.
    pub name: &'a str,
    /// The model.
    pub model: &'a Model,
}

/// Colours of the first model and of the second.
pub(super) const INKS: [Ink; 2] = [Ink::Model, Ink::SecondModel];

/// "angle (deg)", or the quantity alone where the unit is not known.
pub(super) fn with_unit(quantity: &str, unit: Option<&str>) -> String {
    unit.map_or_else(
        || quantity.to_owned(),
        |unit| format!("{quantity} ({unit})"),
    )
}
