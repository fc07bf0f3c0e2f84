//! A structure to be fitted, with the moments that it needs.

use super::plan::{Plan, check_rows};
use super::task::Task;
use crate::data::{Moments, Record, References};
use crate::diagnostics::INPUT_LAGS;
use crate::error::Error;
use crate::estimation::FsfBasis;
use crate::options::{NoiseOrder, Options, Settling};
use crate::selection::{Choice, Search, choose_settling, longest_settling, odd_at_most};

/// Share of rows that must be gained to make another pass over the data worth while.
const WORTHWHILE_ROWS: f64 = 0.01;

/// A plan and its data.
#[derive(Clone)]
pub(super) struct Candidate {
    pub(super) plan: Plan,
    /// With the lags of the plan.
    pub(super) moments: Moments,
    /// With further lags, for the test of independence.
    pub(super) extended: Moments,
}

impl Candidate {
    /// By the options, from a record.
    pub(super) fn of_record(record: &Record, options: &Options) -> Result<Self, Error> {
        let candidate = match options.settling {
            Settling::Samples(settling) => Self::for_settling(record, settling, options),
            Settling::Auto => Self::with_chosen_settling(record, options, 1.0),
        }?;
        candidate.checked()
    }

    /// With N of at most `longest`, chosen from errors that come again in each run of one reference.
    pub(super) fn of_repeated_errors(
        record: &Record,
        longest: usize,
        options: &Options,
    ) -> Result<Self, Error> {
        let options = Options {
            longest_settling: Some(odd_at_most(longest)),
            ..*options
        };
        let repeats = References::repeats(record.runs().iter());
        Self::with_chosen_settling(record, &options, repeats)?.checked()
    }

    pub(super) fn for_settling(
        record: &Record,
        settling: usize,
        options: &Options,
    ) -> Result<Self, Error> {
        let lags = options.noise_order.highest();
        let extended = Moments::of_record(record, settling + lags + INPUT_LAGS, lags + 1);
        let moments = extended.with_fewer_lags(record, settling + lags);
        Ok(Self {
            plan: Plan::for_settling(settling, &moments, options)?,
            moments,
            extended,
        })
    }

    fn with_chosen_settling(
        record: &Record,
        options: &Options,
        repeats: f64,
    ) -> Result<Self, Error> {
        let order = options.noise_order;
        let longest = longest_settling(record, options.longest_settling)?;
        let lags = order.highest();
        let long = Moments::of_record(record, longest + lags, lags + 1);
        let choice = choose_settling(&Search {
            moments: &long,
            record: Some(record),
            longest,
            order,
            repeats,
        })?;
        let moments = with_all_rows(record, &long, choice.settling + lags);
        let beyond = choice.settling + lags + INPUT_LAGS;
        let extended = if beyond <= long.input_lags() {
            long.truncated(beyond, long.output_lags())
        } else {
            Moments::of_record(record, beyond, long.output_lags())
        };
        Ok(Self {
            plan: Plan::of_choice(choice, &moments, options)?,
            moments,
            extended,
        })
    }

    /// By the options, from moments that came without their record.
    pub(super) fn of_moments(moments: &Moments, options: &Options) -> Result<Self, Error> {
        let noise = options.noise_order.highest().min(moments.output_lags() - 1);
        let available = moments.input_lags().saturating_sub(noise);
        let plan = match options.settling {
            Settling::Auto => {
                let longest = odd_at_most(available);
                let choice = choose_settling(&Search {
                    moments,
                    record: None,
                    longest: longest.min(options.longest_settling.unwrap_or(longest)),
                    order: options.noise_order,
                    repeats: 1.0,
                })?;
                Plan::of_choice(choice, moments, options)?
            }
            Settling::Samples(settling) if settling > available => {
                return Err(Error::TooFewLags {
                    lags: moments.input_lags(),
                    needed: settling + noise,
                });
            }
            Settling::Samples(settling) => Plan::for_settling(settling, moments, options)?,
        };
        let candidate = Self {
            plan,
            moments: moments.clone(),
            extended: moments.clone(),
        };
        candidate.checked()
    }

    fn checked(self) -> Result<Self, Error> {
        check_rows(&self.moments, self.plan.basis.frequencies())?;
        Ok(self)
    }

    /// Until when a response moves that answers the steps before, too \[samples\].
    pub(super) fn moved_until(&self) -> Option<usize> {
        self.plan.choice.as_ref()?.moved_until
    }

    /// As one whose N is limited to the usual hold; `None` where no N up to it was acceptable, unless the response is known to rest
    /// by then. A response of more lags may have `moved_until` later.
    pub(super) fn within_holds(self, rests: bool, moved_until: Option<usize>) -> Option<Self> {
        let choice = (self.plan.choice).filter(|choice| choice.settled || rests)?;
        let choice = Some(Choice {
            within_holds: true,
            moved_until,
            settled: true,
            ..choice
        });
        let plan = Plan {
            choice,
            ..self.plan
        };
        Some(Self { plan, ..self })
    }

    /// The same choice with another bank and another order of the noise.
    pub(super) fn with(&self, task: &Task<'_>, basis: FsfBasis, order: NoiseOrder) -> Self {
        let of_record = |beyond: usize| {
            let lags = order.highest();
            let collect =
                |record| Moments::of_record(record, basis.settling() + lags + beyond, lags + 1);
            task.record.map(collect)
        };
        Self {
            plan: self.plan.with(basis, order),
            moments: of_record(0).unwrap_or_else(|| self.moments.clone()),
            extended: of_record(INPUT_LAGS).unwrap_or_else(|| self.extended.clone()),
        }
    }
}

/// The moments of `lags`: over more rows than the choice could use, if that is worth another pass.
fn with_all_rows(record: &Record, long: &Moments, lags: usize) -> Moments {
    let outputs = long.output_lags();
    let rows = record.count_rows(lags, outputs) as f64;
    if rows > (1.0 + WORTHWHILE_ROWS) * long.rows() as f64 {
        Moments::of_record(record, lags, outputs)
    } else {
        long.truncated(lags, outputs)
    }
}
