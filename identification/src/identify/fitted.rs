//! A fitted candidate, and what its errors show.

use std::cell::OnceCell;

use super::candidate::Candidate;
use super::estimate::Estimate;
use super::task::Task;
use crate::data::{Record, Run};
use crate::diagnostics::{
    EstimatedEnd, Feedback, HoldScatter, InexactCommands, Linearity, Misfit, PriorOutcome,
    RunComparison, SlowColumns, SlowEnd, UnevenNoise, against_standstill, allow_for_hold_scatter,
    allow_for_inexact_commands, allow_for_run_offsets, allow_for_run_trends, allow_for_scatter,
    allow_for_uneven_noise, simulated, test_linearity,
};
use crate::error::Error;
use crate::results::Model;

/// What gates look at, and pass on.
pub(super) struct Fitted {
    pub(super) candidate: Candidate,
    pub(super) estimate: Estimate,
    /// Of the last fit whose errors were tested as noise: one that was chosen by prediction is not.
    pub(super) linearity: Option<Linearity>,
    /// The share of its largest value by which the response moves again a hold later, where it does: then N is no longer than a hold.
    pub(super) moves_again: Option<f64>,
    /// For how many holds the response would go on, where the output is seen to rest within each of them: then N is no longer than a hold.
    pub(super) outlasts_holds: Option<f64>,
    /// The usual hold \[samples\], where a longer N was stated of a servo that is not linear.
    pub(super) stated_beyond_hold: Option<usize>,
    /// Why the errors are not noise, and what was done about it; `None` when they are.
    pub(super) misfit: Option<Misfit>,
    /// That the response goes on beyond N, where it does.
    pub(super) slow_end: Option<SlowEnd>,
    /// The input behind slow lags beside this estimate, once they were asked for. They depend on its response, not on what its
    /// covariance has beside that of even noise.
    pub(super) slow_columns: OnceCell<Option<SlowColumns>>,
    /// The slow end that is part of the covariance.
    pub(super) allowed_end: Option<EstimatedEnd>,
    /// Whether the input is such that the response may end anywhere after N.
    pub(super) end_is_unseen: bool,
    /// Whether the input follows the output; `None` where that could not be tested.
    pub(super) feedback: Option<Feedback>,
    /// By how much the noise varies, where it does; the covariance of the estimate allows for it.
    pub(super) uneven: Option<UnevenNoise>,
    /// By how much holds differ, where they do; the covariance of the estimate allows for it.
    pub(super) hold_scatter: Option<HoldScatter>,
    /// What errors of the commands may have done, where they may have some; the covariance of the estimate allows for it.
    pub(super) inexact_commands: Option<InexactCommands>,
    /// What became of the stable prior, where it was asked for.
    pub(super) prior: Option<PriorOutcome>,
}

impl Fitted {
    /// Fits a candidate and tests its errors.
    pub(super) fn new(task: &Task<'_>, candidate: Candidate) -> Result<Self, Error> {
        let estimate = Estimate::new(&candidate.plan, &candidate.moments, task.record)?;
        Ok(Self::tested(task, candidate, estimate))
    }

    /// A fit to a candidate, with its errors tested.
    pub(super) fn tested(task: &Task<'_>, candidate: Candidate, estimate: Estimate) -> Self {
        Self {
            linearity: linearity(task, &candidate, &estimate),
            ..Self::untested(candidate, estimate)
        }
    }

    /// Whether the errors are shown to follow the motion: a servo that is not linear.
    pub(super) fn errors_follow_motion(&self) -> bool {
        (self.linearity).is_some_and(|found| found.errors_follow_motion())
    }

    /// Whether the servo is known to rest within holds, and the fit to more lags does not.
    pub(super) fn rests_within_holds(&self) -> bool {
        let moves_at_rest = self.candidate.moved_until().is_some();
        self.moves_again.is_some() || self.outlasts_holds.is_some() || moves_at_rest
    }

    /// A fit to a candidate, without any findings.
    pub(super) fn untested(candidate: Candidate, estimate: Estimate) -> Self {
        Self {
            candidate,
            estimate,
            linearity: None,
            moves_again: None,
            outlasts_holds: None,
            stated_beyond_hold: None,
            misfit: None,
            slow_end: None,
            slow_columns: OnceCell::new(),
            allowed_end: None,
            end_is_unseen: false,
            feedback: None,
            uneven: None,
            hold_scatter: None,
            inexact_commands: None,
            prior: None,
        }
    }

    /// With the covariance of the noise that it is: cut at its tails, not even.
    pub(super) fn with_honest_covariance(mut self, task: &Task<'_>) -> Self {
        let (Some(record), None) = (task.record, &self.misfit) else {
            return self;
        };
        let Estimate {
            information, fit, ..
        } = &mut self.estimate;
        let runs = simulated(record, &information.moments, fit);
        self.uneven = allow_for_uneven_noise(&runs, &information.moments, fit);
        let outliers = &task.disturbances.outliers;
        if outliers.count() > 0 {
            fit.spread_further(outliers.variance_ratio(), None);
        }
        self.inexact_commands = allow_for_inexact_commands(record, fit);
        self.hold_scatter = allow_for_hold_scatter(&runs, &information.moments, fit);
        let levels = &task.disturbances.levels;
        if !levels.is_empty() {
            levels.allow_for(&runs, &information.moments, fit);
            self.hold_scatter = Some(HoldScatter {
                levels: levels.sd(),
                ..self.hold_scatter.unwrap_or_default()
            });
        }
        fit.further.tails = outliers.excess / (3.0 * edges(record));
        if !task.disturbances.offsets.is_empty() {
            allow_for_run_offsets(record.runs(), &information.moments, fit);
        }
        if !task.disturbances.trends.is_empty() {
            allow_for_run_trends(record.runs(), &information.moments, fit);
        }
        self
    }

    /// Adds to the covariance how `runs` differ, which are those of `model`; whether they are enough to say.
    pub(super) fn add_scatter(
        &mut self,
        task: &Task<'_>,
        model: &Model,
        (runs, compared): (&[Run<'_>], Option<&RunComparison>),
    ) -> bool {
        let fit = &mut self.estimate.fit;
        task.of_servo
            && self.misfit.is_none()
            && compared.is_some_and(|compared| allow_for_scatter(model, runs, compared, fit))
    }
}

/// Number of equal changes of the input that determine a point of the response as well as those of `record`: a point rests on the samples
/// a certain time after each.
fn edges(record: &Record) -> f64 {
    let inputs = record.runs().iter().map(Run::input);
    let changes = inputs.flat_map(|input| input.windows(2).map(|pair| pair[1] - pair[0]));
    let [squares, fourths] = changes
        .filter(|change| !change.is_nan())
        .map(|change| change * change)
        .fold([0.0, 0.0], |[a, b], square| {
            [a + square, b + square * square]
        });
    (squares * squares / fourths).max(1.0)
}

fn linearity(task: &Task<'_>, candidate: &Candidate, estimate: &Estimate) -> Option<Linearity> {
    let record = task.record?;
    let (information, fit) = (&estimate.information, &estimate.fit);
    let runs = simulated(record, &information.moments, fit);
    let level_error = estimate.level_error(record);
    let found = test_linearity(&runs, information, fit, level_error)?;
    // A response that goes on beyond N leaves errors that are not at standstill either.
    let settled = candidate.plan.choice.as_ref().map(|choice| choice.settled);
    let rest = settled
        .unwrap_or(true)
        .then(|| against_standstill(&runs, record.rest(), information, fit))
        .flatten();
    Some(Linearity { rest, ..found })
}
