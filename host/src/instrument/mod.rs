//! The rig at the other end of a port: references, conversation, calibration, live estimate.

pub mod calibration;
pub mod live;
pub mod port;
pub mod reference;
pub mod rig;
