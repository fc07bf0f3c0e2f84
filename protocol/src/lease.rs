//! The lease: the time for which a rig goes on without a request from its host.
//!
//! The host sets its lease when it arms the rig, and each request of its session begins a new one.
//! With the frame in which the lease lapses, a run ends and the servo returns to neutral.

use crate::pulse_train::PulseTrain;
use core::time::Duration;

/// The lease of this program (s). It outlasts a line that stalls for most of a second, and is short enough for a servo
/// that pushes against something.
pub const LEASE_S: u32 = 2;

/// The longest lease that a rig grants (s). What was commanded goes on for no longer after its host has died.
pub const LONGEST_LEASE_S: u32 = 5;

/// [`LEASE_S`] in frames of the usual train.
pub const LEASE_FRAMES: u16 = PulseTrain::USUAL.frames_in(LEASE_S);

/// [`LEASE_S`] as a time. A rig arms and begins a run for no longer than this after a sign of life.
pub const LEASE: Duration = Duration::from_secs(LEASE_S as u64);

/// Time between keep-alives: four in a lease, so three in a row may be lost.
pub const SIGN_OF_LIFE_EVERY: Duration = Duration::from_millis(1_000 * LEASE_S as u64 / 4);

/// After this time without its host, every run is over. If frames still arrive then, the rig has another host.
pub const ABANDONED_RUN_IS_OVER: Duration = LEASE.saturating_add(Duration::from_millis(500));
