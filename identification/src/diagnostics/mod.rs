//! How far to trust a result: tests of its errors, and advice.

pub mod advice;
pub mod correlogram;
pub mod explanation;
pub mod initial_rest;
pub mod linearity;
pub mod misfit;
pub mod residual_tests;
pub mod run_scatter;
pub mod simulation_error;
pub mod standstill_noise;
pub(crate) mod validity;
