//! Plain and generalised least squares beside each other.

use super::evidence::MisfitEvidence;
use crate::data::Moments;
use crate::diagnostics::linearity::Linearity;
use crate::diagnostics::residuals::simulation_error::square;
use crate::estimation::{
    Coordinates, FIRST_ORDER, FsfBasis, GlsFit, GlsOptions, NestedBanks, RowInformation,
    complete_bank_rss,
};
use crate::options::NoiseOrder;
use crate::results::fit_percent;
use crate::selection::is_wide;
use crate::thresholds::{FOLLOWED, STEPS_FOLLOWED, UNEXPLAINED_PERCENT, WHITENING_COST_POINTS};

/// The lowest frequency at which an input that lacks high ones does not determine the response \[Hz\].
pub(crate) fn unexcited_above_hz(moments: &Moments, coordinates: &Coordinates) -> Option<f64> {
    let settling = coordinates.basis.settling();
    let banks = NestedBanks::scan(moments, settling, &[], FIRST_ORDER)?;
    let excited = banks.narrowest().frequencies / 2;
    is_wide(&banks, settling)
        .then(|| (excited + 1) as f64 / (settling as f64 * moments.sample_period_s()))
}

/// Simulation fits of plain and of generalised least squares with one bank \[%\].
pub(crate) struct BothEstimators {
    pub(crate) least_squares_percent: f64,
    pub(crate) generalised_percent: f64,
    /// The bank with which plain least squares fits best, at the same N.
    pub(crate) plain_basis: FsfBasis,
}

impl BothEstimators {
    /// Of the bank of `generalised`, `None` when the rows do not determine it. Plain least squares may bring
    /// a bank of its own, because whitening that has gone astray also misjudges how many frequencies are
    /// excited. That is tried where the errors are known to be `suspect`, or where it is not obvious that no
    /// bank can be much better.
    pub(crate) fn new(
        information: &RowInformation,
        generalised: &GlsFit,
        suspect: bool,
    ) -> Option<Self> {
        let (moments, coordinates) = (&information.moments, &generalised.coordinates);
        let (basis, spread) = (coordinates.basis, moments.output_spread());
        let percent = |fit: &GlsFit| fit_percent(square(information, fit), spread);
        let plain_fit = GlsFit::of(information, coordinates, &plain())?;
        let mut both = Self {
            least_squares_percent: percent(&plain_fit),
            generalised_percent: percent(generalised),
            plain_basis: basis,
        };
        if basis.is_complete() || !(suspect || both.may_be_beaten(moments, basis.settling())) {
            return Some(both);
        }
        let own_bank = NestedBanks::scan(moments, basis.settling(), &[], FIRST_ORDER)
            .map(|banks| banks.best_predictor())
            .filter(|frequencies| *frequencies != basis.frequencies())
            .and_then(|own| FsfBasis::new(basis.settling(), own).ok());
        if let Some(own) = own_bank
            && let Some(fit) = GlsFit::of(information, &Coordinates::new(own), &plain())
        {
            let own_percent = percent(&fit);
            if own_percent > both.least_squares_percent {
                (both.least_squares_percent, both.plain_basis) = (own_percent, own);
            }
        }
        Some(both)
    }

    /// Whether any response of so many samples might simulate better by more than is tolerated.
    fn may_be_beaten(&self, moments: &Moments, settling: usize) -> bool {
        complete_bank_rss(moments, settling).is_none_or(|left| {
            fit_percent(left, moments.output_spread()) - self.generalised_percent
                > WHITENING_COST_POINTS
        })
    }

    /// The evidence that errors are not noise, if there is any. `linearity` is the result of that test, and
    /// `followed` gives the share of the steps of the input that are held until the servo has followed.
    pub(crate) fn evidence(
        &self,
        linearity: Option<Linearity>,
        followed: impl FnOnce() -> f64,
    ) -> Option<MisfitEvidence> {
        let unexplained = 100.0 - self.least_squares_percent.max(self.generalised_percent);
        let much = unexplained > UNEXPLAINED_PERCENT;
        let runs = linearity
            .and_then(|found| found.between_runs())
            .filter(|_| much);
        // Where the runs' differences are most of what is left, nothing else is the reason.
        if let Some(runs) = runs
            && 2.0 * runs.misfit_percent.powi(2) > unexplained.powi(2)
        {
            return Some(MisfitEvidence::Runs(runs));
        }
        if self.least_squares_percent - self.generalised_percent > WHITENING_COST_POINTS {
            return Some(MisfitEvidence::Whitening);
        }
        let found = linearity.filter(Linearity::errors_follow_motion);
        if much {
            return found
                .map(MisfitEvidence::Misfit)
                .or(runs.map(MisfitEvidence::Runs));
        }
        let found = found.filter(Linearity::is_rejected)?;
        let followed = followed();
        (followed < STEPS_FOLLOWED).then_some(MisfitEvidence::NoSteps(found, followed))
    }
}

/// Samples that the step response `step` takes until it stays beyond [`FOLLOWED`] of its final value.
pub(crate) fn followed_after(step: &[f64]) -> usize {
    let last = step.last().copied().unwrap_or(0.0);
    // Not the first time: a response that makes no sense may begin there.
    step.iter()
        .rposition(|g| g / last < FOLLOWED)
        .map_or(0, |below| below + 1)
}

/// Plain least squares: the noise is not modelled.
pub(super) fn plain() -> GlsOptions {
    GlsOptions {
        order: NoiseOrder::Order(0),
        corrected: false,
        ..GlsOptions::default()
    }
}
