//! `servoid calibrate`

mod protractor;
mod text;

use super::rig_args::RigArgs;
use super::{Talk, ask, interrupt, wrong_usage};
use crate::commands::output_files;
use crate::data::rig_file::RigFile;
use crate::data::rig_file::SensorSection;
use crate::instrument::calibration::{
    Calibration, Estimate, Found, LEVEL, Mover, Reading, Rest, Travel, put_into, require_followed,
};
use crate::instrument::port;
use crate::instrument::rig::RigClient;
use anyhow::{Context, Result, bail};
use clap::{Args, ValueHint};
use serde::Serialize;
use servoid_protocol::PulseWidth;
use std::path::{Path, PathBuf};

/// Measure the sensor's scale and zero, the servo's neutral, scale and travel, and how well they are known
///
/// The servo goes to some positions; at each you read its angle on a protractor, and the sensor's counts
/// come from the rig. Then a slow staircase over all pulses that the limits allow shows what a microsecond
/// does, where neutral is, and whether the travel ends within the limits. Angles are taken as exact; what is
/// wrong with them shows as scatter around the line, and counts as the sensor's nonlinearity.
///
/// Without a terminal the angles come from --angles. Without a rig, --pairs takes angles and the counts that
/// 'servoid info' shows at each.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  servoid calibrate --rig rig.toml
  servoid calibrate --port sim:bench --by-servo -o rig.toml
  servoid calibrate --port sim:bench --pulses 1300,1400,1500,1600,1700 --angles=-20,-10,0,10,20
  servoid calibrate --rig rig.toml --travel-only --update
  servoid calibrate --pairs=-20=6008,-10=7100,0=8192,10=9284,20=10377 -o rig.toml")]
pub(super) struct Calibrate {
    #[command(flatten)]
    rig: RigArgs,
    /// The positions at which angles are read, as pulses (µs) [default: five within the limits]
    #[arg(long, value_name = "US", value_delimiter = ',', conflicts_with_all = ["pairs", "travel_only"])]
    pulses: Vec<u16>,
    /// The angles at these positions (degrees), in their order: nothing is asked
    #[arg(
        long,
        value_name = "DEGREES",
        value_delimiter = ',',
        allow_hyphen_values = true,
        conflicts_with_all = ["pairs", "by_servo", "travel_only"]
    )]
    angles: Vec<f64>,
    /// No protractor: take the angles that the pulses command, at the microseconds per degree of the rig
    /// file. The result is labelled as assumed, with 5 % of doubt on its scale
    #[arg(long, conflicts_with_all = ["pairs", "travel_only"])]
    by_servo: bool,
    /// Leave the sensor's scale as the rig file has it
    #[arg(long, conflicts_with_all = ["pairs", "no_travel"])]
    travel_only: bool,
    /// Leave out the slow staircase
    #[arg(long, conflicts_with = "pairs")]
    no_travel: bool,
    /// The readings, with no rig: degrees=counts, with commas between them
    #[arg(
        long,
        value_delimiter = ',',
        allow_hyphen_values = true,
        value_name = "DEGREES=COUNTS",
        value_parser = reading
    )]
    pairs: Vec<Reading>,
    /// The rig file to write: that of --rig with the result in it
    #[arg(long, short, value_name = "RIG.toml", value_hint = ValueHint::FilePath)]
    out: Option<PathBuf>,
    /// Put the result into the rig file itself; its comments and all else stay
    #[arg(long, requires = "rig", conflicts_with = "out")]
    update: bool,
    /// Replace the file of --out if it exists
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    talk: Talk,
}

/// Standard deviation of what a servo's maker says of microseconds per degree (percent): makers round, and
/// servos of one type differ by some percent.
const DOUBT_PERCENT: f64 = 5.0;

/// How many positions are read by default.
const POSITIONS: i32 = 5;

/// How far out they go, of the room that the limits leave: a protractor's ends are hard to read.
const REACH: f64 = 0.8;

/// The result as `--json` prints it.
#[derive(Serialize)]
struct Measured {
    /// The sensor's scale; `None` where it was left as it was.
    sensor: Option<Calibration>,
    /// Whether the angles behind it are those that the pulses command.
    assumed: bool,
    /// The readings behind it.
    readings: Vec<Reading>,
    /// What the sensor did at each position, where a rig was asked.
    rests: Vec<Rest>,
    travel: Option<Travel>,
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
        let before = match &self.rig.rig {
            Some(path) => {
                RigFile::read(path)?;
                std::fs::read_to_string(path)
                    .with_context(|| format!("the rig file {path:?} cannot be read"))?
            }
            None => String::new(),
        };
        if let Some(out) = &self.out {
            output_files::check_free(out, self.force)?;
        }
        let measured = if self.pairs.is_empty() {
            self.measure()?
        } else {
            Measured {
                sensor: Some(Calibration::fit(&self.pairs)?),
                assumed: false,
                readings: self.pairs.clone(),
                rests: Vec::new(),
                travel: None,
            }
        };
        let text = text::describe(&measured);
        let asked = self.asks() && self.out.is_none() && !self.update;
        let target = match (&self.out, &self.rig.rig) {
            (Some(out), _) => Some(out),
            (None, Some(rig)) if self.update => Some(rig),
            (None, Some(rig)) if asked => {
                output_files::tell(&text);
                ask::confirm(&format!("Put this into {}", rig.display()), true)?.then_some(rig)
            }
            _ => None,
        };
        match target {
            Some(path) => {
                self.write(path, &before, &measured)?;
                self.talk.say(format_args!("wrote {}", path.display()));
            }
            None => self.talk.say("nothing was written: --update puts it into the rig file of --rig, -o RIG.toml into another one"),
        }
        // At the terminal it has been said before the question.
        let text = if asked && target.is_some() {
            String::new()
        } else {
            text
        };
        self.talk.result(text, &measured)
    }

    /// Whether angles are read by somebody at the terminal.
    fn asks(&self) -> bool {
        self.pairs.is_empty() && self.angles.is_empty() && !self.by_servo && !self.travel_only
    }

    fn measure(&self) -> Result<Measured> {
        let rig = self.rig.require()?;
        let pulses = self.positions(&rig.file);
        if !self.angles.is_empty() && self.angles.len() != pulses.len() {
            wrong_usage(format_args!(
                "--angles has {} angles for {} positions: {}",
                self.angles.len(),
                pulses.len(),
                text::listed(&pulses)
            ));
        }
        if self.asks() {
            if !ask::is_terminal() {
                bail!(
                    "there is no terminal to ask for angles at: give them with --angles, take those that the pulses command with --by-servo, or leave the sensor's scale as it is with --travel-only"
                );
            }
            output_files::tell(self.intention(&rig.file, &pulses));
            if !ask::confirm("May it move", false)? {
                bail!("the servo was not moved");
            }
        }
        interrupt::listen()?;
        let client = RigClient::connect_beside(port::open(&rig.address)?, &rig.address)?;
        let mut mover = Mover::new(client, rig.file.clone(), &interrupt::asked);
        let (readings, rests) = if self.travel_only {
            Default::default()
        } else {
            self.readings(&mut mover, &pulses)?
        };
        let sensor = match readings.as_slice() {
            [] => None,
            some => Some(self.fit(some, &rests)?),
        };
        let travel = if self.no_travel {
            None
        } else {
            self.talk.say("a slow staircase over the limits ...");
            Some(Travel::measure(
                &mut mover,
                &scale(&rig.file.sensor, sensor.as_ref()),
            )?)
        };
        Ok(Measured {
            sensor,
            assumed: self.by_servo,
            readings,
            rests,
            travel,
        })
    }

    /// The scale by these readings. Where there is none, a servo that has not followed is the likelier
    /// reason; and the angles that pulses command are those of a servo that has.
    fn fit(&self, readings: &[Reading], rests: &[Rest]) -> Result<Calibration> {
        if self.by_servo {
            require_followed(rests)?;
            return Ok(Calibration::fit(readings)?.with_doubtful_angles(DOUBT_PERCENT));
        }
        let fit = Calibration::fit(readings);
        if fit.is_err() {
            require_followed(rests)?;
        }
        Ok(fit?)
    }

    /// What the servo is about to do.
    fn intention(&self, rig: &RigFile, pulses: &[u16]) -> String {
        let positions = format!("The servo goes to {} µs", text::listed(pulses));
        match self.no_travel {
            true => format!("{positions}."),
            false => format!(
                "{positions}, and then slowly from {} to {} µs.",
                rig.limits.shortest_us, rig.limits.longest_us
            ),
        }
    }

    /// The pulses at which the sensor is read (µs).
    fn positions(&self, rig: &RigFile) -> Vec<u16> {
        if !self.pulses.is_empty() {
            return self.pulses.clone();
        }
        let neutral = f64::from(rig.servo.neutral_us);
        let half = (POSITIONS - 1) / 2;
        let position = |k: i32| {
            let limit = if k < 0 {
                rig.limits.shortest_us
            } else {
                rig.limits.longest_us
            };
            let way = REACH * (f64::from(limit) - neutral).abs();
            (neutral + way * f64::from(k) / f64::from(half)).round() as u16
        };
        (-half..=half).map(position).collect()
    }

    /// The sensor's counts at known angles.
    fn readings(&self, mover: &mut Mover<'_>, pulses: &[u16]) -> Result<(Vec<Reading>, Vec<Rest>)> {
        if self.asks() {
            return protractor::read(mover, pulses);
        }
        let rests = mover.visit(pulses, &|_| false)?;
        let scale = mover.rig().servo_scale();
        let angles: Vec<f64> = match self.by_servo {
            true => pulses
                .iter()
                .map(|us| scale.degrees(PulseWidth(*us)).0)
                .collect(),
            false => self.angles.clone(),
        };
        let pairs = angles.into_iter().zip(&rests);
        let readings = pairs.map(|(angle_deg, rest)| Reading {
            angle_deg,
            counts: rest.counts,
        });
        Ok((readings.collect(), rests))
    }

    /// Puts the result into the text of the rig file, and that into `path`.
    fn write(&self, path: &Path, before: &str, measured: &Measured) -> Result<()> {
        let remark = measured
            .sensor
            .as_ref()
            .map(|fit| text::remark(fit, measured.assumed));
        let us_per_degree = measured.travel.as_ref().filter(|_| !measured.assumed);
        let found = Found {
            sensor: measured.sensor.as_ref().zip(remark.as_deref()),
            us_per_degree: us_per_degree.map(|travel| travel.us_per_degree),
        };
        let after = put_into(before, &found).map_err(anyhow::Error::msg)?;
        // What the reader would refuse is not written.
        RigFile::parse(&after, path)?;
        output_files::write_file(path, self.force || self.update || self.asks(), &after)
    }
}

/// The sensor of the rig file with the scale that was found.
fn scale(sensor: &SensorSection, found: Option<&Calibration>) -> SensorSection {
    match found {
        Some(found) => SensorSection {
            zero_counts: found.zero_counts,
            degrees_per_count: found.degrees_per_count,
            zero_sd_deg: found.zero_sd_deg,
            scale_sd_percent: found.scale_sd_percent,
            ..sensor.clone()
        },
        None => sensor.clone(),
    }
}
