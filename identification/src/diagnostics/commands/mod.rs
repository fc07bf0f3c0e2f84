//! The column of commands: its errors, and what it excites.

pub(super) mod command_errors;
pub(super) mod inexact_commands;
pub(super) mod input_band;
pub(super) mod noisy_commands;
pub(super) mod rounded_commands;
