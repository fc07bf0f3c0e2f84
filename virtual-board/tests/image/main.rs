//! The flash image on the virtual board.
//!
//! Run with `--nocapture` to see the figures that the README states.

mod chain;
mod faults;
mod identification;
mod lockstep;
mod ports;
mod support;
