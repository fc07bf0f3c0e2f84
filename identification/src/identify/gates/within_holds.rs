//! Gate: does the servo, if it is not linear, respond for no longer than the input is held?
//!
//! It is not linear where its errors show that, where its response comes to rest and moves again a hold later, or where it goes on for several holds
//! although the output is seen to rest in each of them: a reference that repeats itself lets a response as long as its period describe anything that
//! does so, too.
//!
//! Protects: N of a servo that is not linear. Beyond the usual hold the next steps are under way, and how they
//! are answered differently because of this one passes for a late part of its response. The same differences come in each run of one reference,
//! so that several runs are no more evidence of a longer response than one. Nor does a servo with play or friction respond when its output is at
//! rest: what its response does later answers the steps before.
//!
//! If not, N is chosen again among settling times up to the usual hold, or up to the rest of the output within it. Holds that are too short for a
//! choice, or for the response, limit nothing. An N that was stated stays, and bounds lose their level.

use crate::data::{Record, usual_hold};
use crate::diagnostics::{
    SlowColumns, moves_after, moves_again, moves_with_next_step, rests_within, time_until_rest,
};
use crate::error::Error;
use crate::estimation::CurveVariance;
use crate::identify::candidate::Candidate;
use crate::identify::estimate::Estimate;
use crate::identify::fitted::Fitted;
use crate::identify::slow_end_allowance::slow_columns;
use crate::identify::task::Task;
use crate::thresholds::{MARGIN, MOVES_LITTLE};

pub(super) fn pass(task: &Task<'_>, mut fitted: Fitted) -> Result<Fitted, Error> {
    let plan = &fitted.candidate.plan;
    // A comparison gives N of another choice, which has been here.
    let is_stated = plan.choice.is_none() && !task.may_go_on;
    let (Some(record), true) = (task.record, is_stated || plan.choice.is_some()) else {
        return Ok(fitted);
    };
    let hold = usual_hold(record);
    let settling = plan.basis.settling();
    let outlasts = match settling > hold {
        true => Outlasts::of(record, settling, hold, &fitted.estimate),
        false => Outlasts::default(),
    };
    let at_rest = match outlasts.is_seen() {
        true => None,
        false => AtRest::before_the_end(task, record, hold, &fitted),
    };
    let is_rejected = fitted.linearity.is_some_and(|found| found.is_rejected());
    let is_no_end = |found: &AtRest| is_rejected || found.moves_with_next_step;
    let within = (at_rest.as_ref()).filter(|found| is_no_end(found));
    let limit = within.map_or(hold, |found| found.within);
    let rests = outlasts.is_seen() || within.is_some();
    if let Some(choice) = &mut fitted.candidate.plan.choice {
        choice.moved_until = at_rest.map(|_| choice.detected);
    }
    if settling <= limit || !(rests || is_rejected) {
        return Ok(fitted);
    }
    let moved_until = fitted.candidate.moved_until();
    let shorter = Candidate::of_repeated_errors(record, limit, task.options).ok();
    let Some(shorter) = shorter.and_then(|found| found.within_holds(rests, moved_until)) else {
        return Ok(fitted);
    };
    if is_stated {
        let stated_beyond_hold = Some(hold);
        return Ok(Fitted {
            stated_beyond_hold,
            ..fitted
        });
    }
    let shorter = Fitted::new(task, shorter)?;
    Ok(Fitted {
        linearity: shorter.linearity.or(fitted.linearity),
        moves_again: outlasts.again,
        outlasts_holds: outlasts.holds,
        ..shorter
    })
}

/// The rest of the output, where the response moves after that.
struct AtRest {
    /// Samples after a command.
    within: usize,
    /// Whether the response moves with the next step, as a slow end does not.
    moves_with_next_step: bool,
}

impl AtRest {
    /// `None` where the output is not seen to rest, or the response moves by nothing that matters, or by nothing but a slow end.
    fn before_the_end(
        task: &Task<'_>,
        record: &Record,
        hold: usize,
        fitted: &Fitted,
    ) -> Option<Self> {
        let choice = fitted.candidate.plan.choice.as_ref()?;
        let within = time_until_rest(record, choice.detected.min(hold))?;
        let Estimate {
            coordinates,
            information,
            fit,
        } = &fitted.estimate;
        let step = coordinates.basis.step_response(&fit.theta());
        let slow_ends = slow_columns(task, fitted).into_iter();
        let changes: Vec<_> = slow_ends.flat_map(SlowColumns::changes_of_step).collect();
        let rounding =
            (fitted.estimate.steps_of_sensor(record)).map_or(0.0, |found| found.allowance);
        let found = Self {
            within,
            moves_with_next_step: moves_with_next_step(
                information,
                fit,
                (within, hold),
                rounding,
                &changes,
            ),
        };
        let moved = moved_after(&step, within)?;
        let mut beside_ends =
            (changes.iter()).filter_map(|(change, _)| Some(moved + moved_after(change, within)?));
        let matters = |moved: f64| moved.abs() > MOVES_LITTLE * step[step.len() - 1].abs();
        let moves = matters(moved) && beside_ends.all(matters);
        (moves || found.moves_with_next_step).then_some(found)
    }
}

/// By how much a response is farther at its end than where the output is seen to rest, in the second half of so many samples.
fn moved_after(step: &[f64], rest: usize) -> Option<f64> {
    let at_rest = step.get(rest / 2..rest)?;
    Some(step.last()? - at_rest.iter().sum::<f64>() / at_rest.len() as f64)
}

/// What a response longer than the holds does behind them.
#[derive(Default)]
struct Outlasts {
    /// The share of its largest value by which it moves again a hold later.
    again: Option<f64>,
    /// For how many holds it goes on, where the output is seen to rest within each of them.
    holds: Option<f64>,
}

impl Outlasts {
    fn of(record: &Record, settling: usize, hold: usize, estimate: &Estimate) -> Self {
        let Estimate {
            coordinates,
            information,
            fit,
        } = estimate;
        let step = coordinates.basis.step_response(&fit.theta());
        let spread = || CurveVariance::of_fit(information, fit, &coordinates.step_map());
        let rounding = (estimate.steps_of_sensor(record)).map_or(0.0, |found| found.allowance);
        // A response that is over in the first half of a hold has an acceptable N that is no longer than the hold.
        let holds = settling as f64 / hold as f64;
        let outlasts =
            holds > MARGIN && rests_within(record, hold) && moves_after(&step, &spread().sd, hold);
        Self {
            again: moves_again(information, fit, hold, rounding),
            holds: outlasts.then_some(holds),
        }
    }

    fn is_seen(&self) -> bool {
        self.again.is_some() || self.holds.is_some()
    }
}
