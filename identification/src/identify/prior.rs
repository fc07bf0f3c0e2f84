//! The stable prior in place of a decided N, where it was asked for.
//!
//! Under the prior a long N costs nothing, and a narrow band is hurt by an N that cuts the response off. So N is twice the one that
//! was chosen, as far as the record allows.

use super::estimate::Estimate;
use super::fitted::Fitted;
use super::slow_end_allowance::slow_columns;
use super::task::Task;
use crate::diagnostics::PriorOutcome;
use crate::estimation::{FsfBasis, Regularised};
use crate::options::{NoiseOrder, Prior, Settling};
use crate::selection::{longest_settling, odd_at_most};
use crate::thresholds::{PRIOR_CONTRADICTED, PRIOR_HIDDEN_END};

/// N under the prior, in those without, as far as the record allows.
const LONGER: usize = 2;

/// The fit under the prior, or `fitted` where there is none or it does not hold; with what became of it, where it was asked for.
pub(super) fn under_prior(task: &Task<'_>, fitted: Fitted) -> Fitted {
    if task.options.prior == Prior::None {
        return fitted;
    }
    let not_used = |fitted: Fitted, outcome| Fitted {
        prior: Some(outcome),
        ..fitted
    };
    if fitted.misfit.is_some() || !fitted.candidate.plan.basis.is_complete() {
        return not_used(fitted, PriorOutcome::NotApplicable);
    }
    if let Some(outcome) = slow_end(task, &fitted) {
        return not_used(fitted, outcome);
    }
    let longer = with_longer_settling(task, &fitted);
    let wide = longer.as_ref().unwrap_or(&fitted);
    let Some(regularised) = Regularised::of(&wide.estimate.fit) else {
        return not_used(fitted, PriorOutcome::NotFound);
    };
    let contradiction = regularised.contradiction;
    if contradiction > PRIOR_CONTRADICTED {
        return not_used(fitted, PriorOutcome::Contradicted { contradiction });
    }
    let mut found = longer.unwrap_or(fitted);
    let period_s = found.candidate.moments.sample_period_s();
    let constants = regularised.time_constants().into_iter();
    found.prior = Some(PriorOutcome::Used {
        time_constants_s: constants.map(|samples| samples * period_s).collect(),
        contradiction,
    });
    regularised.carry_into(&mut found.estimate.fit);
    found.slow_columns.take();
    found
}

/// That the response may go on beyond N, where it may.
fn slow_end(task: &Task<'_>, fitted: &Fitted) -> Option<PriorOutcome> {
    let choice = fitted.candidate.plan.choice.as_ref()?;
    if !choice.settled || choice.for_slow_end {
        return Some(PriorOutcome::SlowEnd {
            hidden_percent: None,
        });
    }
    let gain = fitted.estimate.fit.theta()[0].abs();
    let hidden = slow_columns(task, fitted)?.end().sd / gain;
    (hidden > PRIOR_HIDDEN_END).then_some(PriorOutcome::SlowEnd {
        hidden_percent: Some(100.0 * hidden),
    })
}

/// The same choice with a longer N; `None` where N was given, or the record does not determine so much.
fn with_longer_settling(task: &Task<'_>, fitted: &Fitted) -> Option<Fitted> {
    if task.options.settling != Settling::Auto {
        return None;
    }
    let settling = fitted.candidate.plan.basis.settling();
    let longest = longest_settling(task.record?, task.options.longest_settling).ok()?;
    let longer = odd_at_most((LONGER * settling).min(longest));
    if longer <= settling {
        return None;
    }
    let order = NoiseOrder::Order(fitted.estimate.fit.ar.len());
    let basis = FsfBasis::full(longer).ok()?;
    let mut candidate = fitted.candidate.with(task, basis, order);
    // They are those of the shorter N.
    candidate.plan.banks.clear();
    let estimate = Estimate::new(&candidate.plan, &candidate.moments, task.record).ok()?;
    let found = Fitted {
        linearity: fitted.linearity,
        slow_end: fitted.slow_end,
        feedback: fitted.feedback,
        ..Fitted::untested(candidate, estimate)
    };
    Some(found.with_honest_covariance(task))
}
