//! What the outputs of ArduPilot's simulated servos stand for.

use super::recorded_range::recorded;
use super::subject::ServoExport;
use crate::data::neutral::NEUTRAL_US;
use crate::data::pulse_widths::is_pulse;
use crate::data::unitless_command::{FULL_US, UnitlessCommand};
use crate::presentation::export::error::ExportError;
use servoid_identification::results::six_digits;

/// The deflection that SITL takes for a full command \[deg\].
pub(super) const FULL_DEG: f64 = 45.0;

/// An output of 0 and one of 1 in units of the command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FullCommand {
    /// The command of the output 0.
    pub zero: f64,
    /// The change of the command that turns the output from 0 to 1.
    pub full: f64,
    origin: Origin,
}

/// "45 deg", of a command.
fn with_unit(export: &ServoExport<'_>, command: f64) -> String {
    let unit = export.metadata.units().input;
    let unit = unit.map(|unit| format!(" {unit}")).unwrap_or_default();
    format!("{}{unit}", six_digits(command))
}

/// Why a command is a full one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Origin {
    /// It was stated.
    Stated,
    /// SITL takes pulses so.
    Pulse,
    /// SITL's speed takes 45 degrees so.
    Degrees,
    /// A command without a unit that is as small is a part of a full one.
    Part,
}

impl FullCommand {
    /// Of the command of this servo.
    ///
    /// # Errors
    /// Nothing says what a full command is, or the recorded ones are all beyond it.
    pub fn of(export: &ServoExport<'_>) -> Result<Self, ExportError> {
        let (full, origin) = Self::size(export)?;
        let (middle, most) = recorded(export.model, &export.parameters);
        let zero = match (Self::is_pulse(export), origin) {
            (true, _) => NEUTRAL_US,
            (false, Origin::Stated | Origin::Part) => 0.0,
            // SITL's middle is not known: it is 0 where strokes of the recording go out from there.
            _ if middle.abs() + most.min(full) <= full => 0.0,
            _ => middle,
        };
        let found = Self { zero, full, origin };
        let [least, largest] = found.possible();
        match middle - most < largest && middle + most > least {
            true => Ok(found),
            false => Err(ExportError::BeyondFullCommand { least, largest }),
        }
    }

    fn size(export: &ServoExport<'_>) -> Result<(f64, Origin), ExportError> {
        if let Some(stated) = export.options.full_command {
            // A pulse from 0 on is none from the middle.
            return match Self::is_pulse(export) && stated >= NEUTRAL_US {
                true => Err(ExportError::FullCommandIsPulse(stated)),
                false => Ok((stated, Origin::Stated)),
            };
        }
        if Self::is_pulse(export) {
            return Ok((FULL_US, Origin::Pulse));
        }
        if export.unitless() == Some(UnitlessCommand::PartOfFull) {
            return Ok((1.0, Origin::Part));
        }
        match export.radians_per_unit() {
            Ok(radians) => Ok((FULL_DEG.to_radians() / radians, Origin::Degrees)),
            Err(ExportError::NotAnAngle(unit)) => Err(ExportError::UnknownFullCommand(unit)),
            Err(other) => Err(other),
        }
    }

    fn is_pulse(export: &ServoExport<'_>) -> bool {
        is_pulse(export.metadata.units(), export.model.commands)
    }

    /// The commands of the outputs -1 and 1.
    pub fn possible(&self) -> [f64; 2] {
        [self.zero - self.full, self.zero + self.full]
    }

    /// The output for a command.
    pub fn output(&self, command: f64) -> f64 {
        (command - self.zero) / self.full
    }

    /// What an output stands for, a sentence.
    pub fn in_words(&self, export: &ServoExport<'_>) -> String {
        let full = with_unit(export, self.full);
        let why = match self.origin {
            Origin::Stated => ", as --full-command states".to_owned(),
            Origin::Pulse => {
                format!(": it is (pulse - {NEUTRAL_US}) / {FULL_US}, as SITL takes the pulse")
            }
            Origin::Degrees => format!(
                ", which are {FULL_DEG} degrees, as SITL's speed takes it; state another full command with --full-command"
            ),
            Origin::Part => {
                ", which has no unit and is taken for a part of a full one; state another with --full-command"
                    .to_owned()
            }
        };
        format!("An output of 1 stands for {full} of the command{why}.")
    }

    /// The same for the terminal, where it was assumed.
    pub fn assumed(&self, export: &ServoExport<'_>) -> Option<String> {
        let is_assumed = matches!(self.origin, Origin::Degrees | Origin::Part);
        is_assumed.then(|| {
            format!(
                "an output of 1 (a pulse of {} us) is taken for the command {}: state another with --full-command",
                NEUTRAL_US + FULL_US,
                with_unit(export, self.zero + self.full)
            )
        })
    }
}
