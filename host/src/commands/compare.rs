//! `servoid compare`

use super::input::{SecondSideArgs, TableArgs};
use super::output::{Output, Talk, sides_are_open, wrong_usage};
use super::servo_search::{NoServoModel, ServoSearch};
use crate::analysis::{Compared, ServoModelSearch};
use crate::data::dataset::listed;
use crate::data::dataset::suggested_columns::quoted;
use crate::data::model_file::{ModelFile, is_model};
use anyhow::{Result, bail};
use clap::Args;
use servoid_identification::Options;
use servoid_identification::comparison::ComparisonOptions;
use std::path::{Path, PathBuf};

/// Compare two servos, or one servo under two conditions
///
/// The verdict is "different" if the step responses surely differ by more than the margin somewhere, "same" if
/// they surely differ by less everywhere, and "undecided" otherwise. Several recordings of a side are several
/// runs; with three or more, the verdict is of the servos and contains what differs from run to run. Recordings give more
/// than models: up and down strokes apart, and the rest positions of each side.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  servoid compare bench.csv aircraft.csv
  servoid compare bench.csv mine.csv --input u --output y    a CSV file of another program
  servoid compare --a bench1.csv bench2.csv bench3.csv --b air1.csv air2.csv air3.csv --margin 3")]
pub(super) struct Compare {
    /// The reference condition, then the other: two recordings, or two models
    #[arg(num_args = 1.., value_names = ["A", "B"], required_unless_present_all = ["a", "b"])]
    sides: Vec<PathBuf>,
    /// Recordings of the reference condition, several runs
    #[arg(long, num_args = 1.., value_name = "FILE", conflicts_with = "sides", requires = "b")]
    a: Vec<PathBuf>,
    /// Recordings of the other condition, several runs
    #[arg(long, num_args = 1.., value_name = "FILE", conflicts_with = "sides", requires = "a")]
    b: Vec<PathBuf>,
    /// The largest difference that still counts as the same (percent of the step)
    #[arg(long, default_value_t = 5.0, value_name = "PERCENT", value_parser = super::value_parsers::margin)]
    margin: f64,
    /// Confidence level of every bound, as a fraction (0.99) or in percent (99)
    #[arg(long, default_value_t = 0.99, value_parser = super::value_parsers::level)]
    level: f64,
    /// Standard deviation of the sensor's zero between the two sides (in the recording's unit)
    #[arg(long, default_value_t = 0.0, value_name = "SD", value_parser = super::value_parsers::finite)]
    zero_sd: f64,
    /// Also compare the servos as machines. That is done by itself for models that both have a servo model, and where
    /// the step responses leave the verdict open
    #[arg(long)]
    servo_model: bool,
    #[command(flatten)]
    no_servo_model: NoServoModel,
    /// The result to write, as JSON
    #[arg(long, short, value_name = "FILE.json")]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    table: TableArgs,
    #[command(flatten)]
    second: SecondSideArgs,
}

impl Compare {
    pub(super) fn run(self) -> Result<String> {
        if !matches!(self.sides.len(), 0 | 2) {
            wrong_usage(sides_are_open("compare", &self.sides));
        }
        if self.zero_sd.is_nan() || self.zero_sd < 0.0 {
            bail!("--zero-sd must be 0 or more");
        }
        let options = ComparisonOptions {
            margin_percent: self.margin,
            identification: Options {
                level: self.level,
                ..Options::default()
            },
            zero_sd: self.zero_sd,
            ..ComparisonOptions::default()
        };
        warn_of_small_margin(self.margin, self.output.talk);
        let read = self.sides.iter().chain(&self.a).chain(&self.b);
        self.output.check_beside(&self.out, read)?;
        let (a, b) = match &self.sides[..] {
            [a, b] => (std::slice::from_ref(a), std::slice::from_ref(b)),
            _ => (&self.a[..], &self.b[..]),
        };
        let names = [listed(a), listed(b)];
        let names = names.each_ref().map(String::as_str);
        let search = self.no_servo_model.or(self.servo_model);
        let compared = match (a, b) {
            ([a], [b]) if is_model(a) && is_model(b) => {
                let [a, b] = [ModelFile::read(a)?, ModelFile::read(b)?];
                Compared::models([&a, &b], names, &options, search)?
            }
            _ => {
                if let Some(model) = a.iter().chain(b).find(|file| is_model(file)) {
                    bail!(
                        "{model:?} is a model: compare two models, or recordings on both sides{}",
                        self.models_of(a, b)
                    );
                }
                let talk = self.output.talk;
                let [a, b] = self.table.load_sides([a, b], &self.second, talk)?;
                let watch = || ServoSearch::begin("both servos as machines", talk);
                Compared::recordings([&a, &b], names, options, search, watch)?
            }
        };
        self.output.write_json(self.out.as_ref(), &compared)?;
        let mut text = compared.as_text(names);
        let of_recordings = !a.iter().chain(b).any(|file| is_model(file));
        let may_ask = of_recordings && search == ServoModelSearch::WhereNeeded;
        if may_ask && compared.leaves_machines_open() {
            text += &self.output.talk.next(MACHINES);
        }
        self.output.talk.result(text, &compared)
    }

    /// What makes two models of a model and one recording, as a user types it.
    fn models_of(&self, a: &[PathBuf], b: &[PathBuf]) -> String {
        let (model, recording) = match (a, b) {
            ([a], [b]) if is_model(a) => (a, b),
            ([a], [b]) => (b, a),
            _ => return String::new(),
        };
        let Ok(file) = ModelFile::read(model) else {
            return String::new();
        };
        let made = recording.with_extension("json");
        let name = |path: &Path| quoted(&path.display().to_string());
        let of = |path: &PathBuf| name(if path == recording { &made } else { path });
        let sides: Vec<String> = a.iter().chain(b).map(of).collect();
        format!(
            "; here: servoid identify {}{} -o {}, then servoid compare {}",
            name(recording),
            self.table.as_typed_like(&file.read_as),
            name(&made),
            sides.join(" ")
        )
    }
}

/// What is typed next where a servo is not linear.
const MACHINES: &str = "the same with --servo-model, which compares the servos as machines: their speeds, play, friction and loads";

/// A margin below this is more likely a fraction \[%\].
const SMALL_MARGIN_PERCENT: f64 = 0.5;

/// Says how a margin was understood that may be meant as a fraction.
pub(super) fn warn_of_small_margin(percent: f64, talk: Talk) {
    if percent > 0.0 && percent < SMALL_MARGIN_PERCENT {
        talk.say(format_args!(
            "margin: {percent} % of the step, as --margin is in percent; {} % is --margin {}",
            100.0 * percent,
            100.0 * percent
        ));
    }
}
