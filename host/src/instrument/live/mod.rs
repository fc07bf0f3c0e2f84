//! The step response while a run goes on, and whether its band is narrow enough.
//!
//! [`RunSamples`] makes samples of frames as they come, [`Estimator`] a step response of the samples so
//! far, and [`LiveIdentification`] does that on a thread of its own, so that capturing never waits for
//! arithmetic.

mod estimator;
mod samples;
mod thread;

pub use estimator::{Estimator, LiveStep};
pub use samples::{RunSamples, second_cycle};
pub use thread::LiveIdentification;
