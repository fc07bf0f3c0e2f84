//! The self-test of a board whose pulse line is wired to its sensor's pin: it measures its own pulses and its own timing.
//!
//! | measured                     | how                                                                            |
//! |------------------------------|--------------------------------------------------------------------------------|
//! | frame period                 | frames counted by the board, between moments of this computer's clock (`frame_period`) |
//! | edges of the pulses          | probes: conversions at instants that are moved until the reading changes (`edges`) |
//! | first sample after the edge  | when the processor has the last sample of a frame, less what the conversions take |
//! | levels, noise                | the ordinary samples                                                           |
//! | supply                       | the chip's reference voltage                                                   |
//! | processor, stack             | what the board measures of itself                                              |
//! | line                         | requests that had to be repeated, messages that could not be read              |
//!
//! `checks` has the limits, and what it means where one is not kept; `report` is the file.

mod checks;
mod edges;
mod frame_period;
mod measured;
mod measurement;
mod report;

pub use checks::{Check, Finding};
pub use measured::MeasuredBoard;
pub use measurement::{SelfTestError, SelfTestExtent, measure};
pub use report::SelfTestReport;
