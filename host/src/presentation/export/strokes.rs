//! The strokes that a linear model holds for: one servo moves alike in strokes of all sizes, another does not.

use super::model::Export;
use crate::presentation::summary::{recorded, stroke_in_words};

impl Export<'_> {
    /// Whether the model holds for strokes of other sizes, where that is not so or not known.
    pub(super) fn strokes(&self) -> Option<String> {
        let only = stroke_in_words(&self.metadata);
        let machine = self.servo_model.filter(|servo| !servo.is_linear());
        if self.model.linear && machine.is_none() {
            return only.map(|size| {
                format!(
                    "Strokes: all of the recording are of {size}, and this model is for those. Whether the servo moves alike in smaller and larger ones, the recording does not show."
                )
            });
        }
        let recorded = match (only, self.commands()) {
            (Some(size), _) => format!("those of the recording, all of {size}"),
            (None, Some(range)) => format!(
                "those of the recording together (commands {})",
                recorded::range_in_words(range, self.metadata.units())
            ),
            (None, None) => "those of the recording together".to_owned(),
        };
        let instead = match machine {
            Some(servo) if servo.predicts() => {
                " The servo model, which --servo-model exports, has a motion for each size."
            }
            _ => {
                " For others, small ones above all, record strokes of that size alone, and identify again."
            }
        };
        Some(format!(
            "Strokes: this servo is not linear, so that it moves otherwise in smaller and in larger strokes. This model is for {recorded}.{instead}"
        ))
    }
}
