//! The rig at the other end of a port: references, conversation, calibration, flashing, self-test, live estimate, simulated servos.

pub mod calibration;
pub mod flash;
pub mod live;
pub mod port;
pub mod reference;
pub mod rig;
pub mod selftest;
pub mod simulated_servo;
