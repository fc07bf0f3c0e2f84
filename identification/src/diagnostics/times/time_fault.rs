//! What makes the times of a record another thing than what they are taken for: then no model of it describes a servo, and whatever else is
//! found may be its consequence.

use super::held_output::output_held_for;
use super::late_command::{LateCommand, late_command};
use crate::data::{Moments, Record};
use crate::diagnostics::runs::lag_drift::{LagDrift, lag_drift};
use crate::estimation::GlsFit;
use crate::results::Reason;

/// A fault of times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum TimeFault {
    /// The servo moves before its command.
    LateCommand(LateCommand),
    /// The output is refreshed every so many samples only.
    HeldOutput(usize),
    /// The lag changes along the record.
    LagDrift(LagDrift),
}

impl TimeFault {
    /// That of a record with this fit, the plainest first. What was taken out of `undisturbed` as outlying may be what shows a fault, so
    /// `recorded` still has it.
    pub(crate) fn of(
        recorded: &Record,
        undisturbed: &Record,
        moments: &Moments,
        fit: &GlsFit,
    ) -> Option<Self> {
        let held = || output_held_for(recorded).map(Self::HeldOutput);
        let settling = fit.coordinates.basis.settling();
        let early = || late_command(recorded, settling).map(Self::LateCommand);
        let drift = || lag_drift(undisturbed, moments, fit).map(Self::LagDrift);
        held().or_else(early).or_else(drift)
    }

    /// Why there are no bounds then.
    pub(crate) fn reason(&self) -> Reason {
        match self {
            Self::LateCommand(_) => Reason::EarlyMotion,
            Self::HeldOutput(_) => Reason::HeldOutput,
            Self::LagDrift(_) => Reason::LagDrift,
        }
    }
}
