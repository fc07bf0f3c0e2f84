//! The same servo in the aircraft: air load, linkage inertia, sagging supply, shaking propeller.
//!
//! As on the [bench](crate::bench), the parameters were fitted to the paper's figures (its Figs
//! 8-12).

use crate::bench::BENCH;
use crate::load::AerodynamicLoad;
use crate::motor::MotorParameters;
use std::f64::consts::TAU;

/// The supply under load, relative to nominal: scales stall torque and no-load speed.
const SUPPLY_SAG: f64 = 0.8635;

/// Factor of the inertia with linkage and surface.
const INERTIA_RATIO: f64 = 1.292;

/// The servo of the [bench](BENCH), installed.
pub const AIRCRAFT: MotorParameters = MotorParameters {
    stall_torque: BENCH.stall_torque * SUPPLY_SAG,
    no_load_speed: BENCH.no_load_speed * SUPPLY_SAG,
    inertia: BENCH.inertia * INERTIA_RATIO,
    ..BENCH
};

/// The air's load, with the propeller at 1400 rpm.
pub const LOAD: AerodynamicLoad = AerodynamicLoad {
    surface_offset: 6.0,
    surface_gain: 0.8,
    stiffness: 0.016_74,
    stiffening: 0.033_21,
    stiffening_from: 4.04,
    damping: 0.10,
    once_per_revolution: 0.073,
    four_per_revolution: 0.0365,
    rotor_speed: 1400.0 / 60.0 * TAU,
    rotor_phase: 0.0,
};
