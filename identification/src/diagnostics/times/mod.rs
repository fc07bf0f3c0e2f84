//! Whether the times of a record are what they are taken for.

pub(super) mod held_output;
pub(super) mod late_command;
pub(super) mod time_fault;
