//! Samples that are left out, and why.

pub(super) mod other_strokes;
pub(super) mod outliers;
pub(super) mod spikes;
pub(super) mod taken_out;
