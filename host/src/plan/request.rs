//! The runs that a plan is made for.

use super::AssumedServo;
use crate::instrument::reference::seconds;
use crate::instrument::rig::roll_frames;
use servoid_identification::thresholds::MARGIN;
use servoid_protocol::{PulseTrain, Reference};

/// The runs that a plan is made for.
#[derive(Clone, Debug)]
pub struct PlanRequest {
    /// The reference.
    pub reference: Reference,
    /// Change of the pulse for one degree (µs/deg).
    pub us_per_degree: f64,
    /// Number of runs.
    pub runs: usize,
    /// The servo and the noise that are assumed.
    pub assumed: AssumedServo,
    /// Confidence level of the bounds.
    pub level: f64,
    /// Half width of the whole curve's band that is wanted, where it is widest (percent of the step).
    pub wanted_percent: Option<f64>,
    /// Whether to plan for the servo model too.
    pub servo_model: bool,
}

impl PlanRequest {
    /// Duration of one run: the reference, and the rest before and after it (s).
    pub(super) fn run_s(&self) -> f64 {
        let train = self.assumed.train;
        seconds(
            self.reference.frames() + 2 * u32::from(roll_frames(train)),
            train,
        )
    }

    /// Whether the plan holds for a linear servo only: no more than its model is known, and the reference has no
    /// hold in which it comes to rest.
    pub(super) fn relies_on_linearity(&self) -> bool {
        let AssumedServo {
            model, simulation, ..
        } = &self.assumed;
        let settling_s = model.structure.settling_samples as f64 * model.sample_period_s;
        // N is a margin longer than the response.
        simulation.is_none() && !rests(&self.reference, self.assumed.train, settling_s / MARGIN)
    }
}

/// Whether a hold lasts for the settling time. The motion before a servo has settled depends on where it comes
/// from, unless the servo is linear.
fn rests(reference: &Reference, train: PulseTrain, settling_s: f64) -> bool {
    let is_long_enough = |frames: u16| seconds(frames.into(), train) >= settling_s;
    match reference {
        Reference::Staircase(staircase) => is_long_enough(staircase.longest_hold_frames),
        Reference::Stairs(stairs) => is_long_enough(stairs.hold_frames),
        Reference::Prbs(prbs) => is_long_enough(prbs.chip_frames),
        Reference::Steps(steps) => steps.held().any(|step| is_long_enough(step.hold_frames)),
        Reference::Sweep(_) | Reference::Multisine(_) => false,
    }
}
