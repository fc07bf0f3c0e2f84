//! Parameters and their covariance from moments, for a given structure.

pub(crate) mod conditioning;
pub mod excitation;
pub mod fsf_basis;
pub mod gls;
pub mod lag_products;
pub mod least_squares;
pub mod nested_banks;
pub mod noise_model;
pub mod qr;
pub mod truncation;
pub mod variance;
