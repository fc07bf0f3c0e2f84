//! Whether the errors of a servo model are those of commands that wait for pulses on a clock of their own.

use crate::analysis::command_times::pulse_errors::simulate_with_pulses;
use crate::analysis::command_times::pulse_search::least_error;
use crate::data::dataset::{Dataset, FRAME_S};
use servoid_identification::Run;
use servoid_identification::results::Reason;
use servoid_identification::servo_model::{ServoModel, WaitsForPulses};

/// The share of its error that a servo leaves at the most where each command waits for its pulse: errors that have another cause stay nearly as they are.
const LEFT: f64 = 0.5;

/// The pulses that the commands of `data` waited for, where the errors of its `model`, with the controllers of the runs, show them. The delay of the model has the mean of the waits.
pub(super) fn waits_for_pulses(
    data: &Dataset,
    model: &ServoModel,
    controllers: &[usize],
) -> Option<WaitsForPulses> {
    let about = &data.about;
    // Waits that all changes have in common are in no error.
    let may_wait = about.commands_may_wait() && !about.moving_command && about.common_wait_s == 0.0;
    if !may_wait || model.covariance.withdrawn() != Some(Reason::ErrorsNotNoise) {
        return None;
    }
    let servo = model.clone().sooner(0.5 * FRAME_S);
    let record = &data.record;
    let predict = |run: &Run<'_>, number: usize, pulses: [f64; 2]| {
        let pulses = pulses.map(|time_s| time_s / record.sample_period_s());
        let controller = controllers.get(number..=number).unwrap_or_default();
        simulate_with_pulses(&servo, controller, record, run, pulses)
    };
    let (frame_s, rmse) = least_error(record, FRAME_S, &predict)?;
    (rmse < LEFT * model.fit.rmse).then_some(WaitsForPulses { frame_s, rmse })
}
