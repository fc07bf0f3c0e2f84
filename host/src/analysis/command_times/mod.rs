//! Whether commands took effect when the rows say so, or at pulses or moments of their own.

pub(super) mod answer_scatter;
pub(super) mod command_answers;
pub(super) mod command_edges;
pub(super) mod commands_at_pulses;
pub(super) mod pulse_errors;
pub(super) mod pulse_frames;
pub(super) mod pulse_search;
