//! Talking to a rig.
//!
//! The conversation itself is `servoid_client`, which knows no port and no clock. `driver` connects the
//! two; `client` asks and waits for answers; `capture` records a run, with `run_rows` for its rows and
//! `recording_ending` for the last line of its file; `capture_outcome` is what comes of it.

mod capture;
mod capture_outcome;
mod client;
mod driver;
mod recording_ending;
mod talk_error;

pub use capture::{Capture, roll_frames};
pub use capture_outcome::{CaptureEnd, CaptureError, Progress, StopReason};
pub use client::RigClient;
pub use servoid_client::{ClientError, Mismatch, mismatches};
pub use talk_error::TalkError;
