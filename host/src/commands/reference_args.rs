//! The options that describe the reference.

use super::completion_values;
use super::output::{Talk, wrong_usage};
use crate::data::rig_file::RigFile;
use crate::instrument::reference::{
    AMPLITUDE_DEG, FrequencyBand, Kind, ReferenceError, ReferenceSpec,
};
use anyhow::Result;
use clap::Args;
use servoid_protocol::Reference;
use std::path::PathBuf;

#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Reference")]
pub(super) struct ReferenceArgs {
    /// staircase: that of the paper, holds of 800 ms down to 100 ms at + and - (7.2 s). stairs: every stroke
    /// between a few levels, for limits of speed and travel, hysteresis and asymmetry. prbs: a pseudo-random
    /// binary sequence. sweep: a sine of rising frequency. multisine: a sum of sines. FILE.csv: a table of
    /// steps with the columns angle_deg and hold_s. 'servoid plan' compares them
    #[arg(long, default_value_t = Kind::Staircase, value_name = "NAME|FILE.csv", value_parser = completion_values::reference(), hide_possible_values = true)]
    reference: Kind,
    /// Amplitude to each side of neutral (degrees) [default: 5, or what the limits of the rig file leave]
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, value_parser = super::value_parsers::finite)]
    amplitude: Option<f64>,
    /// Hold of each level of stairs, or of each chip of prbs (s) [default: 1.2 and 0.16]. Shorter holds give wider
    /// bands: most servos are not linear, and respond differently when a hold ends before they have settled.
    /// With chips of 0.02 s the simulated bench servo has no bounds at all
    #[arg(long, value_name = "SECONDS", value_parser = super::value_parsers::finite)]
    hold: Option<f64>,
    /// Length of the reference (s), rounded to whole cycles [default: about 10, stairs 48; a table once]
    #[arg(long, value_name = "SECONDS", value_parser = super::value_parsers::finite)]
    length: Option<f64>,
    /// Number of levels of stairs [default: 5]
    #[arg(long, value_name = "COUNT", value_parser = super::value_parsers::whole)]
    levels: Option<u16>,
    /// Start of prbs in its sequence [default: all ones]
    #[arg(long, value_name = "SEED", value_parser = super::value_parsers::whole)]
    prbs_seed: Option<u16>,
    /// Frequencies of sweep and multisine (Hz) [default: 0.2:15]
    #[arg(long, value_name = "LOW:HIGH")]
    frequencies: Option<FrequencyBand>,
}

impl ReferenceArgs {
    /// The table that it is read from, which no result may replace.
    pub(super) fn table(&self) -> Option<&PathBuf> {
        match &self.reference {
            Kind::Steps(table) => Some(table),
            _ => None,
        }
    }

    /// The reference; options that do not fit its kind are wrong usage.
    pub(super) fn resolve(self, rig: &RigFile, talk: Talk) -> Result<Reference> {
        let spec = ReferenceSpec {
            amplitude_deg: self.amplitude.or_else(|| self.within_limits(rig, talk)),
            kind: self.reference,
            hold_s: self.hold,
            length_s: self.length,
            levels: self.levels,
            seed: self.prbs_seed,
            frequencies_hz: self.frequencies,
            train: rig.train(),
        };
        let resolved = match spec.resolve(rig.servo.us_per_degree) {
            Err(error @ ReferenceError::NotFor { .. }) => wrong_usage(error),
            other => other?,
        };
        resolved.remarks.iter().for_each(|remark| talk.say(remark));
        Ok(resolved.reference)
    }

    /// The default amplitude, where the limits of the rig leave less (deg).
    fn within_limits(&self, rig: &RigFile, talk: Talk) -> Option<f64> {
        let largest = rig.largest_amplitude_deg();
        let is_less = largest > 0.0 && largest < AMPLITUDE_DEG;
        let has_amplitude = !matches!(self.reference, Kind::Steps(_));
        (is_less && has_amplitude).then(|| {
            talk.say(format_args!(
                "the reference goes to ±{largest} degrees in place of ±{AMPLITUDE_DEG}: the limits of the rig file leave no more"
            ));
            largest
        })
    }
}
