//! What is collected of the data before anything is estimated.

use super::noise_lags;
use super::plan::Plan;
use crate::data::moments::Moments;
use crate::data::record::Record;
use crate::diagnostics::residual_tests::INPUT_LAGS;
use crate::error::Error;
use crate::estimation::excitation::Excitation;
use crate::options::{NoiseOrder, Options, Settling};
use crate::selection::settling_time::{self, Choice};
use crate::selection::smooth_input;

/// Share of rows that must be gained to make another pass over the data worth while.
const WORTHWHILE_ROWS: f64 = 0.01;

/// Moments of the data, for a plan.
pub(super) struct Collected {
    /// With the lags of the plan.
    pub(super) moments: Moments,
    /// With further lags, for the test of independence.
    pub(super) extended: Moments,
}

impl Collected {
    /// Of a record, and the plan that was made on the way.
    pub(super) fn from_record(record: &Record, options: &Options) -> Result<(Self, Plan), Error> {
        let lags = noise_lags(options.noise_order);
        let Settling::Samples(settling) = options.settling else {
            return Self::with_chosen_settling(record, options);
        };
        let extended = Moments::of_record(record, settling + lags + INPUT_LAGS, lags + 1);
        let moments = extended.with_fewer_lags(record, settling + lags);
        let plan = Plan::for_settling(settling, &moments, options)?;
        Ok((Self { moments, extended }, plan))
    }

    fn with_chosen_settling(record: &Record, options: &Options) -> Result<(Self, Plan), Error> {
        let order = options.noise_order;
        let longest = settling_time::longest_settling(record, options.longest_settling)?;
        let lags = noise_lags(order);
        let moments_for = |longest: usize| Moments::of_record(record, longest + lags, lags + 1);
        let long = moments_for(longest);
        let complete = settling_time::choose_complete_bank(&long, longest, order);
        let (long, choice) = match complete {
            Some(choice) => (long, choice),
            None => match with_shorter_history(&moments_for, longest, order) {
                Some(found) => found,
                None => {
                    let choice = smooth_input::choose(&long, longest, order)?;
                    (long, choice)
                }
            },
        };
        let moments = with_all_rows(record, &long, choice.settling, order);
        let beyond = choice.settling + noise_lags(order) + INPUT_LAGS;
        let extended = if beyond <= long.input_lags() {
            long.truncated(beyond, long.output_lags())
        } else {
            Moments::of_record(record, beyond, long.output_lags())
        };
        let plan = Plan::of_choice(choice, &moments, options)?;
        Ok((Self { moments, extended }, plan))
    }

    /// Of moments that came without their record, and the plan.
    pub(super) fn from_moments(
        moments: &Moments,
        options: &Options,
    ) -> Result<(Self, Plan), Error> {
        let noise = noise_lags(options.noise_order).min(moments.output_lags() - 1);
        let available = moments.input_lags().saturating_sub(noise);
        let plan = match options.settling {
            Settling::Auto => {
                let longest = available - usize::from(available.is_multiple_of(2));
                let longest = longest.min(options.longest_settling.unwrap_or(longest));
                let choice = settling_time::choose(moments, longest, options.noise_order)?;
                Plan::of_choice(choice, moments, options)?
            }
            Settling::Samples(settling) if settling > available => {
                return Err(Error::LagMismatch {
                    left: settling + noise,
                    right: moments.input_lags(),
                });
            }
            Settling::Samples(settling) => Plan::for_settling(settling, moments, options)?,
        };
        let collected = Self {
            moments: moments.clone(),
            extended: moments.clone(),
        };
        Ok((collected, plan))
    }

    /// Of a record again, for another settling time and noise order.
    pub(super) fn again(record: &Record, settling: usize, order: NoiseOrder) -> Self {
        let lags = noise_lags(order);
        Self {
            moments: Moments::of_record(record, settling + lags, lags + 1),
            extended: Moments::of_record(record, settling + lags + INPUT_LAGS, lags + 1),
        }
    }
}

/// The first choice among shorter histories that has all frequencies, with its moments: of an input with
/// edges, which then are in rows that they were not in.
fn with_shorter_history(
    moments_for: &impl Fn(usize) -> Moments,
    longest: usize,
    order: NoiseOrder,
) -> Option<(Moments, Choice)> {
    settling_time::shorter(longest).find_map(|longest| {
        let moments = moments_for(longest);
        if Excitation::of(&moments).is_smooth() {
            return None;
        }
        let choice = settling_time::choose_complete_bank(&moments, longest, order)?;
        Some((moments, choice))
    })
}

/// The moments for the chosen settling time: over more rows than the choice could use, if that is
/// worth another pass.
fn with_all_rows(
    record: &Record,
    moments: &Moments,
    settling: usize,
    order: NoiseOrder,
) -> Moments {
    let (lags, outputs) = (settling + noise_lags(order), noise_lags(order) + 1);
    let rows = record.count_rows(lags, outputs) as f64;
    if rows > (1.0 + WORTHWHILE_ROWS) * moments.rows() as f64 {
        Moments::of_record(record, lags, outputs)
    } else {
        moments.truncated(lags, outputs)
    }
}
