//! The rig at the other end of a port: what it is told, and what it sends.

pub mod calibration;
pub mod live;
pub mod port;
pub mod reference;
pub mod rig;
