//! The rig at the other end of a port: references, conversation, calibration, live estimate, simulated servos.

pub mod calibration;
pub mod live;
pub mod port;
pub mod reference;
pub mod rig;
pub mod simulated_servo;
