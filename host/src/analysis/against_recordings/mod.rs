//! A model against recordings that it was not identified from.

mod beside_pulses;
pub(super) mod error_by_octave;
mod larger_error;
pub(super) mod misfit;
mod model_on_recording;
pub(super) mod noise_at_rest;
pub(super) mod pulses;
pub(super) mod spikes;
pub(super) mod validation;
