//! Fast Fourier transforms of real signals, of any length. Each is planned once per thread, because planning costs
//! more than a transform.
//!
//! A crate of its own because the planner is generic: every crate that names it compiles all of its algorithms
//! again, for half of the time that the identification took to compile. Behind these two functions they are compiled
//! once.

use std::cell::RefCell;
use std::sync::Arc;

use realfft::RealFftPlanner;

pub use realfft::num_complex::Complex;
pub use realfft::{ComplexToReal, RealToComplex};

thread_local! {
    static PLANNER: RefCell<RealFftPlanner<f64>> = RefCell::new(RealFftPlanner::new());
}

/// The transform of `size` real values.
#[must_use]
pub fn forward(size: usize) -> Arc<dyn RealToComplex<f64>> {
    PLANNER.with_borrow_mut(|planner| planner.plan_fft_forward(size))
}

/// The inverse transform to `size` real values, each `size` times as large as before the two.
#[must_use]
pub fn inverse(size: usize) -> Arc<dyn ComplexToReal<f64>> {
    PLANNER.with_borrow_mut(|planner| planner.plan_fft_inverse(size))
}
