//! Talking to a rig.
//!
//! [`client`] asks and hears; [`file`] is what the user knows of their servo and sensor; [`run`] puts
//! the frames of a run in order and knows which are missing; `under_way` follows a run over a line
//! that loses some; [`capture`] records it.

pub mod capture;
pub mod client;
pub mod file;
pub mod run;
mod under_way;

pub use capture::{Capture, CaptureEnd, Progress};
pub use client::{RigClient, TalkError};
pub use file::RigFile;
