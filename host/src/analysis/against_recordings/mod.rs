//! A model against recordings that it was not identified from.

pub(super) mod misfit;
pub(super) mod noise_at_rest;
pub(super) mod pulses;
pub(super) mod spikes;
pub(super) mod validation;
