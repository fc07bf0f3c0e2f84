//! The flash image on the virtual board.
//!
//! Run with `--nocapture` to see the figures that the README states.

mod chain;
mod faults;
mod identification;
// The same judge as for captures from the simulated rig.
#[path = "../../../host/tests/trials/judge.rs"]
mod judge;
mod lockstep;
mod losses;
mod ports;
mod references;
mod soak;
mod stepped;
mod support;
mod visitors;
