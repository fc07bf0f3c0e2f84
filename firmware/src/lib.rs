//! The rig's behaviour, over a [`Board`] and a [`Link`].
//!
//! ```text
//!               frame caught                       pulse for the next frame
//!  Board ---------------------> +-----+ ---------------------------------> Board
//!                               | Rig |
//!  Link ----------------------> +-----+ ---------------------------------> Link
//!               request                      answers, ends, frames
//! ```
//!
//! [`rig`] has the states and their transitions, without I/O; [`serve()`] connects a rig to its board and its link.
//!
//! The same code runs on the STM32F103 and, in the simulator, on a PC. It does not allocate, does not panic, and waits
//! only for the next frame or byte.

#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]
#![cfg_attr(
    test,
    allow(
        clippy::expect_used,
        clippy::indexing_slicing,
        clippy::panic,
        clippy::unreachable,
        clippy::unwrap_used
    )
)]

pub mod board;
pub mod frame_history;
pub mod limits;
mod loopback;
mod outbox;
pub mod rig;
mod run;
pub mod serve;
mod session;
mod supply_meter;

pub use board::{Board, CapturedFrame, ChipIdentity, FrameTiming, Identity, Link, Supply};
pub use rig::Rig;
pub use serve::serve;
