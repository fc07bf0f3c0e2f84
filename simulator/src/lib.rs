//! Simulated servos, and a whole rig around them.
//!
//! ```text
//!  pulse per frame --> [Servo] --> angle --> [HallSensor, ADC] --> counts
//!                        |            Apparatus            |
//!                        +---------------------------------+
//!                          SimulatedBoard, the firmware's Board
//!                          serve: the firmware's own rig
//!                          serial line at 115200 baud
//!                          InProcessRig: read, write, simulated time
//! ```
//!
//! A servo is one of four: the motor of the bench, the same motor in an aircraft, a [`linear`] one
//! whose step response is known exactly, or one of [parameters](MachineParameters) that were identified. [`SimulationOptions`] choose it, with noise, faults of the sensor
//! and differences from run to run; they are also the text after `sim:`.
//!
//! [`simulate`] leaves out the rig and the wire. Everything is deterministic: equal options and equal
//! calls give equal bytes on every machine with the same libm. Angles are in degrees outside the servos'
//! equations.

// Text from users after `sim:` must not cause a panic.
#![cfg_attr(
    not(test),
    deny(
        clippy::expect_used,
        clippy::indexing_slicing,
        clippy::panic,
        clippy::string_slice,
        clippy::unreachable,
        clippy::unwrap_used
    )
)]

mod aircraft;
mod apparatus;
mod bench;
mod board;
mod delay_line;
mod identified_servo;
mod in_process;
mod load;
mod motor;
mod noise;
mod options;
mod parts;
mod random;
mod run_to_run;
mod serial_line;
mod servo;
mod simulate;

pub mod linear;
pub mod sensor;

pub use apparatus::SimulatedFrame;
pub use identified_servo::MachineParameters;
pub use in_process::InProcessRig;
pub use noise::{Noise, NoiseKind};
pub use options::{LineSpeed, OptionsError, RANGE_DEG, ServoKind, SimulationOptions};
pub use parts::Parts;
pub use run_to_run::{Conditions, Scatter};
pub use sensor::SENSOR_SCALE;
pub use servo::{SERVO_SCALE, Servo};
pub use simulate::{simulate, simulate_train};
