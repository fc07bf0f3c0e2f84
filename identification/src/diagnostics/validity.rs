//! Whether the bounds of an identification hold, and which of its metrics it supports.
//!
//! This is the one place where that is decided, from the evidence alone, before anything is drawn or written.
//! Nothing else makes bounds valid; everything else derives its own from the level that is given here.

use crate::diagnostics::commands::inexact_commands::Inexact;
use crate::diagnostics::misfit::{Misfit, MisfitEvidence};
use crate::diagnostics::response_end::rise_at_end::rise_at_end;
use crate::diagnostics::response_end::slow_servo::SlowServo;
use crate::diagnostics::runs::gain_drift::GainDrift;
use crate::diagnostics::times::time_fault::TimeFault;
use crate::diagnostics::travel::flat_end::TravelEnd;
use crate::diagnostics::travel::servo_stopped::ServoStopped;
use crate::estimation::{Excitation, FsfBasis};
use crate::results::{Bounds, Interval, Metrics, Reason, SelectedBy, Withheld};
use crate::thresholds::DISAGREEMENT;

/// The evidence for and against bounds.
pub(crate) struct ValidityEvidence<'a> {
    pub(crate) basis: FsfBasis,
    pub(crate) selected_by: SelectedBy,
    pub(crate) sample_period_s: f64,
    /// What was found when the errors are not noise.
    pub(crate) misfit: Option<&'a Misfit>,
    pub(crate) excitation: Excitation,
    /// Whether the steps of the sensor are larger than the noise.
    pub(crate) quantised: bool,
    /// Whether the response goes on beyond the longest N.
    pub(crate) unsettled: bool,
    /// Where the servo stops following the input.
    pub(crate) stopped: Option<ServoStopped>,
    /// What makes its times other than what they are taken for.
    pub(crate) time_fault: Option<TimeFault>,
    /// Stops within the range of the commands.
    pub(crate) travel_ends: [Option<TravelEnd>; 2],
    /// A gain that changes along the record.
    pub(crate) gain_drift: Option<GainDrift>,
    /// What makes the response longer than any settling time.
    pub(crate) slow_servo: Option<SlowServo>,
    /// Whether the input is such that nothing is known of the response beyond N.
    pub(crate) end_is_unseen: bool,
    /// Whether the input follows the output.
    pub(crate) closed_loop: bool,
    /// Whether the response at lag 0 shows that a smooth input does not separate lags.
    pub(crate) lags_are_mixed: bool,
    /// The errors of commands that may be what excites the response, where that may be so.
    pub(crate) excited_by_errors: Option<Inexact>,
    /// G_0.
    pub(crate) gain: f64,
    /// The step response, and what left-out frequencies may change in it.
    pub(crate) step: &'a [f64],
    pub(crate) truncation_bias: f64,
}

/// What the evidence decides.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Validity {
    /// The level of all bounds, where they hold.
    pub(crate) level: Bounds<f64>,
    /// The lowest frequency at which the input does not determine the response \[Hz\]; `None` where it determines
    /// all, or frequencies were left out by the caller's choice alone.
    pub(crate) unexcited_above_hz: Option<f64>,
    /// The errors of commands that may be all that excites it there.
    pub(crate) excited_by_errors: Option<Inexact>,
    /// The lowest frequency that was left out by the caller's choice \[Hz\], where nothing bounds what that does.
    pub(crate) left_out_above_hz: Option<f64>,
    /// Where the servo stops following the input.
    pub(crate) stopped: Option<ServoStopped>,
    /// What makes the times of the record other than what they are taken for.
    pub(crate) time_fault: Option<TimeFault>,
    /// Stops within the range of the commands.
    pub(crate) travel_ends: [Option<TravelEnd>; 2],
    /// A gain that changes along the record, where that is why there are no bounds.
    pub(crate) gain_drift: Option<GainDrift>,
    /// What makes the response longer than any settling time, where that is why there are no bounds.
    pub(crate) slow_servo: Option<SlowServo>,
    /// Why metrics are left out, where they are.
    pub(crate) withheld: Option<Withheld>,
    /// Whether the final value is supported all the same.
    gain_is_supported: bool,
}

impl Validity {
    /// Decides; bounds that hold have `level`.
    ///
    /// Where the servo stops, or times are not what they seem, everything else may be its consequence. An input that excites only part of the response leaves
    /// errors that do not look like noise either, so it comes next. Under a smooth input the effect of rounding grows with everything
    /// else, and nothing bounds it.
    pub(crate) fn new(evidence: &ValidityEvidence<'_>, level: f64) -> Self {
        let stopped = evidence.stopped;
        // A servo that does not answer any more has no lag.
        let time_fault = evidence.time_fault.filter(|_| stopped.is_none());
        let lacking = evidence.unexcited_above_hz();
        let excited_by_errors = (evidence.excited_by_errors).filter(|_| lacking.is_none());
        let power_up_to_hz = evidence.excitation.power_up_to_hz;
        let unexcited_above_hz = (lacking.or(excited_by_errors.map(|_| power_up_to_hz)))
            .filter(|_| time_fault.is_none());
        let left_out_above_hz = evidence
            .left_out_above_hz()
            .filter(|_| unexcited_above_hz.is_none());
        let reason = if stopped.is_some() {
            Some(Reason::ServoStopped)
        } else if let Some(fault) = time_fault {
            Some(fault.reason())
        } else if let Some(reason) = reason_of_travel(&evidence.travel_ends) {
            Some(reason)
        } else if evidence.slow_servo.is_some() {
            Some(Reason::ResponseNotOver)
        } else if unexcited_above_hz.is_some() {
            Some(Reason::InputUnexcited)
        } else if left_out_above_hz.is_some() {
            Some(Reason::FrequenciesLeftOut)
        } else if evidence.closed_loop {
            Some(Reason::InputFollowsOutput)
        } else if evidence.gain_drift.is_some() {
            Some(Reason::GainDrift)
        } else if evidence.misfit.is_some() {
            Some(Reason::ErrorsNotNoise)
        } else if evidence.quantised && evidence.excitation.is_smooth() {
            Some(Reason::QuantisationAboveNoise)
        } else if evidence.unsettled {
            Some(Reason::ResponseNotOver)
        } else if evidence.end_is_unseen {
            Some(Reason::EndUnseen)
        } else {
            None
        };
        // The share of its final value by which the missing frequencies may change the step response.
        let missing = evidence.truncation_bias / evidence.gain.abs();
        let disagreeing = evidence
            .misfit
            .filter(|misfit| misfit.disagreement(evidence.step) > DISAGREEMENT);
        let slow_servo = (evidence.slow_servo).filter(|_| reason == Some(Reason::ResponseNotOver));
        let (withheld, gain_is_supported) = match disagreeing {
            _ if time_fault.is_some() => (Some(Withheld::TimeFault), true),
            _ if slow_servo.is_some() => (Some(Withheld::ResponseNotOver), false),
            _ if evidence.lags_are_mixed && evidence.misfit.is_none() => {
                (Some(Withheld::InputUnexcited), false)
            }
            // Nothing says by how much a response is off that rests on errors of its commands, its final value included.
            _ if excited_by_errors.is_some() && unexcited_above_hz.is_some() => {
                (Some(Withheld::InputUnexcited), false)
            }
            // The final value is no exception: a bank that is short of frequencies takes others for it.
            _ if unexcited_above_hz.is_some() && missing > DISAGREEMENT => {
                (Some(Withheld::InputUnexcited), false)
            }
            _ if left_out_above_hz.is_some() && missing > DISAGREEMENT => {
                (Some(Withheld::FrequenciesLeftOut), false)
            }
            // Where estimators disagree, neither's times are findings. The final value may be one all the same, unless both
            // take an unfinished response for it, or one to a step that was not seen.
            Some(misfit) => {
                let last = evidence.step.last().zip(misfit.other_step.last());
                let agree = |(a, b): (&f64, &f64)| (a - b).abs() <= DISAGREEMENT * a.abs();
                let saw_steps = !matches!(misfit.evidence, MisfitEvidence::NoSteps(..));
                let has_end = saw_steps && rise_at_end(evidence.step).is_none();
                (
                    Some(Withheld::EstimatorsDisagree),
                    has_end && last.is_some_and(agree),
                )
            }
            None => (None, true),
        };
        Self {
            level: reason.map_or(Bounds::Valid(level), Bounds::Withdrawn),
            unexcited_above_hz,
            excited_by_errors,
            left_out_above_hz,
            stopped,
            time_fault,
            travel_ends: if stopped.is_some() || time_fault.is_some() {
                [None; 2]
            } else {
                evidence.travel_ends
            },
            gain_drift: (evidence.gain_drift).filter(|_| reason == Some(Reason::GainDrift)),
            slow_servo,
            withheld,
            gain_is_supported,
        }
    }

    /// The outputs at which the servo stops.
    pub(crate) fn stops(&self) -> Vec<f64> {
        let ends = self.travel_ends.iter().flatten();
        ends.filter(|end| end.is_shown)
            .map(|end| end.rest)
            .collect()
    }

    /// `metrics` without those that the evidence does not support.
    pub(crate) fn supported(&self, metrics: Metrics) -> Metrics {
        let gain = match self.gain_is_supported {
            true => metrics.dc_gain,
            false => Interval::default(),
        };
        self.withheld.map_or(metrics, |reason| {
            Metrics::withheld(gain, reason, metrics.bounds)
        })
    }
}

impl ValidityEvidence<'_> {
    fn unexcited_above_hz(&self) -> Option<f64> {
        if let Some(found) = self.misfit.and_then(|misfit| misfit.unexcited_above_hz) {
            return Some(found);
        }
        if self.lags_are_mixed && self.misfit.is_none() {
            return Some(self.excitation.power_up_to_hz);
        }
        let unbounded = !self.excitation.bounded;
        let lacking = match self.misfit {
            // The choice for prediction leaves out what does not help it, whether the input has it or not.
            Some(_) => unbounded && self.excitation.is_smooth(),
            None if self.selected_by == SelectedBy::Auto => {
                unbounded || !self.basis.has_all_frequencies()
            }
            // Of an input with edges, the caller's number is all that leaves them out.
            None => unbounded && self.excitation.is_smooth(),
        };
        lacking.then(|| self.next_hz())
    }

    fn left_out_above_hz(&self) -> Option<f64> {
        let by_caller = self.selected_by != SelectedBy::Auto && self.misfit.is_none();
        (by_caller && !self.excitation.bounded).then(|| self.next_hz())
    }

    /// The first frequency that the bank does not have.
    fn next_hz(&self) -> f64 {
        let next = (self.basis.highest() + 1) as f64;
        next / (self.basis.settling() as f64 * self.sample_period_s)
    }
}

/// What the ends of the travel say against bounds: that the servo stops there, where an end shows it, or else that this is open.
fn reason_of_travel(ends: &[Option<TravelEnd>; 2]) -> Option<Reason> {
    let mut found = ends.iter().flatten().peekable();
    found.peek()?;
    Some(match found.any(TravelEnd::is_of_several_commands) {
        true => Reason::TravelEnd,
        false => Reason::TravelEndOpen,
    })
}
