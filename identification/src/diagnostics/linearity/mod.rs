//! Whether the residuals are a function of the simulated motion.
//!
//! The residuals of a linear servo are noise, which is independent of the input. Those of a servo with limited
//! speed, play or unequal ends follow the motion, and a flexible noise model explains them one step
//! ahead: whiteness and independence of further *lags* of the input may pass although the bounds are far too
//! narrow. So functions of the simulated output s and its speed v that no linear model has are added to the
//! regression,
//!
//! ```text
//! D(z) (y - ŷ)(k) = D(z) Σ_j γ_j z_j(k) + ε(k),    z = s², s³, v |v|, |v|, s |v|, a,
//! ```
//!
//! a being the model's answer to the direction of the last change of the command, as friction and play make it,
//! together with all the parameters of the model (Ramsey's RESET, 1969). Because the z_j depend on the data
//! through the fitted response alone, which is independent of the residuals, the usual F statistic of γ = 0 has
//! its F distribution for any z (Milliken & Graybill 1970), given D.
//!
//! Noise that grows with the motion makes large errors where the z_j are large. What is large in parts of the record only must therefore be beyond chance in noise of
//! which each error has its own variance as well (White, 1980).
//!
//! Runs of one servo differ, because its supply and its clock do. A gain, a delay and an offset of each run are no
//! evidence of a servo that is not linear. So where there are several runs, D(z) s, D(z) v and D(z) 1 of each run
//! are regressors as well.
//!
//! A bank that leaves out frequencies leaves their share of the motion in the residuals, where no function of
//! lags separates it. There a small p shows that the errors are not noise, but not the reason
//! ([`Linearity::complete`]).
//!
//! Significance is not size: in a long record anything is significant. [`Linearity::misfit_percent`]
//! is the part of the motion that γ explains and no linear model of this settling time could, over all of the record;
//! [`Linearity::local_percent`] is how large that is where it is, which is what a band of the step response may miss.

mod limited_speed;
mod reset_test;

use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use crate::diagnostics::linearity::limited_speed::limited_speed;
use crate::diagnostics::linearity::reset_test::{ResetTest, RunRows, slower_speed_over};
use crate::diagnostics::noise::standstill_noise::StandstillNoise;
use crate::diagnostics::residuals::simulation_error::{Simulated, explained_by_runs, square};
use crate::estimation::{GlsFit, RowInformation};
use crate::thresholds::{MATERIAL_MISFIT_PERCENT, MISFIT_SIGNIFICANCE, UNEXPLAINED_PERCENT};

/// Result of the test.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Linearity {
    /// Probability of a relation to functions of the motion at least as strong if the servo is
    /// linear.
    pub p: f64,
    /// Root mean square of the part that these functions explain and no linear model does, relative to that of
    /// the output about its mean \[%\]. Noise alone makes it about sqrt(6/rows) times the noise.
    pub misfit_percent: f64,
    /// The same root mean square over the rows weighted by the square of that part: how large it is where it is. A stroke may be wrong by
    /// several percent for a tenth of the time.
    #[serde(default)]
    pub local_percent: f64,
    /// The same probability in noise of which each sample has its own variance. Noise is larger in motion as well, so this is the one that
    /// counts for what is large in parts only.
    #[serde(default = "certain")]
    pub local_p: f64,
    /// Whether the model has all frequencies, so that residuals that follow the motion cannot come from those
    /// left out.
    pub complete: bool,
    /// What the steps of the sensor explain at most, relative to the output about its mean \[% rms\]: they are a function of the position,
    /// too.
    #[serde(default)]
    pub of_steps_percent: f64,
    /// By how much runs differ from each other; `None` with a single one.
    #[serde(default)]
    pub runs: Option<BetweenRuns>,
    /// The errors against the noise at standstill; `None` where no standstill was recorded, or where the
    /// response may be longer than N, which leaves errors of its own.
    #[serde(default)]
    pub rest: Option<StandstillNoise>,
}

/// Residuals of the runs of one servo that come from a gain, a delay and an offset of each run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BetweenRuns {
    /// Probability of differences at least as large from noise alone.
    pub p: f64,
    /// Root mean square of the part of the errors that they explain, relative to that of the output about its
    /// mean \[%\].
    pub misfit_percent: f64,
}

fn certain() -> f64 {
    1.0
}

impl Linearity {
    /// Whether errors are shown to follow the motion, by an amount that matters.
    #[must_use]
    pub fn errors_follow_motion(&self) -> bool {
        self.by_functions() || self.against_rest().is_some()
    }

    /// Whether functions of the motion explain errors, by an amount that matters: over all rows, or where they are.
    #[must_use]
    pub fn by_functions(&self) -> bool {
        let matters = |percent: f64, p: f64| {
            p < MISFIT_SIGNIFICANCE && percent > MATERIAL_MISFIT_PERCENT + self.of_steps_percent
        };
        matters(self.misfit_percent, self.p) || matters(self.local_percent, self.local_p)
    }

    /// How much larger errors are in motion than at standstill, if that is shown, by an amount that matters.
    #[must_use]
    pub fn against_rest(&self) -> Option<StandstillNoise> {
        self.rest.filter(|rest| {
            rest.p < MISFIT_SIGNIFICANCE && rest.misfit_percent > MATERIAL_MISFIT_PERCENT
        })
    }

    /// How much runs differ, if that is shown, by an amount that matters.
    #[must_use]
    pub fn between_runs(&self) -> Option<BetweenRuns> {
        self.runs.filter(|runs| {
            runs.p < MISFIT_SIGNIFICANCE && runs.misfit_percent > MATERIAL_MISFIT_PERCENT
        })
    }

    /// Whether the servo is shown not to be linear, by an amount that matters.
    #[must_use]
    pub fn is_rejected(&self) -> bool {
        self.complete && self.errors_follow_motion()
    }
}

/// Tests the errors of `fit` in `runs`; `None` when there are too few rows. `level_error` is the largest error of a level that the steps of
/// the sensor leave \[output\].
///
/// The functions of the motion are offered with the speed from row to row, and with that over half of the response. The first is better under commands that change
/// before the servo has followed, the second in strong noise. Of two tests the smaller p counts, twice (Bonferroni). Where neither finds anything, though
/// the simulation leaves much of the motion, a limit of the speed is asked for in the errors before whitening.
#[must_use]
pub(crate) fn test_linearity(
    runs: &[Simulated<'_>],
    information: &RowInformation,
    fit: &GlsFit,
    level_error: f64,
) -> Option<Linearity> {
    let slower = slower_speed_over(&fit.coordinates.basis.step_response(&fit.theta()));
    let mut speeds = vec![1, slower];
    speeds.dedup();
    let tests = speeds.len() as f64;
    let rows = RunRows::all(runs, &information.moments, fit);
    let found = speeds
        .into_iter()
        .filter_map(|over| {
            let test = ResetTest::new(&rows, fit, over)?;
            result_of(&test, runs, information, fit, level_error)
        })
        .min_by(|a, b| a.p.total_cmp(&b.p))?;
    let found = Linearity {
        p: (tests * found.p).min(1.0),
        local_p: (tests * found.local_p).min(1.0),
        ..found
    };
    let spread = information.moments.output_spread();
    let much = square(information, fit) > (UNEXPLAINED_PERCENT / 100.0).powi(2) * spread;
    if !much || found.by_functions() {
        return Some(found);
    }
    let limited =
        limited_speed(runs, information, fit).filter(|limit| limit.p < MISFIT_SIGNIFICANCE);
    Some(limited.map_or(found, |limit| {
        let percent = 100.0 / (spread / information.rows() as f64).sqrt();
        Linearity {
            p: limit.p,
            misfit_percent: percent * limit.rms,
            local_percent: percent * limit.local,
            local_p: limit.p,
            ..found
        }
    }))
}

/// What the `test` of one speed gives.
fn result_of(
    test: &ResetTest<'_>,
    runs: &[Simulated<'_>],
    information: &RowInformation,
    fit: &GlsFit,
    level_error: f64,
) -> Option<Linearity> {
    let found = test.regress(fit)?;
    let (k, free) = (
        found.degrees as f64,
        fit.degrees_of_freedom() - found.of_runs as f64,
    );
    if free <= k || found.unexplained <= 0.0 {
        return None;
    }
    let noise = found.unexplained / (free - k);
    let upper_tail = |reduction: f64, degrees: f64| {
        let distribution = FisherSnedecor::new(degrees, free - k).ok()?;
        let tail = distribution.sf(reduction / degrees / noise);
        Some(tail.clamp(0.0, 1.0))
    };
    let misfit = test.misfit(fit, &found);
    let motion = (information.moments.output_spread() / information.rows() as f64).sqrt();
    let between_runs = |p: f64| BetweenRuns {
        p,
        misfit_percent: 100.0 * explained_by_runs(runs) / motion,
    };
    let p = upper_tail(found.reduction, k)?;
    // Most records end here, and the statistic costs a pass over the samples.
    let local_p = match p < MISFIT_SIGNIFICANCE {
        true => p.max(upper_tail(
            noise * test.statistic_in_uneven_noise(fit, &found),
            k,
        )?),
        false => p,
    };
    Some(Linearity {
        p,
        local_p,
        runs: (found.of_runs > 0)
            .then(|| upper_tail(found.reduction_of_runs, found.of_runs as f64))
            .flatten()
            .map(between_runs),
        misfit_percent: 100.0 * misfit.rms / motion,
        local_percent: 100.0 * misfit.local / motion,
        complete: fit.coordinates.basis.has_all_frequencies(),
        of_steps_percent: 100.0 * level_error / motion,
        rest: None,
    })
}

#[cfg(test)]
mod tests;
