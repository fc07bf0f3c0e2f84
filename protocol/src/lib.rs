//! The common language of rig and host: units, timing, references and messages.
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
//! | module        | content                                                                    |
//! |---------------|----------------------------------------------------------------------------|
//! | [`units`]     | pulse widths (µs), sensor counts, degrees, and the scales between them     |
//! | [`timing`]    | the frame and the ten samples in it                                        |
//! | [`pulse_train`] | the pulses that a servo is made for: their type and rate, and the frame that follows |
//! | [`mod@reference`] | the reference signals, expanded to one pulse per frame by the same code on both ends |
//! | [`lease`]     | the time for which a rig goes on without a request from its host           |
//! | [`hello`]     | the identity of a rig, in a layout that never changes                      |
//! | [`health`]    | the chip, its supply and its last fault: what the frozen identity has no room for |
//! | [`loopback`]  | the self-test of a board that is wired to itself                            |
//! | [`message`]   | requests and answers                                                       |
//! | [`schema`]    | a hash over all messages: with unequal ones a rig does not arm             |
//! | [`framing`]   | messages to bytes and back: postcard, CRC-32, COBS, zero bytes around      |
//!
//! Everything here is `no_std`, allocates nothing, and does not panic on any received bytes.

#![cfg_attr(not(test), no_std)]
// No received byte may cause a panic.
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
pub mod health;
pub mod hello;
pub mod lease;
pub mod loopback;
pub mod message;
pub mod pulse_train;
pub mod reference;
pub mod schema;
pub mod timing;
pub mod units;

pub use framing::{Decoder, Rejects};
pub use health::Health;
pub use hello::Hello;
pub use message::{
    Command, EndReason, Frame, Outcome, Refusal, Request, RigMessage, RunCheck, Status,
};
pub use pulse_train::PulseTrain;
pub use reference::Reference;
pub use units::{Counts, Degrees, PulseWidth, SensorScale, ServoScale};
