//! The metadata that a model has from its files.

use super::about::About;
use crate::data::model_metadata::ModelMetadata;
use servoid_protocol::timing::FRAME_US;

/// The pulse frame of servoid's rig \[s\].
const RIG_FRAME_S: f64 = FRAME_US as f64 * 1e-6;

impl From<&About> for ModelMetadata {
    fn from(about: &About) -> Self {
        // A recording of servoid was commanded by pulses, which change with the frame only.
        let pulse_frame_s = about.by_servoid.then_some(RIG_FRAME_S);
        Self::new(
            about.input_unit.clone(),
            about.output_unit.clone(),
            pulse_frame_s,
        )
    }
}
