//! Mathematics that is independent of servos.

mod chebyshev;
mod convolution;
mod critical_values;
mod halving;
mod lagged_sums;
pub(crate) mod matrix_rows;
mod order_statistics;
mod rounding;
mod sample_mean;
mod vectors;

pub(crate) use convolution::causal_filter;
pub(crate) use critical_values::{
    chi_square_quantile, chi_square_upper_tail, normal_cdf, normal_upper_quantile,
    simultaneous_critical,
};
pub use critical_values::{pointwise_critical, student_critical};
pub(crate) use halving::halved;
pub(crate) use lagged_sums::LaggedSums;
pub use order_statistics::median;
pub use rounding::{command_in_words, six_digits, with_unit};
pub(crate) use rounding::{four_digits, not_negative, two_digits};
pub(crate) use sample_mean::SampleMean;
pub(crate) use servoid_linear_algebra::{
    SymmetricEigen, add_outer_product, backward_solve, cholesky, condition, factorised,
    forward_solve, inverse_of_lower, inverse_of_square, mirror, outer_square, spectral_radius,
    symmetric_eigen, times, upper_factor,
};
pub(crate) use vectors::{
    add_combination, dot, largest_difference, running_sum, square_about_mean,
};
