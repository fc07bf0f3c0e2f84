//! Parameters and their covariance from moments, for a given structure.

mod accurate_fit;
mod conditioning;
mod excitation;
mod fsf_basis;
mod gls;
mod lag_products;
mod least_squares;
mod nested_banks;
mod noise_model;
mod noise_order;
mod qr;
mod stable_prior;
mod truncation;
mod variance;

pub(crate) use accurate_fit::accurate_fit;
pub(crate) use conditioning::WELL_CONDITIONED;
pub use excitation::Excitation;
pub(crate) use fsf_basis::FsfBasis;
pub(crate) use gls::{EstimatedPart, GlsFit, GlsOptions, RunSpread};
pub use least_squares::Solver;
pub(crate) use least_squares::{
    Coordinates, Edges, NormalEquations, RowInformation, complete_bank_rss, filtered_input_moments,
    lower_input_moments, residual_moments_of_lags, solve_moments,
};
pub use nested_banks::BankCandidate;
pub(crate) use nested_banks::NestedBanks;
pub use noise_model::Noise;
pub(crate) use noise_model::{NoiseFit, lagged_filter, noise_filter};
pub use noise_order::OrderCandidate;
pub(crate) use noise_order::{autoregressive, best_order};
#[cfg(test)]
pub(crate) use qr::triangular_factor;
pub(crate) use stable_prior::Regularised;
pub(crate) use truncation::{FIRST_ORDER, SECOND_ORDER, Truncation};
pub(crate) use variance::{CurveVariance, RunPart, neighbour_correlation};
