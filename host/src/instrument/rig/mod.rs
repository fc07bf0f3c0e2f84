//! Talking to a rig.
//!
//! [`client`] asks and hears, by the requests and answers of `conversation`, once `overheard` has found
//! no other program's run; [`mismatch`] says why a rig cannot be used with this
//! program; [`mod@file`] is what the user knows of their servo and sensor; [`run`] puts
//! the frames of a run in order and knows which are missing; `under_way` follows a run over a line
//! that loses some; [`capture`] records it.

pub mod capture;
pub mod client;
mod conversation;
mod foreign_traffic;
pub mod mismatch;
pub mod run;
mod run_follower;
mod talk_error;

pub use capture::{Capture, CaptureEnd, Progress, StopReason};
pub use client::{RigClient, TalkError};
