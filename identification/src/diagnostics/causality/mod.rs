//! Whether the output follows from the input, and not the input from the output.

pub(super) mod feedback;
pub(super) mod input_origin;
pub(super) mod output_lead;
