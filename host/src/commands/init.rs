//! `servoid init`

use super::completion_values;
use super::output_args::Talk;
use super::ports;
use super::prompts::{Asker, Prompt};
use crate::commands::output_files;
use crate::commands::rig_wizard::{self, Range, RigAnswers};
use crate::data::rig_file::RigFile;
use anyhow::Result;
use clap::{Args, ValueHint};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Write the rig file of a new rig, from questions at the terminal or from options
///
/// Each question has an option. A question whose option is given is not asked; with --yes none is, which suits
/// scripts. Enter takes the answer in brackets.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  servoid init
  servoid init --yes --port sim:bench
  servoid init --condition aircraft --travel=-20:20 -o aircraft.toml
  servoid init --yes --servo \"ALIGN DS610\" --neutral 1520 --pulses 900:2100 -o bench.toml")]
pub(super) struct Init {
    /// The rig file to write
    #[arg(long, short, default_value = "rig.toml", value_name = "RIG.toml", value_hint = ValueHint::FilePath)]
    out: PathBuf,
    /// Replace the file if it exists
    #[arg(long)]
    force: bool,
    /// Ask nothing: take the default of every option that is not given
    #[arg(long, short)]
    yes: bool,
    #[command(flatten)]
    talk: Talk,
    #[command(flatten)]
    given: Given,
}

/// The answers that options give.
#[derive(Debug, Args)]
#[command(next_help_heading = "Answers")]
struct Given {
    /// Name of the rig [default: my rig]
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Port of the rig: a serial device, tcp:HOST:PORT, or sim:bench, sim:aircraft, sim:linear
    #[arg(long, short, value_parser = completion_values::port(), hide_possible_values = true)]
    port: Option<String>,
    /// Condition of the measurements: bench, aircraft, or your own words [default: bench]
    #[arg(long, value_name = "NAME", value_parser = completion_values::condition(), hide_possible_values = true)]
    condition: Option<String>,
    /// Name of the servo
    #[arg(long, value_name = "NAME")]
    servo: Option<String>,
    /// Shortest and longest pulse that the servo takes (µs) [default: 1000:2000]
    #[arg(long, value_name = "SHORTEST:LONGEST")]
    pulses: Option<Range>,
    /// Neutral: the pulse at 0 degrees (µs) [default: 1500]
    #[arg(long, value_name = "US")]
    neutral: Option<u16>,
    /// Change of the pulse for one degree (µs); negative where a longer pulse turns the servo towards negative
    /// angles [default: 10]
    #[arg(long, value_name = "US", allow_negative_numbers = true)]
    us_per_degree: Option<f64>,
    /// Travel of the linkage from neutral (degrees); sets the limits of all pulses [default: -10:10, twice the
    /// default amplitude of a reference]
    #[arg(long, value_name = "LOW:HIGH", allow_hyphen_values = true)]
    travel: Option<Range>,
    /// Name of the sensor [default: Honeywell RTY120]
    #[arg(long, value_name = "NAME")]
    sensor: Option<String>,
    /// Output of the sensor at the ends of its range (V) [default: 0.5:4.5]
    #[arg(long, value_name = "LOW:HIGH")]
    sensor_volts: Option<Range>,
    /// Angle between these two outputs (degrees); negative where the output falls as the angle grows [default: 120]
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    sensor_degrees: Option<f64>,
}

/// The result as `--json` prints it.
#[derive(Serialize)]
struct Written<'a> {
    file: &'a Path,
    rig: &'a RigFile,
    next: &'a str,
}

impl Init {
    pub(super) fn run(self) -> Result<String> {
        output_files::check_free(&self.out, self.force)?;
        let asker = Asker::new(
            self.yes,
            "add --yes, and an option for each answer that differs from its default ('servoid init --help' lists them)",
        )?;
        let answers = self.given.complete(&asker, self.talk)?;
        let (text, rig) = answers.to_rig_file(&self.out)?;
        output_files::write_file(&self.out, self.force, &text)?;
        let file = self.out.display();
        let next = match &answers.port {
            Some(_) => format!("servoid calibrate --rig {file}"),
            None => "servoid ports".to_owned(),
        };
        let written = Written {
            file: &self.out,
            rig: &rig,
            next: &next,
        };
        let text = format!(
            "{file}: written\nlimits: {} to {} µs. {}\nnext: {next}\n",
            rig.limits.shortest_us,
            rig.limits.longest_us,
            answers.travel_in_words()
        );
        self.talk.result(text, &written)
    }
}

/// Errors for answers that are not of the right type.
const NUMBER: &str = "a number is needed, such as 10 or -9.5";
const MICROSECONDS: &str = "whole microseconds are needed, such as 1500";
const TWO_NUMBERS: &str =
    "two numbers with a colon between them are needed, the smaller one first, such as -20:20";
const TEXT: &str = "a name is needed";

impl Given {
    /// Every answer, from the options and the asker.
    fn complete(self, asker: &Asker, talk: Talk) -> Result<RigAnswers> {
        let mut answers = RigAnswers::default();
        self.ask_names(asker, talk, &mut answers)?;
        self.ask_servo(asker, &mut answers)?;
        self.ask_sensor(asker, &mut answers)?;
        Ok(answers)
    }

    fn ask_names(&self, asker: &Asker, talk: Talk, answers: &mut RigAnswers) -> Result<()> {
        let name = |name: &String| rig_wizard::check_name(name);
        answers.name = asker.ask(
            self.name.clone(),
            &Prompt {
                option: "--name",
                text: "Name of the rig",
                default: answers.name.clone(),
                form: TEXT,
                check: &name,
            },
        )?;
        answers.condition = asker.ask(
            self.condition.clone(),
            &Prompt {
                option: "--condition",
                text: "Condition (bench, aircraft, or your own words)",
                default: answers.condition.clone(),
                form: TEXT,
                check: &|name| rig_wizard::check_condition(name),
            },
        )?;
        answers.port = match &self.port {
            Some(port) => Some(port.clone()),
            None => ask_port(asker, talk)?,
        };
        answers.servo = asker.ask(
            self.servo.clone(),
            &Prompt {
                option: "--servo",
                text: "Name of the servo",
                default: answers.servo.clone(),
                form: TEXT,
                check: &name,
            },
        )?;
        Ok(())
    }

    fn ask_servo(&self, asker: &Asker, answers: &mut RigAnswers) -> Result<()> {
        answers.pulses_us = asker.ask(
            self.pulses,
            &Prompt {
                option: "--pulses",
                text: "Shortest and longest pulse that the servo takes (µs)",
                default: answers.pulses_us,
                form: TWO_NUMBERS,
                check: &rig_wizard::check_pulses,
            },
        )?;
        answers.neutral_us = asker.ask(
            self.neutral,
            &Prompt {
                option: "--neutral",
                text: "Pulse at 0 degrees, neutral (µs)",
                default: answers.neutral_us,
                form: MICROSECONDS,
                check: &|us| rig_wizard::check_neutral(*us, &answers.pulses_us),
            },
        )?;
        answers.us_per_degree = asker.ask(
            self.us_per_degree,
            &Prompt {
                option: "--us-per-degree",
                text: "µs for one degree (negative: longer pulses turn it to negative angles)",
                default: answers.us_per_degree,
                form: NUMBER,
                check: &|us| rig_wizard::check_us_per_degree(*us),
            },
        )?;
        answers.travel_deg = asker.ask(
            self.travel,
            &Prompt {
                option: "--travel",
                text: "Travel of the linkage from neutral (degrees)",
                default: answers.travel_deg,
                form: TWO_NUMBERS,
                check: &rig_wizard::check_travel,
            },
        )?;
        Ok(())
    }

    fn ask_sensor(&self, asker: &Asker, answers: &mut RigAnswers) -> Result<()> {
        answers.sensor = asker.ask(
            self.sensor.clone(),
            &Prompt {
                option: "--sensor",
                text: "Name of the angle sensor",
                default: answers.sensor.clone(),
                form: TEXT,
                check: &|name| rig_wizard::check_name(name),
            },
        )?;
        answers.sensor_volts = asker.ask(
            self.sensor_volts,
            &Prompt {
                option: "--sensor-volts",
                text: "Output of the sensor at the ends of its range (V)",
                default: answers.sensor_volts,
                form: TWO_NUMBERS,
                check: &rig_wizard::check_volts,
            },
        )?;
        answers.sensor_degrees = asker.ask(
            self.sensor_degrees,
            &Prompt {
                option: "--sensor-degrees",
                text: "Degrees between these outputs (negative: the output falls)",
                default: answers.sensor_degrees,
                form: NUMBER,
                check: &|degrees| rig_wizard::check_sensor_degrees(*degrees),
            },
        )?;
        Ok(())
    }
}

/// The port of the rig, chosen from those that answer and others; `None` where it is not known yet.
fn ask_port(asker: &Asker, talk: Talk) -> Result<Option<String>> {
    if matches!(asker, Asker::Nobody) {
        return Ok(None);
    }
    talk.say("searching all serial ports for rigs ...");
    let found = ports::find().unwrap_or_default();
    talk.say(ports::summary(&found));
    let mut items: Vec<String> = found.iter().map(ports::PortProbe::item).collect();
    let simulated = "sim:bench";
    items.push(format!("{simulated}: no hardware, a simulated servo"));
    items.push("another port, to be typed".into());
    items.push("not known yet".into());
    // Enter takes a rig that has answered. A silent port has to be chosen on purpose.
    let usual = match found.first() {
        Some(port) if port.answers() => 0,
        _ => items.len() - 1,
    };
    let chosen = asker.choose("Port of the rig", &items, usual)?;
    if let Some(port) = found.into_iter().nth(chosen) {
        return Ok(Some(port.port));
    }
    match items.len() - chosen {
        3 => Ok(Some(simulated.into())),
        2 => {
            let port = asker.ask(
                None,
                &Prompt {
                    option: "--port",
                    text: "Serial device or tcp:HOST:PORT",
                    default: "/dev/ttyUSB0".to_owned(),
                    form: TEXT,
                    check: &|port| rig_wizard::check_name(port),
                },
            )?;
            Ok(Some(port))
        }
        _ => Ok(None),
    }
}
