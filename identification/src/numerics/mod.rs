//! Mathematics that is independent of servos.

pub mod chebyshev;
pub mod convolution;
pub mod critical_values;
pub mod fft;
pub mod lagged_sums;
pub mod linear_algebra;
pub mod matrix_rows;
pub mod vectors;
