//! The flash image on the virtual board.
//!
//! Run with `--nocapture` to see the figures that the README states.

mod chain;
mod cli;
mod faults;
mod flashing;
mod health;
mod identification;
mod losses;
mod ports;
mod references;
mod selftest;
mod soak;
mod start;
mod stops;
mod trains;
mod visitors;
