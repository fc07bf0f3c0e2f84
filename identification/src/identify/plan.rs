//! The structure that an identification goes by: N, n, d, and how they were chosen.

use crate::data::Moments;
use crate::error::Error;
use crate::estimation::{
    BankCandidate, Coordinates, FIRST_ORDER, FsfBasis, GlsFit, GlsOptions, NestedBanks,
    RowInformation, SECOND_ORDER,
};
use crate::options::{Frequencies, NoiseOrder, Options};
use crate::results::SelectedBy;
use crate::selection::{Choice, is_wide};

/// A decided structure. Gates that want another one make another plan.
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
        let bank = Bank::new(choice.settling, moments, options, &choice.ar)?;
        let basis = match (choice.frequencies, options.frequencies) {
            (Some(frequencies), Frequencies::Auto) => FsfBasis::new(choice.settling, frequencies)?,
            _ => bank.basis,
        };
        let selected_by = match options.frequencies {
            Frequencies::Auto => SelectedBy::Auto,
            Frequencies::Narrow => SelectedBy::Narrow,
            Frequencies::Count(_) => SelectedBy::User,
        };
        Ok(Self {
            basis,
            selected_by,
            roll_off: bank.roll_off,
            order: options.noise_order,
            start: choice.ar.clone(),
            choice: Some(choice),
            banks: bank.considered,
        })
    }

    /// The plan for a given settling time.
    pub(super) fn for_settling(
        settling: usize,
        moments: &Moments,
        options: &Options,
    ) -> Result<Self, Error> {
        check_rows(moments, 1)?;
        let start = match options.frequencies {
            Frequencies::Count(_) => Vec::new(),
            _ => rough_noise(FsfBasis::full(settling)?, moments, options.noise_order),
        };
        let bank = Bank::new(settling, moments, options, &start)?;
        Ok(Self {
            basis: bank.basis,
            selected_by: match options.frequencies {
                Frequencies::Narrow => SelectedBy::Narrow,
                _ => SelectedBy::User,
            },
            roll_off: bank.roll_off,
            order: options.noise_order,
            start,
            choice: None,
            banks: bank.considered,
        })
    }

    /// The same choice, carried out with another bank and another order of the noise.
    pub(super) fn with(&self, basis: FsfBasis, order: NoiseOrder) -> Self {
        Self {
            basis,
            order,
            start: Vec::new(),
            selected_by: self.selected_by,
            roll_off: self.roll_off,
            choice: self.choice.clone(),
            banks: self.banks.clone(),
        }
    }
}

/// D of a fit of few passes, to choose n by.
fn rough_noise(basis: FsfBasis, moments: &Moments, order: NoiseOrder) -> Vec<f64> {
    let rough = GlsOptions {
        order,
        tolerance: 1e-2,
        max_iterations: 4,
        corrected: false,
        start: Vec::new(),
    };
    let information = RowInformation::from_moments(moments.clone());
    GlsFit::of(&information, &Coordinates::new(basis), &rough).map_or_else(Vec::new, |fit| fit.ar)
}

/// The bank for a settling time.
struct Bank {
    basis: FsfBasis,
    roll_off: i32,
    /// None where n is given.
    considered: Vec<BankCandidate>,
}

impl Bank {
    fn new(
        settling: usize,
        moments: &Moments,
        options: &Options,
        ar: &[f64],
    ) -> Result<Self, Error> {
        let full = FsfBasis::full(settling)?;
        if let Frequencies::Count(frequencies) = options.frequencies {
            return Ok(Self {
                basis: FsfBasis::new(settling, frequencies)?,
                roll_off: FIRST_ORDER,
                considered: Vec::new(),
            });
        }
        let scan =
            NestedBanks::scan(moments, settling, ar, FIRST_ORDER).ok_or(Error::NotExcited {
                asked: settling,
                excited: 1,
                highest_hz: 0.0,
            })?;
        let (frequencies, roll_off) = if options.frequencies == Frequencies::Narrow {
            let largest = full.frequencies().min(scan.excited());
            let narrow = 2 * scan.best_predictor() + 1;
            (narrow.min(largest), SECOND_ORDER)
        } else if is_wide(&scan, settling) {
            (scan.narrowest().frequencies, FIRST_ORDER)
        } else {
            (full.frequencies(), FIRST_ORDER)
        };
        Ok(Self {
            basis: FsfBasis::new(settling, frequencies)?,
            roll_off,
            considered: scan.candidates().to_vec(),
        })
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
