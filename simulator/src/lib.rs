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
//! | module        | content                                                            |
//! |---------------|--------------------------------------------------------------------|
//! | [`servo`]     | the trait of all simulated servos; pulses to commanded angles       |
//! | [`motor`]     | the equations of a digital position servo                          |
//! | [`mod@bench`] | that servo on the bench                                            |
//! | [`aircraft`]  | the same servo in an aircraft, under [`load`]                      |
//! | [`linear`]    | a linear servo whose step response is known exactly                |
//! | [`conditions`] | differences between two runs of the same servo                    |
//! | [`noise`]     | noise of the measured angle                                        |
//! | [`sensor`]    | the Hall sensor, its divider and the ADC                           |
//! | [`options`]   | all options, and their text after `sim:`                           |
//! | [`board`]     | a native board for the firmware's library                          |
//! | [`in_process`] | the rig on that board, driven by its caller                       |
//!
//! [`simulate`] leaves out the rig and the wire. All of it is deterministic: equal
//! [`SimulationOptions`] and equal calls give equal bytes on every machine with the same libm.
//! Angles are in degrees outside the servos' equations, times in [`std::time::Duration`].

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

mod apparatus;
mod delay_line;
mod parts;
mod random;
mod serial_line;
mod simulate;

pub mod aircraft;
pub mod bench;
pub mod board;
pub mod conditions;
pub mod in_process;
pub mod linear;
pub mod load;
pub mod motor;
pub mod noise;
pub mod options;
pub mod sensor;
pub mod servo;

pub use apparatus::{Apparatus, Sample, SimulatedFrame};
pub use board::{FrameClock, SimulatedBoard};
pub use conditions::{Conditions, Scatter};
pub use in_process::InProcessRig;
pub use options::{LineSpeed, OptionsError, ServoKind, SimulationOptions};
pub use parts::Parts;
pub use sensor::SENSOR_SCALE;
pub use servo::{SERVO_SCALE, Servo};
pub use simulate::simulate;
