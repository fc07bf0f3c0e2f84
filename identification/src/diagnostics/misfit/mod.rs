//! When the errors are not noise.
//!
//! Generalised least squares is the better estimator when the errors of the model are noise. On a mechanism that
//! the model cannot represent (flexible, nonlinear, longer than N), they are a function of the input; whitening then
//! takes weight away from where the response lives, and the result can simulate far worse than plain least squares.
//! Both estimates follow from the moments at no cost, so both are made. Where generalised least squares simulates
//! worse by more than [`WHITENING_COST_POINTS`](crate::thresholds::WHITENING_COST_POINTS), the bounds are withdrawn,
//! and settling time, frequencies and estimator are chosen by how well they predict parts of the record that they
//! have not seen.
//!
//! A servo that is not linear need not show in that figure: its errors can be spread over all frequencies alike.
//! Where [`crate::diagnostics::linearity`] finds one, the same is done if the simulation leaves more than
//! [`UNEXPLAINED_PERCENT`](crate::thresholds::UNEXPLAINED_PERCENT) of the motion, or if fewer than
//! [`STEPS_FOLLOWED`](crate::thresholds::STEPS_FOLLOWED) of the steps of the input are held until the servo has all
//! but followed: the step response of such a servo can be seen, but not computed from other motion.

mod estimators;
mod evidence;
mod ranking;
pub(super) mod slow_errors;

pub(crate) use estimators::{BothEstimators, followed_after, unexcited_above_hz};
pub use evidence::{Misfit, MisfitEvidence, Prediction};
pub(crate) use ranking::{rank, settlings};
