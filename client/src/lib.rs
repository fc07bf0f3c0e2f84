//! The host's half of the conversation with a rig, without input or output.
//!
//! ```text
//!                bytes, time              bytes, time
//!   serial port  ----------->  +--------+  -------->  handle
//!   TCP stream                 | Client |  -------->  poll_event: frames in order, answers, the end
//!   simulation   <-----------  +--------+  -------->  next_deadline: when to call handle at the latest
//!                poll_transmit
//! ```
//!
//! There is no thread, clock or port in here: whoever drives a [`Client`] hands it what came and what
//! time it is. So it runs wherever bytes come from, and its tests wait for nothing.
//!
//! | module            | what it does                                                            |
//! |-------------------|-------------------------------------------------------------------------|
//! | `client`          | the door: bytes and time in, bytes and events out                       |
//! | `event`           | what happens, for a driver                                              |
//! | `error`           | why a conversation failed, with what to do                              |
//! | `line`            | messages to bytes and back, and the one request that waits for its answer |
//! | `request`         | when a request is repeated, and which message answers it                |
//! | `foreign_traffic` | listens for another program's run before anything is sent               |
//! | `session`         | opens a session                                                         |
//! | `mismatch`        | why a rig does not go with this program                                 |
//! | `task`            | one thing that a client is busy with, such as a request or arming       |
//! | `run`             | starts a run and follows it to its end                                  |
//! | `commanded`       | what a run was commanded to be, and what contradicts it                 |
//! | `frame_order`     | puts the frames of a run in order                                       |
//! | `gaps`            | when missing frames are asked for again, and when they are given up     |
//! | `silence`         | how long nothing may come                                               |
//! | `run_ending`      | how a run ended, and whether all of it arrived                          |

#![cfg_attr(
    not(test),
    deny(
        clippy::expect_used,
        clippy::indexing_slicing,
        clippy::panic,
        clippy::unreachable,
        clippy::unwrap_used
    )
)]

mod client;
mod commanded;
mod error;
mod event;
mod foreign_traffic;
mod frame_order;
mod gaps;
mod line;
mod mismatch;
mod request;
mod run;
mod run_ending;
mod session;
mod silence;
mod task;

pub use client::{Client, Connect};
pub use commanded::Contradiction;
pub use error::ClientError;
pub use event::Event;
pub use mismatch::{Mismatch, mismatches};
pub use request::Answer;
pub use run_ending::{Arrived, RunEnding};
