//! Levels that the servo takes a little too high or too low.
//!
//! A command that was rounded where it was written, friction, and a sensor whose scale is not even let the servo rest off each level by a δ of
//! its own, as if the command had been off:
//!
//! ```text
//! y = Σ_c δ_c x_c + ...,     x_c = G(z) (1 from the beginning of hold c to its end, 0 elsewhere),     ε = Σ_c δ_c D(z) x_c + independent errors.
//! ```
//!
//! Errors one step ahead are then not independent within a hold, and where a level is off by the same at each visit, not from visit to visit either. What δ
//! [varies](crate::diagnostics::holds::clustered_errors) beyond chance, from visit to visit and from level to level, is in the covariance: A^-1 C C' A^-1 times this variance, C being the
//! cross moments of the rows with the D(z) x_c of each visit, or of all visits to a level.
//!
//! How far a level is off alike is one number, and a handful of them may show little of their variance. So it is that of rounding to the steps
//! that the levels are apart, where this is in keeping with what they show.

use super::clustered_errors::{Cluster, EffectScatter};
use super::held_run::HeldRun;
use super::level_answers::{CrossMoments, Visit, cluster_of, level_by_level, visits};
use crate::data::Moments;
use crate::estimation::{EstimatedPart, GlsFit};

/// The gain and the offset of the fit take the effects of two levels.
pub(super) const FITTED: f64 = 2.0;

/// Standard deviations by which levels are off \[input\].
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct OffLevels {
    /// Another time at each visit.
    pub(super) visits: f64,
    /// Alike at each visit.
    pub(super) levels: f64,
}

/// A difference of levels below this share of the largest is the rounding of arithmetic.
const ARITHMETIC: f64 = 1e-6;

/// Variance of what rounding has left out, where commands were rounded to the steps that `levels` are apart \[input²\]; 0 where they are exact.
pub(super) fn variance_of_rounding(runs: &[HeldRun<'_>], levels: &[f64]) -> f64 {
    if runs.iter().all(|held| held.run.run.has_exact_input()) {
        return 0.0;
    }
    let differences = || levels.iter().map(|level| (level - levels[0]).abs());
    let least = ARITHMETIC * differences().fold(0.0, f64::max);
    let step = differences().fold(0.0, |step, difference| {
        common_divisor(difference, step, least)
    });
    step * step / 12.0
}

/// Of which `a` and `b` are whole multiples, but for `least` (Euclid).
fn common_divisor(mut a: f64, mut b: f64, least: f64) -> f64 {
    while b > least {
        (a, b) = (b, (a - b * (a / b).round()).abs());
    }
    a
}

/// Adds to the covariance of `fit` how far levels of `runs` are off, where that is beyond chance. They are a share `seen` of the record.
pub(super) fn allow_for_level_scatter(
    runs: &[HeldRun<'_>],
    moments: &Moments,
    seen: f64,
    fit: &mut GlsFit,
) -> Option<OffLevels> {
    let visits = visits(runs, fit);
    let of_visits: Vec<Cluster> = visits.iter().map(|visit| visit.errors).collect();
    let all = EffectScatter::of(&of_visits, FITTED)?;
    let levels: Vec<&[Visit]> = visits
        .chunk_by(|a, b| a.hold.level == b.hold.level)
        .collect();
    let of_levels: Vec<Cluster> = levels.iter().map(|visits| cluster_of(visits)).collect();
    let commands: Vec<f64> = (levels.iter()).map(|visits| visits[0].hold.level).collect();
    let alike = EffectScatter::of(&of_levels, FITTED)
        .map(|found| found.or_of_cause(variance_of_rounding(runs, &commands)));
    let each = all.without(alike.map_or(0.0, |found| found.variance));
    let of_each = CrossMoments::new(runs, moments, fit).of(&visits);
    let of_alike = alike.map(|found| {
        let cross = level_by_level(&of_each, &levels);
        (found, faer::Scale(1.0 / seen) * cross)
    });
    let of_each = (each, faer::Scale(1.0 / seen.sqrt()) * of_each);
    let parts = [of_each].into_iter().chain(of_alike);
    for (found, cross) in parts.filter(|(found, _)| found.variance > 0.0) {
        let moved = &fit.solution.inverse * cross;
        let scale = found.variance / fit.variance;
        fit.spread_by(EstimatedPart {
            covariance: faer::Scale(scale) * (&moved * moved.transpose()),
            relative_variance: found.relative_variance(),
        });
    }
    Some(OffLevels {
        visits: each.variance.sqrt(),
        levels: alike.map_or(0.0, |found| found.variance.sqrt()),
    })
}
