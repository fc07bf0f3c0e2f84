//! The structure that an identification goes by: N, n, d, and how they were chosen.

use crate::data::moments::Moments;
use crate::error::Error;
use crate::estimation::fsf_basis::FsfBasis;
use crate::estimation::gls::{self, GlsOptions};
use crate::estimation::least_squares::{Coordinates, RowInformation};
use crate::estimation::nested_banks::{BankCandidate, NestedBanks};
use crate::estimation::truncation::{FIRST_ORDER, SECOND_ORDER};
use crate::options::{Frequencies, NoiseOrder, Options};
use crate::results::model::SelectedBy;
use crate::selection::settling_time::{self, Choice};

/// A decided structure.
pub(super) struct Plan {
    pub(super) basis: FsfBasis,
    pub(super) selected_by: SelectedBy,
    /// Roll-off assumed above the highest frequency.
    pub(super) roll_off: i32,
    pub(super) order: NoiseOrder,
    /// D to start from.
    pub(super) start: Vec<f64>,
    pub(super) choice: Option<Choice>,
    pub(super) banks: Vec<BankCandidate>,
}

impl Plan {
    /// The plan of an automatic choice of the settling time.
    pub(super) fn of_choice(
        choice: Choice,
        moments: &Moments,
        options: &Options,
    ) -> Result<Self, Error> {
        let mut plan = Self::for_frequencies(choice.settling, moments, options, &choice.ar)?;
        if let (Some(frequencies), Frequencies::Auto) = (choice.frequencies, options.frequencies) {
            plan.basis = FsfBasis::new(choice.settling, frequencies)?;
        }
        plan.selected_by = match options.frequencies {
            Frequencies::Auto => SelectedBy::Auto,
            Frequencies::Narrow => SelectedBy::Narrow,
            Frequencies::Count(_) => SelectedBy::User,
        };
        plan.choice = Some(choice);
        Ok(plan)
    }

    /// The plan for a given settling time.
    pub(super) fn for_settling(
        settling: usize,
        moments: &Moments,
        options: &Options,
    ) -> Result<Self, Error> {
        let needed = match options.frequencies {
            Frequencies::Count(frequencies) => FsfBasis::new(settling, frequencies)?.frequencies(),
            _ => 1,
        };
        check_rows(moments, needed)?;
        let coordinates = Coordinates::new(FsfBasis::full(settling)?);
        let start = match options.frequencies {
            Frequencies::Count(_) => Vec::new(),
            _ => {
                let information = RowInformation::from_moments(moments.clone());
                let rough = GlsOptions {
                    order: options.noise_order,
                    tolerance: 1e-2,
                    max_iterations: 4,
                    corrected: false,
                    start: Vec::new(),
                };
                gls::fit(&information, &coordinates, &rough).map_or_else(Vec::new, |fit| fit.ar)
            }
        };
        let mut plan = Self::for_frequencies(settling, moments, options, &start)?;
        plan.selected_by = match options.frequencies {
            Frequencies::Narrow => SelectedBy::Narrow,
            _ => SelectedBy::User,
        };
        Ok(plan)
    }

    /// n for a settling time, and D to start from.
    fn for_frequencies(
        settling: usize,
        moments: &Moments,
        options: &Options,
        ar: &[f64],
    ) -> Result<Self, Error> {
        let mut plan = Self {
            basis: FsfBasis::full(settling)?,
            selected_by: SelectedBy::User,
            roll_off: FIRST_ORDER,
            order: options.noise_order,
            start: ar.to_vec(),
            choice: None,
            banks: Vec::new(),
        };
        if let Frequencies::Count(frequencies) = options.frequencies {
            plan.basis = FsfBasis::new(settling, frequencies)?;
            return Ok(plan);
        }
        let Some(scan) = NestedBanks::scan(moments, settling, ar, FIRST_ORDER) else {
            return Err(Error::NotExcited {
                asked: settling,
                excited: 1,
                highest_hz: 0.0,
            });
        };
        plan.banks = scan.candidates().to_vec();
        if options.frequencies == Frequencies::Narrow {
            let narrow = 2 * scan.best_predictor() + 1;
            let largest = plan.basis.frequencies().min(scan.excited());
            plan.basis = FsfBasis::new(settling, narrow.min(largest))?;
            plan.roll_off = SECOND_ORDER;
        } else if settling_time::is_low_passed(&scan, settling) {
            plan.basis = FsfBasis::new(settling, scan.narrowest().frequencies)?;
        }
        Ok(plan)
    }
}

/// At least two rows for each parameter: with fewer, the residuals say little about the noise.
pub(super) fn check_rows(moments: &Moments, parameters: usize) -> Result<(), Error> {
    let needed = 2 * (parameters + 1) + moments.output_lags();
    if moments.rows() < needed {
        return Err(Error::TooFewSamples {
            usable: moments.rows(),
            history: moments.input_lags(),
            parameters: parameters + 1,
            needed,
        });
    }
    Ok(())
}
