//! `servoid calibrate`

mod protractor;
mod rig_file_backup;
mod text;

use super::output::{Output, print_remark, typed_path, wrong_usage};
use super::rig_args::{FOUND, RigArgs, RigSource, require_clock};
use super::{ctrl_c, prompts};
use crate::data::DegreeScale;
use crate::data::recording::write_file;
use crate::data::rig_file::{RigFile, SensorSection};
use crate::instrument::calibration::{
    Calibration, DOUBT_PERCENT, Found, Measured, Mover, Reading, Rest, Travel, doubts,
    mistyped_angle, moved_zero, put_into, require_followed, swapped_angles,
};
use crate::instrument::port;
use crate::instrument::rig::RigClient;
use anyhow::{Context, Result, bail};
use clap::{Args, ValueHint};
pub(super) use rig_file_backup::keep_aside;
use servoid_protocol::PulseWidth;
use std::path::{Path, PathBuf};

/// Measure the sensor's scale and zero, and the servo's neutral, scale and travel, with intervals
///
/// The servo goes to a few positions. At each you read its angle on a protractor, and the rig reads the sensor's
/// counts. Then a slow staircase over all pulses within the limits finds the degrees per microsecond, neutral,
/// and the ends of the travel. Angles are taken as exact: errors in them show as scatter around the line, and
/// count as nonlinearity of the sensor.
///
/// Without a terminal, --angles gives the angles. Without a rig, --pairs gives angles and the counts that
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
    /// Positions for the angles, as pulses (µs) [default: five within the limits]
    #[arg(long, value_name = "US", value_delimiter = ',', conflicts_with_all = ["pairs", "travel_only"])]
    pulses: Vec<u16>,
    /// Angles at these positions (degrees), in their order; then nothing is asked
    #[arg(
        long,
        value_name = "DEGREES",
        value_delimiter = ',',
        allow_hyphen_values = true,
        value_parser = super::value_parsers::finite,
        conflicts_with_all = ["pairs", "by_servo", "travel_only"]
    )]
    angles: Vec<f64>,
    /// Without a protractor: assume the angles that the pulses command, at the microseconds per degree of the rig
    /// file. The result is labelled as assumed, with a standard deviation of 5 % on its scale
    #[arg(long, conflicts_with_all = ["pairs", "travel_only"])]
    by_servo: bool,
    /// Leave the sensor's scale as it is in the rig file
    #[arg(long, conflicts_with_all = ["pairs", "no_travel"])]
    travel_only: bool,
    /// Leave out the slow staircase
    #[arg(long, conflicts_with = "pairs")]
    no_travel: bool,
    /// Readings without a rig: degrees=counts, separated by commas
    #[arg(
        long,
        value_delimiter = ',',
        allow_hyphen_values = true,
        value_name = "DEGREES=COUNTS",
        value_parser = reading
    )]
    pairs: Vec<Reading>,
    /// The rig file to write: a copy of the one that is read, with the result
    #[arg(long, short, value_name = "RIG.toml", value_hint = ValueHint::FilePath)]
    out: Option<PathBuf>,
    /// Write the result into the rig file that is read; its comments and other lines stay, and the file as it was is
    /// kept beside it
    #[arg(long, conflicts_with = "out")]
    update: bool,
    /// Write the result even where it disagrees with the rig file
    #[arg(long)]
    yes: bool,
    #[command(flatten)]
    output: Output,
}

/// Default number of positions.
const POSITIONS: i32 = 5;

/// Outermost positions, as a part of the room within the limits: the ends of a protractor are hard to read.
const REACH: f64 = 0.8;

fn reading(text: &str) -> Result<Reading, String> {
    let number = |text: &str| text.trim().parse::<f64>().ok();
    text.split_once('=')
        .and_then(|(angle, counts)| Some((number(angle)?, number(counts)?)))
        .map(|(angle_deg, counts)| Reading { angle_deg, counts })
        .ok_or_else(|| "it must be an angle and its counts, such as -20=6008".to_owned())
}

impl Calibrate {
    pub(super) fn run(self) -> Result<String> {
        let mut before = String::new();
        let source = match self.pairs.is_empty() {
            true => self.rig.source(self.output.talk)?,
            false => self.rig.unmoved(self.output.talk)?,
        };
        if let Some(path) = &source.path {
            let text = std::fs::read_to_string(path);
            before = text.with_context(|| format!("the rig file {path:?} cannot be read"))?;
        } else if self.update {
            wrong_usage("--update needs a rig file: name it with --rig");
        }
        self.output.check(&self.out)?;
        let mut measured = if self.pairs.is_empty() {
            self.measure(&source)?
        } else {
            Measured {
                sensor: Some(line(&self.pairs)?),
                assumed: false,
                readings: self.pairs.clone(),
                rests: Vec::new(),
                travel: None,
                doubts: Vec::new(),
                moved_zero: None,
            }
        };
        let sensor = measured.sensor.as_ref().filter(|_| !measured.assumed);
        measured.moved_zero = sensor.and_then(|found| moved_zero(found, &source.file.sensor));
        measured.doubts = doubts(&measured, &source.file, &self.positions(&source.file));
        let text = text::describe(&measured);
        let asked = self.asks_for_angles() && self.out.is_none() && !self.update;
        let target = match (&self.out, &source.path) {
            (Some(out), _) => Some(out),
            (None, Some(rig)) if self.update => Some(rig),
            (None, Some(rig)) if asked => {
                print_remark(&text);
                prompts::confirm(&format!("Put this into {}", rig.display()))?.then_some(rig)
            }
            _ => None,
        };
        if let Some(path) = target.filter(|_| !asked && !self.yes && !measured.doubts.is_empty()) {
            self.require_consent(path, &text)?;
        }
        match target {
            Some(path) => {
                self.write(path, &before, &measured)
                    .inspect_err(|_| print_remark(&text))?;
                self.output.talk.say(format_args!("rig file: {}", path.display()));
            }
            None if asked => {
                // Reading them took minutes.
                print_remark(protractor::so_far(&measured.readings));
                print_remark("nothing was written, because the answer was no");
            }
            None => self.output.talk.say("nothing was written: add --update to write into the rig file, or -o RIG.toml for another one"),
        }
        // At the terminal it was printed before the question.
        let printed = asked && source.path.is_some();
        let mut text = if printed { String::new() } else { text };
        text.extend(target.map(|path| self.output.talk.next(next(path, &source.file))));
        self.output.talk.result(text, &measured)
    }

    /// Fails unless somebody at the terminal wants a doubtful result in the file at `path`.
    fn require_consent(&self, path: &Path, text: &str) -> Result<()> {
        print_remark(text);
        let question = format!("Write into {} all the same", path.display());
        if prompts::is_terminal() && prompts::confirm(&question)? {
            return Ok(());
        }
        bail!(
            "nothing was written, because the result is doubtful or disagrees with the rig file (see above): check the angles, or add --yes to write it all the same"
        );
    }

    /// Whether somebody at the terminal reads the angles.
    fn asks_for_angles(&self) -> bool {
        self.pairs.is_empty() && self.angles.is_empty() && !self.by_servo && !self.travel_only
    }

    fn measure(&self, source: &RigSource) -> Result<Measured> {
        let rig = self.rig.require(source.file.clone())?;
        let pulses = self.positions(&rig.file);
        if self.asks_for_angles() && port::is_simulated(&rig.address) {
            self.output.talk.say(
                "the servo is simulated, and there is no protractor to read: answer with the angle that the pulse asks for, or leave with Ctrl-C and take --by-servo",
            );
        }
        if !self.angles.is_empty() && self.angles.len() != pulses.len() {
            let angles = if self.angles.len() == 1 {
                "angle"
            } else {
                "angles"
            };
            wrong_usage(format_args!(
                "--angles has {} {angles} for {} positions ({} µs); give one for each",
                self.angles.len(),
                pulses.len(),
                text::listed(&pulses)
            ));
        }
        if self.asks_for_angles() {
            if !prompts::is_terminal() {
                bail!(
                    "no angles can be asked for, because there is no terminal: give them with --angles, assume those that the pulses command with --by-servo, or leave the sensor's scale as it is with --travel-only"
                );
            }
            print_remark(self.intention(&rig.file, &pulses));
            if !prompts::confirm("May it move")? {
                bail!("the servo was not moved, because the answer was no");
            }
        }
        ctrl_c::listen_in_a_run()?;
        let client = RigClient::connect_beside(port::open(&rig.address)?, &rig.address)?;
        require_clock(rig.inexact_clock, client.hello())?;
        let mut mover = Mover::new(client, rig.file.clone(), &ctrl_c::asked);
        let (readings, rests) = if self.travel_only {
            Default::default()
        } else {
            self.readings(&mut mover, &pulses, port::is_simulated(&rig.address))?
        };
        let sensor = match readings.as_slice() {
            [] => None,
            some => Some(self.fit(some, &rests)?),
        };
        let mut travel = None;
        if !self.no_travel {
            self.output
                .talk
                .say("running a slow staircase over the limits ...");
            let scale = scale(&rig.file.sensor, sensor.as_ref());
            travel = Some(Travel::measure(&mut mover, &scale)?);
        }
        Ok(Measured {
            sensor,
            assumed: self.by_servo,
            readings,
            rests,
            travel,
            doubts: Vec::new(),
            moved_zero: None,
        })
    }

    /// The scale from these readings. Commanded angles are valid only if the servo has followed. If the fit of
    /// measured angles fails, a servo that has not followed is the likelier reason.
    fn fit(&self, readings: &[Reading], rests: &[Rest]) -> Result<Calibration> {
        if self.by_servo {
            require_followed(rests)?;
            return Ok(Calibration::fit(readings)?.with_doubtful_angles(DOUBT_PERCENT));
        }
        let fit = line(readings);
        if fit.is_err() {
            require_followed(rests)?;
            print_remark(protractor::so_far(readings));
        }
        fit
    }

    /// The motion that is about to start.
    fn intention(&self, rig: &RigFile, pulses: &[u16]) -> String {
        let [shortest, longest] = [rig.limits.shortest_us, rig.limits.longest_us];
        let then = match self.no_travel {
            true => String::new(),
            false => format!(", and then slowly from {shortest} to {longest} µs"),
        };
        format!("The servo goes to {} µs{then}.", text::listed(pulses))
    }

    /// The pulses at which the sensor is read (µs).
    fn positions(&self, rig: &RigFile) -> Vec<u16> {
        if !self.pulses.is_empty() {
            return self.pulses.clone();
        }
        let neutral = f64::from(rig.servo.neutral_us);
        let half = (POSITIONS - 1) / 2;
        let position = |k: i32| {
            let limits = &rig.limits;
            let limit = if k < 0 {
                limits.shortest_us
            } else {
                limits.longest_us
            };
            let way = REACH * (f64::from(limit) - neutral).abs();
            (neutral + way * f64::from(k) / f64::from(half)).round() as u16
        };
        (-half..=half).map(position).collect()
    }

    /// The sensor's counts at known angles.
    fn readings(
        &self,
        mover: &mut Mover<'_>,
        pulses: &[u16],
        is_simulated: bool,
    ) -> Result<(Vec<Reading>, Vec<Rest>)> {
        if self.asks_for_angles() {
            return protractor::read(mover, pulses, is_simulated);
        }
        let rests = mover.visit(pulses, &|_| false)?;
        let scale = DegreeScale::of_rig(mover.rig());
        let commanded = pulses.iter().map(|us| scale.reference(PulseWidth(*us)));
        let angles: Vec<f64> = match self.by_servo {
            true => commanded.collect(),
            false => self.angles.clone(),
        };
        let counts = rests.iter().map(|rest| rest.counts);
        let readings = angles.into_iter().zip(counts);
        let readings = readings.map(|(angle_deg, counts)| Reading { angle_deg, counts });
        Ok((readings.collect(), rests))
    }

    /// Writes the rig file with the result to `path`.
    fn write(&self, path: &Path, before: &str, measured: &Measured) -> Result<()> {
        let assumed = measured.assumed;
        let sensor = measured.sensor.as_ref();
        let remark = sensor.map(|fit| text::remark(fit, assumed));
        let travel = measured.travel.as_ref().filter(|_| !assumed);
        let found = Found {
            sensor: sensor.zip(remark.as_deref()),
            us_per_degree: travel.map(|travel| travel.us_per_degree),
            // Pulses, which need no angles.
            limits_us: measured
                .travel
                .as_ref()
                .map(Travel::before_stops_us)
                .unwrap_or_default(),
        };
        let after = put_into(before, &found).map_err(anyhow::Error::msg)?;
        // A file that could not be read back is not written.
        RigFile::parse(&after, path)?;
        if let Some(kept) = keep_aside(path)? {
            self.output
                .talk
                .say(format_args!("as it was: {}", kept.display()));
        }
        let force = self.output.force || self.update || self.asks_for_angles();
        Ok(write_file(path, force, &after)?)
    }
}

/// The line through the readings; where they have none, the angle that may be why is named.
fn line(readings: &[Reading]) -> Result<Calibration> {
    let fit = Calibration::fit(readings);
    let angle = mistyped_angle(readings).filter(|_| fit.is_err());
    angle.iter().for_each(print_remark);
    let swapped = swapped_angles(readings).filter(|_| fit.is_err());
    swapped.iter().for_each(print_remark);
    Ok(fit?)
}

/// The command that uses the rig file at `path`.
fn next(path: &Path, rig: &RigFile) -> String {
    let named = match path == Path::new(FOUND) {
        true => String::new(),
        false => format!(" --rig {}", typed_path(path)),
    };
    let port = match rig.port {
        Some(_) => "",
        None => " --port PORT",
    };
    let condition = rig.condition.as_deref().unwrap_or("bench");
    let file = typed_path(Path::new(&format!("{condition}.csv")));
    format!("servoid capture{named}{port} -o {file}")
}

/// The sensor of the rig file, with the new scale if there is one.
fn scale(sensor: &SensorSection, found: Option<&Calibration>) -> SensorSection {
    let Some(found) = found else {
        return sensor.clone();
    };
    SensorSection {
        zero_counts: found.zero_counts,
        degrees_per_count: found.degrees_per_count,
        zero_sd_deg: found.zero_sd_deg,
        scale_sd_percent: found.scale_sd_percent,
        ..sensor.clone()
    }
}
