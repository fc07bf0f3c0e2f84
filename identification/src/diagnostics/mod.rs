//! How far to trust a result: tests of its errors, and advice.

mod advice;
mod correlogram;
mod end_level;
mod explanation;
mod feedback;
mod filtered_rows;
mod held_output;
mod hum;
mod initial_rest;
mod input_origin;
mod lag_drift;
mod late_command;
mod linearity;
mod misfit;
mod moves_again;
mod noise_prediction;
mod outliers;
mod output_lead;
mod part_means;
mod prior_outcome;
mod residual_tests;
mod rise_at_end;
mod run_offsets;
mod run_scatter;
mod run_trends;
mod servo_mean;
mod simulation_error;
mod slow_end;
mod spikes;
mod standstill_noise;
mod time_fault;
mod travel_end;
mod uneven_noise;
mod validity;

pub use crate::estimation::{Excitation, OrderCandidate, Solver};
pub use crate::selection::{Choice, SettlingCandidate};
pub(crate) use advice::{Evidence, gather_advice};
pub use correlogram::Correlogram;
pub use explanation::{Bank, Explanation, Resolution};
pub use feedback::Feedback;
pub(crate) use feedback::feedback;
pub use hum::Hum;
pub(crate) use hum::{HumLine, hum};
pub use initial_rest::Contradicted;
pub(crate) use initial_rest::contradicted_rest;
pub(crate) use input_origin::explained_by_output;
pub(crate) use linearity::test_linearity;
pub use linearity::{BetweenRuns, Linearity};
pub(crate) use misfit::{BothEstimators, followed_after, rank, settlings, unexcited_above_hz};
pub use misfit::{Misfit, MisfitEvidence, Prediction};
pub(crate) use moves_again::moves_again;
pub use outliers::TakenOut;
pub(crate) use outliers::{Outliers, outliers};
pub use prior_outcome::PriorOutcome;
pub use residual_tests::WHITENESS_LAGS;
pub(crate) use residual_tests::{INPUT_LAGS, WHITENESS_SAMPLES, input_independence, whiteness};
pub(crate) use rise_at_end::rise_at_end;
pub(crate) use run_offsets::{RunOffsets, allow_for_run_offsets, differing_means, run_offsets};
pub use run_scatter::{Deviation, Difference, RunComparison, RunDifference, Scatter};
pub(crate) use run_trends::{RunTrends, allow_for_run_trends, drift, slopes_left, trend_at};
pub(crate) use servo_mean::allow_for_scatter;
pub(crate) use simulation_error::{
    beginnings, one_step_errors, simulated, simulated_whole, square,
};
pub use slow_end::{AllowedEnd, SlowEnd};
pub(crate) use slow_end::{
    EstimatedEnd, Regression, RegressionRun, SlowColumns, is_unseen as end_is_unseen,
};
pub use standstill_noise::StandstillNoise;
pub(crate) use standstill_noise::against_standstill;
pub(crate) use time_fault::TimeFault;
pub(crate) use travel_end::TravelEnd;
pub use uneven_noise::UnevenNoise;
pub(crate) use uneven_noise::allow_for_uneven_noise;
pub(crate) use validity::{Validity, ValidityEvidence};
