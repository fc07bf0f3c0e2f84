//! The picture of the answer: how the servos answer a stroke, with the bounds of the whole curve.

use super::figure::{Figure, Named};
use super::response::step_panel;
use super::strokes::{NamedServo, stroke_panel};
use crate::data::units::Units;

/// What the picture shows.
#[derive(Clone, Debug)]
pub enum DrawnAnswer<'a> {
    /// Step responses of linear models.
    Linear(Vec<Named<'a>>),
    /// Strokes of servo models.
    AsMachines(Vec<NamedServo<'a>>),
}

/// Name of the picture.
const NAME: &str = "answer";

/// The picture.
#[must_use]
pub fn answer(of: &DrawnAnswer<'_>, units: Units<'_>) -> Figure {
    let (title, panel) = match of {
        DrawnAnswer::Linear(models) => ("Step response", step_panel(models, units)),
        DrawnAnswer::AsMachines(servos) => {
            ("Strokes of the servo model", stroke_panel(servos, units))
        }
    };
    Figure::new(NAME, title, vec![panel])
}
