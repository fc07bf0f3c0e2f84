//! Trials of the whole way from a rig to a result; each returns its outcome.

pub mod any_bytes;
pub mod chaos;
pub mod judge;
pub mod kill;
pub mod linearity;
pub mod mixes;
pub mod recordings;
pub mod verdicts;
