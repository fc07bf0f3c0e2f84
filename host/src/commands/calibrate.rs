//! `servoid calibrate`

use super::Talk;
use crate::calibration::{Calibration, LEVEL, Reading};
use crate::output;
use crate::rig::RigFile;
use anyhow::{Context, Result};
use clap::Args;
use std::path::PathBuf;

/// Find the sensor's scale and zero from its counts at known angles, and how well they are known
///
/// With the pulses off, turn the horn to an angle that a protractor shows, read the counts with
/// 'servoid info', and so on for three or more angles, better from both sides. The angles are taken
/// as exact; what is wrong with them shows as scatter around the line.
#[derive(Debug, Args)]
#[command(after_help = "Example:
  servoid calibrate --pairs=-20=6008,-10=7100,0=8192,10=9284,20=10377
  servoid calibrate --pairs=-20=6008,0=8192,20=10377 --rig rig.toml -o calibrated.toml")]
pub(super) struct Calibrate {
    /// The readings: degrees=counts, with commas between them
    #[arg(
        long,
        required = true,
        value_delimiter = ',',
        allow_hyphen_values = true,
        value_name = "DEGREES=COUNTS",
        value_parser = reading
    )]
    pairs: Vec<Reading>,
    /// The rig file that the result is put into; its comments and all else stay
    #[arg(long, value_name = "RIG.toml")]
    rig: Option<PathBuf>,
    /// The rig file to write
    #[arg(long, short, value_name = "RIG.toml")]
    out: Option<PathBuf>,
    /// Replace the file if it exists
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    talk: Talk,
}

fn reading(text: &str) -> Result<Reading, String> {
    let number = |text: &str| text.trim().parse::<f64>().ok();
    text.split_once('=')
        .and_then(|(angle, counts)| Some((number(angle)?, number(counts)?)))
        .map(|(angle_deg, counts)| Reading { angle_deg, counts })
        .ok_or_else(|| "an angle and its counts are needed, such as -20=6008".to_owned())
}

impl Calibrate {
    pub(super) fn run(self) -> Result<String> {
        let before = match &self.rig {
            Some(path) => {
                RigFile::read(path)?;
                std::fs::read_to_string(path)
                    .with_context(|| format!("the rig file {path:?} cannot be read"))?
            }
            None => String::new(),
        };
        let found = Calibration::fit(&self.pairs)?;
        if let Some(path) = &self.out {
            let after = found.put_into(&before).map_err(anyhow::Error::msg)?;
            // What the reader would refuse is not written.
            RigFile::parse(&after, path)?;
            output::check_free(path, self.force)?;
            // Written aside and renamed: a full disk must not cost the rig file that is replaced.
            let aside = path.with_added_extension("new");
            output::write_file(&aside, true, &after)?;
            std::fs::rename(&aside, path).with_context(|| {
                format!("{path:?} cannot be written; the result is in {aside:?}")
            })?;
            self.talk.say(format_args!("wrote {}", path.display()));
        }
        self.talk.result(describe(&found), &found)
    }
}

fn describe(found: &Calibration) -> String {
    let [low, high] = found.degrees_per_count_interval;
    let level = LEVEL * 100.0;
    format!(
        "degrees_per_count = {:.7}   # {low:.7} to {high:.7} with {level} % confidence\n\
         zero_counts = {:.1}   # ±{:.1} with {level} % confidence\n\
         zero_sd_deg = {:.4}\n\
         scale_sd_percent = {:.4}\n\
         The reading farthest from a straight line is {:.3} degrees off it ({} readings).\n",
        found.degrees_per_count,
        found.zero_counts,
        found.zero_counts_half_width,
        found.zero_sd_deg,
        found.scale_sd_percent,
        found.largest_residual_deg,
        found.readings
    )
}
