//! `servoid init`

use super::calibrate::keep_aside;
use super::completion_values;
use super::ctrl_c;
use super::output::{Output, Talk, typed_path};
use super::ports;
use super::prompts::Asker;
use super::rig_args::FOUND;
use super::rig_remarks::scale_of_another_rig;
use super::rig_wizard::{
    Range, RigAnswers, check_condition, check_delay, check_name, check_neutral, check_pulse_rate,
    check_pulses, check_sensor_degrees, check_travel, check_us_per_degree, check_volts,
};
use crate::data::rig_file::{PulseTypeName, RigFile};
use crate::data::sensor_preset::SensorKind;
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
  servoid init --sensor-kind as5600
  servoid init --pulse-rate 333
  servoid init --pulse-type narrow --pulse-rate 560
  servoid init --travel=-20:20
  servoid init --yes --servo \"ALIGN DS610\" --neutral 1520 --pulses 900:2100 -o bench.toml")]
pub(super) struct Init {
    /// The rig file to write
    #[arg(long, short, default_value = FOUND, value_name = "RIG.toml", value_hint = ValueHint::FilePath)]
    out: PathBuf,
    /// Ask nothing: take the default of every option that is not given
    #[arg(long, short)]
    yes: bool,
    #[command(flatten)]
    output: Output,
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
    /// Condition of the measurements: bench, aircraft, or your own words [default: bench; with --port sim:aircraft: aircraft]
    #[arg(long, value_name = "NAME", value_parser = completion_values::condition(), hide_possible_values = true)]
    condition: Option<String>,
    /// Name of the servo
    #[arg(long, value_name = "NAME")]
    servo: Option<String>,
    /// Kind of pulses that the servo understands: wide, or narrow for a servo whose neutral is about 760 µs [default: wide]
    #[arg(long, value_name = "TYPE")]
    pulse_type: Option<PulseTypeName>,
    /// Pulses in a second (Hz): 50 for an analogue servo, up to 333 for a digital one, and up to 560 for narrow pulses
    /// [default: 50]
    #[arg(long, value_name = "HZ", value_parser = super::value_parsers::finite)]
    pulse_rate: Option<f64>,
    /// Shortest and longest pulse that the servo takes (µs) [default: 1000:2000; narrow: 500:1000]
    #[arg(long, value_name = "SHORTEST:LONGEST")]
    pulses: Option<Range>,
    /// Neutral: the pulse at 0 degrees (µs) [default: 1500; narrow: 760]
    #[arg(long, value_name = "US", value_parser = super::value_parsers::whole)]
    neutral: Option<u16>,
    /// Change of the pulse for one degree (µs); negative where a longer pulse turns the servo towards negative
    /// angles [default: 10; narrow: 5]
    #[arg(long, value_name = "US", allow_negative_numbers = true, value_parser = super::value_parsers::finite)]
    us_per_degree: Option<f64>,
    /// Travel of the linkage from neutral (degrees); sets the limits of all pulses [default: -10:10, twice the
    /// default amplitude of a reference]
    #[arg(long, value_name = "LOW:HIGH", allow_hyphen_values = true)]
    travel: Option<Range>,
    /// Kind of sensor: rty, as5600, as5600-fast, linear or potentiometer; sets the defaults of all that follows [default: rty]
    #[arg(long, value_name = "KIND")]
    sensor_kind: Option<SensorKind>,
    /// Name of the sensor [default: that of its kind]
    #[arg(long, value_name = "NAME")]
    sensor: Option<String>,
    /// Output of the sensor at the ends of its range (V) [default: that of its kind]
    #[arg(long, value_name = "LOW:HIGH")]
    sensor_volts: Option<Range>,
    /// Angle between these two outputs (degrees); negative where the output falls as the angle grows [default: that of its
    /// kind]
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, value_parser = super::value_parsers::finite)]
    sensor_degrees: Option<f64>,
    /// Time by which the sensor's reading lags behind the shaft (ms) [default: that of its kind]
    #[arg(long, value_name = "MS", value_parser = super::value_parsers::finite)]
    sensor_delay: Option<f64>,
    /// How far the true delay may be from that (ms) [default: that of its kind]
    #[arg(long, value_name = "MS", value_parser = super::value_parsers::finite)]
    sensor_delay_uncertainty: Option<f64>,
}

/// The result as `--json` prints it.
#[derive(Serialize)]
struct Written<'a> {
    file: &'a PathBuf,
    rig: &'a RigFile,
    next: &'a str,
}

impl Init {
    pub(super) fn run(self) -> Result<String> {
        self.output.check([&self.out])?;
        let asker = Asker::new(
            self.yes,
            "add --yes, and an option for each answer that differs from its default ('servoid init --help' lists them)",
        )?;
        if matches!(asker, Asker::User(_)) {
            ctrl_c::listen_at_questions()?;
        }
        let answers = self.given.complete(&asker, self.output.talk)?;
        let (text, rig) = answers.to_rig_file(&self.out)?;
        let port = answers.port.as_deref();
        let remark = port.and_then(|address| scale_of_another_rig(address, &rig));
        (remark.into_iter()).for_each(|remark| self.output.talk.say(remark));
        if let Some(kept) = keep_aside(&self.out)? {
            self.output
                .talk
                .say(format_args!("as it was: {}", kept.display()));
        }
        self.output.write(&self.out, &text)?;
        let file = self.out.display();
        let next = match &answers.port {
            Some(_) if self.out == Path::new(FOUND) => "servoid calibrate".to_owned(),
            Some(_) => format!("servoid calibrate --rig {}", typed_path(&self.out)),
            None => "servoid ports".to_owned(),
        };
        let [shortest, longest] = [rig.limits.shortest_us, rig.limits.longest_us];
        let travel = answers.travel_in_words();
        let port = match &answers.port {
            Some(_) => "",
            None => {
                "port: none yet; write one of those that 'servoid ports' lists into the file, as port = \"...\"\n"
            }
        };
        let text = format!(
            "{file}: written\n{port}limits: {shortest} to {longest} µs. {travel}\nnext: {next}\n"
        );
        let (file, rig, next) = (&self.out, &rig, &next);
        self.output.talk.result(text, &Written { file, rig, next })
    }
}

/// A question: the option that answers it, and the words at the terminal.
type Question = (&'static str, &'static str);

const NAME: Question = ("--name", "Name of the rig");
const CONDITION: Question = (
    "--condition",
    "Condition (bench, aircraft, or your own words)",
);
const PORT: Question = ("--port", "Serial device or tcp:HOST:PORT");
const SERVO: Question = ("--servo", "Name of the servo");
const PULSE_TYPE: Question = (
    "--pulse-type",
    "Pulses of the servo: wide (neutral about 1500 µs), or narrow (about 760 µs)",
);
const PULSE_RATE: Question = (
    "--pulse-rate",
    "Pulses in a second (Hz): 50 suits every servo, digital ones take up to 333, narrow pulses up to 560",
);
const PULSES: Question = (
    "--pulses",
    "Shortest and longest pulse that the servo takes (µs)",
);
const NEUTRAL: Question = ("--neutral", "Pulse at 0 degrees, neutral (µs)");
const US_PER_DEGREE: Question = (
    "--us-per-degree",
    "µs for one degree (negative: longer pulses turn it to negative angles)",
);
const TRAVEL: Question = ("--travel", "Travel of the linkage from neutral (degrees)");
const SENSOR_KIND: &str = "Kind of the angle sensor (docs/wiring.md has a drawing for each)";
const SENSOR_DELAY: Question = (
    "--sensor-delay",
    "Time by which its reading lags behind the shaft (ms)",
);
const SENSOR_DELAY_UNCERTAINTY: Question = (
    "--sensor-delay-uncertainty",
    "How far the true delay may be from that (ms)",
);
const SENSOR: Question = ("--sensor", "Name of the angle sensor");
const VOLTS: Question = (
    "--sensor-volts",
    "Output of the sensor at the ends of its range (V)",
);
const SENSOR_DEGREES: Question = (
    "--sensor-degrees",
    "Degrees between these outputs (negative: the output falls)",
);

impl Given {
    /// Every answer, from the options and the asker.
    fn complete(self, asker: &Asker, talk: Talk) -> Result<RigAnswers> {
        let mut to = RigAnswers::default();
        if let Some(port) = &self.port {
            to.take_port(port);
        }
        asker.ask(self.name, NAME, &mut to.name, |name| check_name(name))?;
        asker.ask(self.condition, CONDITION, &mut to.condition, |name| {
            check_condition(name)
        })?;
        to.port = match self.port {
            Some(port) => Some(port),
            None => ask_port(asker, talk)?,
        };
        asker.ask(self.servo, SERVO, &mut to.servo, |name| check_name(name))?;
        // Wide pulses may break a narrow-pulse servo, so nobody gets them without having been asked.
        let mut pulse_type = to.pulse_type;
        asker.ask(self.pulse_type, PULSE_TYPE, &mut pulse_type, |_| Ok(()))?;
        to.take_pulse_type(pulse_type);
        let pulse_type = to.pulse_type;
        let rate = |hz: &f64| check_pulse_rate(*hz, pulse_type);
        asker.ask(self.pulse_rate, PULSE_RATE, &mut to.pulse_rate_hz, rate)?;
        let pulses = |pulses: &Range| check_pulses(pulses, pulse_type);
        asker.ask(self.pulses, PULSES, &mut to.pulses_us, pulses)?;
        let neutral = |us: &u16| check_neutral(*us, &to.pulses_us);
        asker.ask(self.neutral, NEUTRAL, &mut to.neutral_us, neutral)?;
        let scale = &mut to.us_per_degree;
        asker.ask(
            self.us_per_degree,
            US_PER_DEGREE,
            scale,
            check_us_per_degree,
        )?;
        asker.ask(self.travel, TRAVEL, &mut to.travel_deg, check_travel)?;
        to.take_sensor(match self.sensor_kind {
            Some(kind) => kind,
            None => ask_sensor_kind(asker)?,
        });
        let preset = to.sensor_kind.preset();
        asker.ask(self.sensor, SENSOR, &mut to.sensor, |name| check_name(name))?;
        let volts = |volts: &Range| check_volts(volts, &preset);
        asker.ask(self.sensor_volts, VOLTS, &mut to.sensor_volts, volts)?;
        let degrees = &mut to.sensor_degrees;
        asker.ask(
            self.sensor_degrees,
            SENSOR_DEGREES,
            degrees,
            check_sensor_degrees,
        )?;
        let [delay, uncertainty] = &mut to.sensor_delay_ms;
        asker.ask(self.sensor_delay, SENSOR_DELAY, delay, check_delay)?;
        asker.ask(
            self.sensor_delay_uncertainty,
            SENSOR_DELAY_UNCERTAINTY,
            uncertainty,
            check_delay,
        )?;
        Ok(to)
    }
}

/// The kind of the sensor, chosen from those that are known.
fn ask_sensor_kind(asker: &Asker) -> Result<SensorKind> {
    let items = SensorKind::ALL.map(|kind| kind.preset().words.to_owned());
    let chosen = asker.choose(SENSOR_KIND, &items, 0)?;
    Ok(SensorKind::ALL.into_iter().nth(chosen).unwrap_or_default())
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
    items.push(format!(
        "{simulated}: no hardware, a simulated servo of 10 µs per degree and an RTY sensor of 120 degrees"
    ));
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
            let mut port = "/dev/ttyUSB0".to_owned();
            asker.ask(None, PORT, &mut port, |name| check_name(name))?;
            Ok(Some(port))
        }
        _ => Ok(None),
    }
}
