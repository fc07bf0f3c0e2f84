//! Findings on times that are not what they are taken for.

use crate::diagnostics::advice::evidence::{Evidence, two_digits};
use crate::diagnostics::times::time_fault::TimeFault;
use crate::results::{Advice, Check};
use crate::thresholds::LAG_DRIFT_SIGNIFICANCE;

pub(super) fn time_fault(evidence: &Evidence<'_>) -> Option<Advice> {
    let period_ms = 1e3 * evidence.model.sample_period_s;
    Some(match evidence.validity.time_fault? {
        TimeFault::LateCommand(found) => Advice::new(
            Check::EarlyMotion,
            format!(
                "No bounds can be given, because the servo moves at least {:.0} ms before its command changes: it has made {:.1} % of its \
                 stroke by then, on average over {} changes. So the command was written late, or the two columns come from different clocks.",
                1e3 * found.lead_s,
                100.0 * found.share,
                found.changes
            ),
            found.lead_s,
            0.0,
            "Write the command at the moment at which it is sent, with the clock of the position; or put the column of the command \
             earlier by more than that, and then take speeds and sizes alone from the result, because no delay is known.",
        ),
        TimeFault::HeldOutput(samples) => Advice::new(
            Check::HeldOutput,
            format!(
                "No bounds can be given, because the output changes every {samples} samples only, which is every {} ms: the sensor, or what \
                 reads it, is slower than the recording, and each value is up to {} ms old.",
                two_digits(samples as f64 * period_ms),
                two_digits((samples - 1) as f64 * period_ms)
            ),
            samples as f64,
            1.0,
            format!(
                "Read the sensor with every sample; or keep the rows alone in which it was read, one of {samples}, with the commands that \
                 were in force then."
            ),
        ),
        TimeFault::LagDrift(found) => Advice::new(
            Check::LagDrift,
            format!(
                "No bounds can be given, because the servo answers {} ms {} at the end of a run than at its beginning (p = {:.0e}): the \
                 clocks of the two columns differ by {} %, or the clocks of the rows and of pulses that commands wait for, or the servo changes, as with its supply or its heat.",
                two_digits(1e3 * found.change_s.abs()),
                if found.change_s > 0.0 {
                    "later"
                } else {
                    "sooner"
                },
                found.p.max(1e-12),
                two_digits(100.0 * found.rate.abs())
            ),
            found.p,
            LAG_DRIFT_SIGNIFICANCE,
            "Write command and position by one clock, and change commands with the pulses. Where they are, look at the servo's supply, and identify the beginning and \
             the end of the run by themselves.",
        ),
    })
}
