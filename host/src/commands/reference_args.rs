//! The options that say what the servo is told.

use super::{Talk, suggest, wrong_usage};
use crate::instrument::reference::{Band, Kind, ReferenceError, ReferenceSpec};
use anyhow::Result;
use clap::Args;
use servoid_protocol::Reference;

#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "What the servo is told")]
pub(super) struct ReferenceArgs {
    /// staircase: the paper's, holds of 800 ms down to 100 ms at + and at - (7.2 s). stairs: every
    /// stroke between some levels, for limits of speed and travel, hysteresis and asymmetry. prbs: a
    /// pseudo-random binary sequence. sweep: a sine of moving frequency. multisine: many sines at
    /// once. FILE.csv: a table of steps with the columns angle_deg and hold_s. 'servoid plan' compares
    /// them
    #[arg(long, default_value_t = Kind::Staircase, value_name = "NAME|FILE.csv", value_parser = suggest::reference(), hide_possible_values = true)]
    reference: Kind,
    /// How far the reference goes to each side (degrees) [default: 5]
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    amplitude: Option<f64>,
    /// How long each level of stairs or each chip of prbs is held [default: 1.2 and 0.16]. Servos that
    /// are not linear, as most are, answer a hold that ends before they rest in another way than a longer
    /// one: with chips of 0.02 s the band of the simulated bench servo is thirty times as wide, or more
    #[arg(long, value_name = "SECONDS")]
    hold: Option<f64>,
    /// How long the reference takes, as near as whole cycles come [default: about 10, stairs 48; a
    /// table once]
    #[arg(long, value_name = "SECONDS")]
    length: Option<f64>,
    /// Number of levels of stairs [default: 5]
    #[arg(long, value_name = "COUNT")]
    levels: Option<u16>,
    /// Where prbs begins in its sequence [default: all ones]
    #[arg(long, value_name = "SEED")]
    prbs_seed: Option<u16>,
    /// Frequencies of sweep and multisine (Hz) [default: 0.2:15]
    #[arg(long, value_name = "LOW:HIGH")]
    frequencies: Option<Band>,
}

impl ReferenceArgs {
    /// The reference; options that contradict it are wrong usage.
    pub(super) fn grant(self, us_per_degree: f64, talk: Talk) -> Result<Reference> {
        let wish = ReferenceSpec {
            kind: self.reference,
            amplitude_deg: self.amplitude,
            hold_s: self.hold,
            length_s: self.length,
            levels: self.levels,
            seed: self.prbs_seed,
            frequencies_hz: self.frequencies,
        };
        let granted = match wish.grant(us_per_degree) {
            Err(error @ ReferenceError::NotFor { .. }) => wrong_usage(error),
            other => other?,
        };
        granted.remarks.iter().for_each(|remark| talk.say(remark));
        Ok(granted.reference)
    }
}
