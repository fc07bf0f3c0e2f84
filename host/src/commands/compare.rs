//! `servoid compare`

use super::input::{TableArgs, compared, is_model};
use super::output::Output;
use super::servo_fit;
use crate::data::dataset::listed;
use crate::data::fingerprint::advice_on_sides;
use crate::data::model_file::ModelFile;
use crate::data::model_metadata::ModelMetadata;
use crate::presentation::summary;
use anyhow::{Context, Result, bail};
use clap::Args;
use serde::Serialize;
use servoid_identification::Options;
use servoid_identification::comparison::{
    Comparison, ComparisonOptions, ServoModelComparison, compare_models, compare_servo_models,
};
use std::path::{Path, PathBuf};

/// Compare two servos, or one servo under two conditions
///
/// The verdict is "different" if the step responses surely differ by more than the margin somewhere, "same" if
/// they surely differ by less everywhere, and "undecided" otherwise. Several recordings of a side are several
/// runs; with three or more, the scatter between runs is tested too. Recordings give more than models: up and
/// down strokes apart, and the rest positions of each side.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  servoid compare bench.csv aircraft.csv
  servoid compare bench.csv mine.csv --input u --output y    a CSV file of another program
  servoid compare --a bench1.csv bench2.csv bench3.csv --b air1.csv air2.csv air3.csv --margin 3")]
pub(super) struct Compare {
    /// The reference condition, then the other: two recordings, or two models
    #[arg(num_args = 2, value_names = ["A", "B"], required_unless_present_all = ["a", "b"])]
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
    #[arg(long, default_value_t = 0.0, value_name = "SD")]
    zero_sd: f64,
    /// Also compare the servos as machines. That is done by itself for models that both have a servo model, and where the
    /// step responses have no bounds
    #[arg(long)]
    servo_model: bool,
    /// The result to write, as JSON
    #[arg(long, short, value_name = "FILE.json")]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    table: TableArgs,
}

impl Compare {
    pub(super) fn run(self) -> Result<String> {
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
        self.output.check(&self.out)?;
        let (a, b) = match &self.sides[..] {
            [a, b] => (std::slice::from_ref(a), std::slice::from_ref(b)),
            _ => (&self.a[..], &self.b[..]),
        };
        let names = [listed(a), listed(b)];
        let compared = match (a, b) {
            ([a], [b]) if is_model(a) && is_model(b) => self.models([a, b], &names, &options)?,
            _ => {
                if let Some(model) = a.iter().chain(b).find(|file| is_model(file)) {
                    bail!("{model:?} is a model: compare two models, or recordings on both sides");
                }
                self.recordings([a, b], &names, options)?
            }
        };
        self.output.write_json(self.out.as_ref(), &compared)?;
        let text = compared.as_text(&names);
        self.output.talk.result(text, &compared)
    }

    fn recordings(
        &self,
        sides: [&[PathBuf]; 2],
        names: &[String; 2],
        options: ComparisonOptions,
    ) -> Result<Compared> {
        let talk = self.output.talk;
        let [a, b] = self.table.load_sides(sides, talk)?;
        let mut found = compared([&a, &b], [&names[0], &names[1]], options)?;
        let servos = servo_fit::is_wanted(self.servo_model, found.bounds.withdrawn())
            .then(|| servo_fit::find_both([&a, &b], self.level, talk));
        let (servo_model, no_servo_model) = match servos {
            Some(Ok([a, b])) => (Some(compare_servo_models(&a.model, &b.model)), None),
            Some(Err(reason)) => (None, Some(reason)),
            None => (None, None),
        };
        let metadata = ModelMetadata::from(&a.about);
        found.advice.extend(a.about.advice);
        found.advice.extend(b.about.advice);
        Ok(Compared {
            found,
            servo_model,
            no_servo_model,
            metadata,
        })
    }

    fn models(
        &self,
        files: [&Path; 2],
        names: &[String; 2],
        options: &ComparisonOptions,
    ) -> Result<Compared> {
        let [a, b] = files.map(ModelFile::read);
        let (a, b) = (a?, b?);
        a.metadata.same_units(&names[0], &b.metadata, &names[1])?;
        let found = compare_models(&a.model, &b.model, options);
        let mut found = found.with_context(|| names.join(" against "))?;
        // The most important advice comes first.
        found
            .advice
            .splice(0..0, advice_on_sides(&a.fingerprints, &b.fingerprints));
        let servos = [a.servo_model()?, b.servo_model()?];
        for (name, servo) in names.iter().zip(&servos) {
            if self.servo_model && servo.is_none() {
                bail!("{name} has no servo model: identify its recording with --servo-model");
            }
        }
        let [of_a, of_b] = servos;
        let both = of_a.zip(of_b);
        Ok(Compared {
            found,
            servo_model: both.map(|(a, b)| compare_servo_models(&a.model, &b.model)),
            no_servo_model: None,
            metadata: a.metadata,
        })
    }
}

/// The comparison as `--json` prints it and `-o` writes it.
#[derive(Serialize)]
struct Compared {
    #[serde(flatten)]
    found: Comparison,
    #[serde(skip_serializing_if = "Option::is_none")]
    servo_model: Option<ServoModelComparison>,
    /// The reason why servo models are not compared though that was looked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    no_servo_model: Option<String>,
    /// Units of both sides.
    #[serde(skip)]
    metadata: ModelMetadata,
}

impl Compared {
    fn as_text(&self, names: &[String; 2]) -> String {
        let mut text = summary::of_comparison(&names[0], &names[1], &self.found);
        let units = self.metadata.units();
        text.extend(self.servo_model.iter().map(|servos| {
            let sentence = summary::sentence_on_servo_models("A", "B", servos, units);
            let table = summary::of_servo_models("A", "B", servos, units);
            format!("\n{}\n{table}", summary::wrapped(&sentence, 0))
        }));
        text.extend(
            self.no_servo_model
                .iter()
                .map(|reason| format!("\nno servo models: {reason}\n")),
        );
        text
    }
}
