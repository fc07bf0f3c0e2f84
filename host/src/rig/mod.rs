//! Talking to a rig.
//!
//! [`client`] asks and hears; [`file`] is what the user knows of their servo and sensor; [`run`] puts
//! the frames of a run in order and knows which are missing; [`capture`] records a run with them.

pub mod capture;
pub mod client;
pub mod file;
pub mod run;

pub use capture::{Capture, CaptureEnd, Progress};
pub use client::{RigClient, TalkError};
pub use file::RigFile;
