//! What the rig and its host must agree on.
//!
//! ```text
//!  host                                                            rig
//!   |  Request{session, id, command}  --- framing --->              |
//!   |                                 <--- framing ---  RigMessage  |
//!
//!  Reference --> one PulseWidth per PWM frame --> [servo] --> 10 Counts --> Frame
//! ```
//!
//! Read the modules in this order:
//!
//! | module        | what it fixes                                                              |
//! |---------------|----------------------------------------------------------------------------|
//! | [`units`]     | pulse widths (µs), sensor counts, degrees, and the scales between them     |
//! | [`timing`]    | the 20 ms PWM frame and the ten samples in it                              |
//! | [`mod@reference`] | the reference signals, expanded to one pulse per frame by the same code on both ends |
//! | [`lease`]     | how long a rig goes on without a sign of life from its host                |
//! | [`hello`]     | who the rig is: a layout that never changes                                |
//! | [`message`]   | requests and what the rig answers                                          |
//! | [`schema`]    | a hash over all messages: unequal ones do not arm                          |
//! | [`framing`]   | messages to bytes and back: postcard, CRC-32, COBS, zero bytes around      |
//!
//! Everything here is `no_std`, allocates nothing and never panics on what the wire brings.

#![cfg_attr(not(test), no_std)]
// What comes over the wire meets no panic here.
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

pub mod framing;
pub mod hello;
pub mod lease;
pub mod message;
pub mod reference;
pub mod schema;
pub mod timing;
pub mod units;

pub use framing::{Decoder, Rejects};
pub use hello::Hello;
pub use message::{
    Command, EndReason, Frame, Outcome, Refusal, Request, RigMessage, RunCheck, Status,
};
pub use reference::Reference;
pub use units::{Counts, Degrees, PulseWidth, SensorScale, ServoScale};
