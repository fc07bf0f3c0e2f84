//! The servo free on the bench.
//!
//! The parameters were fitted to the figures of the paper (its Figs 4-7). So the simulated servo reproduces these
//! figures by construction, which is no evidence about the real one. Above all, the inertia is an effective value.

use crate::motor::MotorParameters;
use std::time::Duration;

/// The bench servo at its nominal supply.
pub const BENCH: MotorParameters = MotorParameters {
    stall_torque: 1.18,
    no_load_speed: 13.1,
    inertia: 9.66e-3,
    proportional_gain: 60.0,
    speed_gain: 0.944,
    speed_filter: 1e-3,
    friction: 0.012,
    friction_speed: 0.05,
    dead_band: 0.04,
    play: 0.04,
    latency: Duration::from_micros(21_500),
    stops: None,
};
