//! When the errors are not noise.
//!
//! Generalised least squares is the better estimator when what the model cannot explain is noise. On
//! a mechanism that the model cannot represent (flexible, nonlinear, longer than N), the misfit is a
//! function of the input; whitening then takes weight away from where the response lives, and the
//! result can simulate far worse than plain least squares. Both cost nothing from the moments, so
//! both are made; when generalised least squares simulates worse by more than [`TOLERATED`], the
//! label of the bounds is withdrawn, and settling time, frequencies and estimator are chosen by
//! how well they predict parts of the record that they have not seen.
//!
//! A servo that is not linear need not show in that figure: its misfit can be spread over all
//! frequencies alike. Where [`crate::diagnostics::linearity`] finds one, and the simulation leaves more than
//! [`UNEXPLAINED`] of the motion, the same is done; and also where fewer than [`SEEN`] of the steps of
//! the input are held until the servo has all but followed: how a servo that is not linear answers a
//! step can be seen, but not computed from how it answers something else.

mod ranking;

pub(crate) use ranking::{rank, settlings};

use serde::{Deserialize, Serialize};

use crate::data::moments::Moments;
use crate::data::record::Record;
use crate::diagnostics::linearity::{BetweenRuns, Linearity};
use crate::estimation::fsf_basis::FsfBasis;
use crate::estimation::gls::{self, GlsOptions};
use crate::estimation::least_squares::{Coordinates, RowInformation, complete_bank_rss};
use crate::estimation::nested_banks::NestedBanks;
use crate::estimation::truncation::FIRST_ORDER;
use crate::options::NoiseOrder;
use crate::results::validation::fit_percent;
use crate::selection::settling_time;

/// Points of fit that whitening may cost while the errors count as noise: on servos that the model
/// can represent it costs less than a tenth of one.
pub const TOLERATED: f64 = 1.0;

/// Percent of the motion (rms) that the simulation of a servo that is not linear may leave before its
/// bounds lose their level.
///
/// Measured on simulated servos with play, a limited current and unequal ends: references of steps
/// that are held leave 1 to 12 % of strokes of up to 5 degrees, and their gains agree; random steps of
/// 20 to 60 ms, sweeps and sums of sines leave 10 to 57 %, with gains that are wrong by up to 45 % and
/// delays by up to 24 ms.
pub const UNEXPLAINED: f64 = 15.0;

/// Share of the steps of the input that must be held until the response to them has come to
/// [`FOLLOWED`] of its final value.
pub const SEEN: f64 = 0.75;

/// Share of the final value beyond which a step has been followed.
pub const FOLLOWED: f64 = 0.9;

/// Difference between the step responses of the two estimators, as a share of the largest value,
/// beyond which neither's figures are findings.
pub const DISAGREEMENT: f64 = 0.1;

/// An estimator and how it predicts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Prediction {
    /// N \[samples\].
    pub settling: usize,
    /// n.
    pub frequencies: usize,
    /// Whether the noise is modelled; otherwise plain least squares.
    pub generalised: bool,
    /// Fit of simulations of the parts left out \[%\].
    pub cross_validated_percent: f64,
}

/// What was found about errors that are not noise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelErrors {
    /// Simulation fit of plain least squares \[%\].
    pub least_squares_percent: f64,
    /// Simulation fit of generalised least squares \[%\].
    pub generalised_percent: f64,
    /// What was tried and predicts parts not seen better than their mean does, best first; the first
    /// was taken. Without any, the estimator that simulates the record better.
    pub candidates: Vec<Prediction>,
    /// Step response of the estimator that was not taken, at the same N and n.
    pub other_step: Vec<f64>,
    /// The lowest frequency of which the input does not tell the response \[Hz\], when it lacks high
    /// ones.
    #[serde(default)]
    pub unexcited_above_hz: Option<f64>,
    /// What told it.
    #[serde(default)]
    pub sign: MisfitEvidence,
}

/// The sign by which errors were told from noise.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MisfitEvidence {
    /// Generalised least squares simulates worse than plain least squares.
    #[default]
    Whitening,
    /// The errors follow the motion, and the simulation leaves much of the motion unexplained.
    Misfit(Linearity),
    /// So it does, and the runs differ from each other by more than their noise: a model of all of them is
    /// one of none.
    Runs(BetweenRuns),
    /// The servo is not linear, and only this share of the steps of the input are held until it has
    /// followed.
    NoSteps(Linearity, f64),
}

impl ModelErrors {
    /// What simulation by the better of the two estimators leaves of the motion \[% rms\].
    #[must_use]
    pub fn unexplained_percent(&self) -> f64 {
        unexplained_percent(self.least_squares_percent, self.generalised_percent)
    }

    /// Largest difference between the step responses of the two estimators, as a share of the
    /// largest value of `taken`. Infinite when there is no other.
    #[must_use]
    pub fn disagreement(&self, taken: &[f64]) -> f64 {
        let largest = taken.iter().fold(0.0f64, |a, g| a.max(g.abs()));
        let apart = taken
            .iter()
            .zip(&self.other_step)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        if self.other_step.len() == taken.len() && largest > 0.0 {
            apart / largest
        } else {
            f64::INFINITY
        }
    }
}

/// The lowest frequency of which an input without high ones does not tell the response \[Hz\].
pub(crate) fn unexcited_above_hz(moments: &Moments, coordinates: &Coordinates) -> Option<f64> {
    let settling = coordinates.basis.settling();
    let banks = NestedBanks::scan(moments, settling, &[], FIRST_ORDER)?;
    let told = banks.narrowest().frequencies / 2;
    settling_time::is_low_passed(&banks, settling)
        .then(|| (told + 1) as f64 / (settling as f64 * moments.sample_period_s()))
}

/// Simulation fits of plain and of generalised least squares with one bank \[%\].
pub(crate) struct BothEstimators {
    pub(crate) least_squares_percent: f64,
    pub(crate) generalised_percent: f64,
}

impl BothEstimators {
    /// Of the bank of `generalised`, `None` when the rows do not determine it. Plain least squares may bring
    /// a bank of its own, because whitening that has gone astray also misjudges how many frequencies can be
    /// told; that is looked for where the errors are known to be `suspect`, or where no bank being much
    /// better cannot be seen at once.
    pub(crate) fn new(
        information: &RowInformation,
        generalised: &gls::GlsFit,
        suspect: bool,
    ) -> Option<Self> {
        let (moments, coordinates) = (&information.moments, &generalised.coordinates);
        let (basis, spread) = (coordinates.basis, moments.output_spread());
        let percent = |fit: &gls::GlsFit| fit_percent(simulation_error(information, fit), spread);
        let plain_fit = gls::fit(information, coordinates, &plain())?;
        let mut both = Self {
            least_squares_percent: percent(&plain_fit),
            generalised_percent: percent(generalised),
        };
        if basis.is_complete() || !(suspect || both.may_be_beaten(moments, basis.settling())) {
            return Some(both);
        }
        let own_bank = NestedBanks::scan(moments, basis.settling(), &[], FIRST_ORDER)
            .map(|banks| banks.best_predictor())
            .filter(|frequencies| *frequencies != basis.frequencies())
            .and_then(|own| FsfBasis::new(basis.settling(), own).ok());
        if let Some(own) = own_bank
            && let Some(fit) = gls::fit(information, &Coordinates::new(own), &plain())
        {
            both.least_squares_percent = both.least_squares_percent.max(percent(&fit));
        }
        Some(both)
    }

    /// Whether any response of so many samples might simulate better by more than is tolerated.
    fn may_be_beaten(&self, moments: &Moments, settling: usize) -> bool {
        complete_bank_rss(moments, settling).is_none_or(|left| {
            fit_percent(left, moments.output_spread()) - self.generalised_percent > TOLERATED
        })
    }

    /// The sign that errors are not noise, if there is one. `linearity` is what that test found, and
    /// `seen` gives the [share of steps](share_seen) that the record shows.
    pub(crate) fn sign(
        &self,
        linearity: Option<Linearity>,
        seen: impl FnOnce() -> f64,
    ) -> Option<MisfitEvidence> {
        let unexplained = unexplained_percent(self.least_squares_percent, self.generalised_percent);
        let runs = linearity
            .and_then(|found| found.between_runs())
            .filter(|_| unexplained > UNEXPLAINED);
        // Where most of what is left is what runs differ by, nothing else is the reason.
        if let Some(runs) = runs
            && 2.0 * runs.misfit_percent.powi(2) > unexplained.powi(2)
        {
            return Some(MisfitEvidence::Runs(runs));
        }
        if self.least_squares_percent - self.generalised_percent > TOLERATED {
            return Some(MisfitEvidence::Whitening);
        }
        let linearity = linearity?;
        let found = Some(linearity).filter(Linearity::errors_follow_motion);
        if unexplained > UNEXPLAINED {
            return found
                .map(MisfitEvidence::Misfit)
                .or(runs.map(MisfitEvidence::Runs));
        }
        let found = found?;
        if !found.is_rejected() {
            return None;
        }
        let seen = seen();
        (seen < SEEN).then_some(MisfitEvidence::NoSteps(found, seen))
    }
}

fn unexplained_percent(least_squares_percent: f64, generalised_percent: f64) -> f64 {
    100.0 - least_squares_percent.max(generalised_percent)
}

/// What the input may move by while it counts as standing still, as a share of its range: more than
/// the noise of an input that was measured, less than a step.
const STILL: f64 = 0.02;

/// For how long the input stood still after each of its changes, and at the beginning of each run
/// \[samples\].
fn stands(record: &Record) -> Vec<usize> {
    let present = || record.runs().iter().flat_map(|run| run.input()).copied();
    let low = present().fold(f64::INFINITY, f64::min);
    let high = present().fold(f64::NEG_INFINITY, f64::max);
    let tolerance = STILL * (high - low);
    let mut lengths = Vec::new();
    for run in record.runs() {
        let mut level = f64::NAN;
        for &u in run.input() {
            match lengths.last_mut() {
                Some(length) if (u - level).abs() <= tolerance => *length += 1,
                _ => {
                    level = u;
                    lengths.push(1);
                }
            }
        }
    }
    lengths
}

/// The time for which the input usually stands still between changes: the median \[samples\].
pub(crate) fn usual_hold(record: &Record) -> usize {
    let mut lengths = stands(record);
    lengths.sort_unstable();
    lengths.get(lengths.len() / 2).copied().unwrap_or(0)
}

/// Share of the changes of the input after which it stands still for as long as the step response
/// `step` takes until it stays beyond [`FOLLOWED`] of its final value.
pub(crate) fn share_seen(record: &Record, step: &[f64]) -> f64 {
    let last = step.last().copied().unwrap_or(0.0);
    // Not the first time: a response that makes no sense may begin there.
    let followed = step
        .iter()
        .rposition(|g| g / last < FOLLOWED)
        .map_or(0, |below| below + 1);
    let lengths = stands(record);
    let seen = lengths.iter().filter(|length| **length >= followed).count();
    seen as f64 / lengths.len().max(1) as f64
}

fn plain() -> GlsOptions {
    GlsOptions {
        order: NoiseOrder::Order(0),
        corrected: false,
        ..GlsOptions::default()
    }
}

/// Sum of squares of the simulation error.
fn simulation_error(information: &RowInformation, fit: &gls::GlsFit) -> f64 {
    information.residual_moments(&fit.impulse(), fit.solution.offset(), 0)[(0, 0)].max(0.0)
}
