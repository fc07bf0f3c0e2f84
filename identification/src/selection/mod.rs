//! The choice of the settling time and of the number of frequencies.

mod complete_bank;
mod long_fit;
mod long_fit_noise;
mod repetition;
mod settling_candidates;
mod settling_choice;
mod settling_range;
mod settling_search;
mod shorter_history;
mod smooth_input;

pub(crate) use complete_bank::is_wide;
pub(crate) use settling_candidates::hidden_end;
pub use settling_candidates::{Choice, SettlingCandidate};
pub(crate) use settling_choice::choose_settling;
pub(crate) use settling_range::{longest_for_prediction, longest_settling, odd_at_most};
pub(crate) use settling_search::Search;
