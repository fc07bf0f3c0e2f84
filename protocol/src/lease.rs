//! The lease: how long a rig goes on without a sign of life from its host.
//!
//! The host states its lease when it arms the rig, and every request of its session begins a new one.
//! With the frame in which it is over, a run ends and the servo returns to neutral.

use crate::timing::{FRAME_US, FRAMES_PER_SECOND};
use core::time::Duration;

/// The lease of this program (frames): two seconds. Long enough for a line that stalls for most of a
/// second, short enough for a servo that pushes against something.
pub const LEASE_FRAMES: u16 = (2 * FRAMES_PER_SECOND) as u16;

/// The same as a time.
pub const LEASE: Duration = Duration::from_micros(LEASE_FRAMES as u64 * FRAME_US as u64);

/// A host gives a sign of life four times in a lease, so that three in a row may be lost.
pub const SIGN_OF_LIFE_EVERY: Duration =
    Duration::from_micros(LEASE_FRAMES as u64 * FRAME_US as u64 / 4);

/// A run that goes on for longer than this after its host is gone does not exist: what is still heard
/// then has a host.
pub const ABANDONED_RUN_IS_OVER: Duration = LEASE.saturating_add(Duration::from_millis(500));
