//! How far to trust a result: tests of its errors, and advice.
//!
//! | room | asks |
//! |---|---|
//! | `residuals` | what a fit leaves of a record, and whether it is white and free of the input |
//! | `commands`, `causality`, `times` | whether the columns are what they are taken for |
//! | `outlying`, `noise` | what the noise is, besides one stationary process |
//! | `holds`, `runs` | what differs from hold to hold and from run to run |
//! | `response_end`, `travel` | where the response ends, and where the servo does |
//! | `linearity`, `misfit` | whether the errors are made by the model |
//! | `validity` | which of the bounds hold after all of this |
//! | `explanation`, `advice` | what people read of it |

mod advice;
mod causality;
mod commands;
mod explanation;
mod holds;
mod linearity;
mod misfit;
mod noise;
mod outlying;
mod prior_outcome;
mod residuals;
mod response_end;
mod runs;
mod times;
mod travel;
mod validity;

pub use crate::estimation::{Excitation, OrderCandidate, Solver};
pub use crate::selection::{Choice, SettlingCandidate};
pub(crate) use advice::{Evidence, gather_advice};
pub use causality::feedback::Feedback;
pub(crate) use causality::feedback::feedback;
pub(crate) use causality::input_origin::explained_by_output;
pub(crate) use commands::inexact_commands::{
    InexactCommands, allow_for_inexact_commands, noise_of_commands,
};
pub(crate) use commands::input_band::{comes_back, lowest_excited};
pub use commands::noisy_commands::CommandNoise;
pub use explanation::{Bank, Explanation, Resolution};
pub use holds::hold_scatter::HoldScatter;
pub(crate) use holds::hold_scatter::allow_for_hold_scatter;
pub(crate) use holds::level_effects::LevelEffects;
pub(crate) use holds::moves_again::moves_again;
pub(crate) use holds::moves_with_next_step::moves_with_next_step;
pub(crate) use holds::rests_within_holds::{moves_after, rests_within, time_until_rest};
pub(crate) use linearity::test_linearity;
pub use linearity::{BetweenRuns, Linearity};
pub(crate) use misfit::slow_errors::SlowErrors;
pub(crate) use misfit::{BothEstimators, followed_after, rank, settlings, unexcited_above_hz};
pub use misfit::{Misfit, MisfitEvidence, Prediction};
pub use noise::hum::Hum;
pub(crate) use noise::hum::{HumLine, hum};
pub use noise::standstill_noise::StandstillNoise;
pub(crate) use noise::standstill_noise::against_standstill;
pub use noise::uneven_noise::UnevenNoise;
pub(crate) use noise::uneven_noise::allow_for_uneven_noise;
pub(crate) use outlying::outliers::{Outliers, outliers};
pub use outlying::taken_out::TakenOut;
pub use prior_outcome::PriorOutcome;
pub use residuals::correlogram::Correlogram;
pub use residuals::residual_tests::WHITENESS_LAGS;
pub(crate) use residuals::residual_tests::{
    INPUT_LAGS, WHITENESS_SAMPLES, input_independence, whiteness,
};
pub(crate) use residuals::simulation_error::{
    Simulated, beginnings, one_step_errors, simulated, simulated_whole, square,
};
pub(crate) use response_end::rise_at_end::rise_at_end;
pub use response_end::slow_end::{AllowedEnd, SlowEnd};
pub(crate) use response_end::slow_end::{
    EstimatedEnd, Regression, RegressionRun, SlowColumns, is_unseen as end_is_unseen,
};
pub(crate) use response_end::slow_servo::SlowServo;
pub(crate) use response_end::tails::Tails;
pub(crate) use runs::gain_drift::gain_drift;
pub use runs::initial_rest::Contradicted;
pub(crate) use runs::initial_rest::contradicted_rest;
pub(crate) use runs::run_offsets::{
    Beside, RunOffsets, allow_for_run_offsets, differing_means, run_offsets,
};
pub use runs::run_scatter::{Deviation, Difference, RunComparison, RunDifference, Scatter};
pub(crate) use runs::run_trends::{
    RunTrends, allow_for_run_trends, drift, slopes_left, trend_at, without_offsets_and_trends,
};
pub(crate) use runs::servo_mean::allow_for_scatter;
pub use runs::start_elsewhere::StartElsewhere;
pub(crate) use times::time_fault::TimeFault;
pub use travel::arrival::{Approach, Arrival};
pub(crate) use travel::flat_end::TravelEnd;
pub use travel::flat_end::stops_of_rests;
pub(crate) use travel::flat_end::stops_of_several_commands;
pub(crate) use travel::moves_beyond::moves_beyond;
pub(crate) use travel::outermost_rests::outermost_rests;
pub use travel::servo_stopped::ServoStopped;
pub(crate) use validity::{Validity, ValidityEvidence};
