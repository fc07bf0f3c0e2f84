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
#[derive(Clone)]
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
        let start = choice.ar.clone();
        let plan = Self::new(choice.settling, start, moments, options)?;
        let basis = match (choice.frequencies, options.frequencies) {
            (Some(frequencies), Frequencies::Auto) => FsfBasis::new(choice.settling, frequencies)?,
            _ => plan.basis,
        };
        Ok(Self {
            basis,
            selected_by: match options.frequencies {
                Frequencies::Auto => SelectedBy::Auto,
                _ => plan.selected_by,
            },
            choice: Some(choice),
            ..plan
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
        Self::new(settling, start, moments, options)
    }

    /// The bank for a settling time and D to start from.
    fn new(
        settling: usize,
        start: Vec<f64>,
        moments: &Moments,
        options: &Options,
    ) -> Result<Self, Error> {
        let given = |frequencies| -> Result<Self, Error> {
            Ok(Self {
                basis: FsfBasis::new(settling, frequencies)?,
                selected_by: SelectedBy::User,
                roll_off: FIRST_ORDER,
                order: options.noise_order,
                start: start.clone(),
                choice: None,
                banks: Vec::new(),
            })
        };
        if let Frequencies::Count(frequencies) = options.frequencies {
            return given(frequencies);
        }
        let full = FsfBasis::full(settling)?.frequencies();
        let scan = NestedBanks::scan(moments, settling, &start, FIRST_ORDER)
            .ok_or(Error::nothing_excited(settling))?;
        let banks = scan.candidates().to_vec();
        if options.frequencies == Frequencies::Narrow {
            let narrow = 2 * scan.best_predictor() + 1;
            return Ok(Self {
                selected_by: SelectedBy::Narrow,
                roll_off: SECOND_ORDER,
                banks,
                ..given(narrow.min(full).min(scan.excited()))?
            });
        }
        let frequencies = match is_wide(&scan, settling) {
            true => scan.narrowest().frequencies,
            false => full,
        };
        Ok(Self {
            banks,
            ..given(frequencies)?
        })
    }

    /// The same choice, carried out with another bank and another order of the noise.
    pub(super) fn with(&self, basis: FsfBasis, order: NoiseOrder) -> Self {
        Self {
            basis,
            order,
            start: Vec::new(),
            choice: self.choice.clone(),
            banks: self.banks.clone(),
            ..*self
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
