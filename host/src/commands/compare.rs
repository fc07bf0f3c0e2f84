//! `servoid compare`

use super::file_names::is_model;
use super::output_args::Talk;
use super::table_args::TableArgs;
use super::usage::wrong_usage;
use crate::commands::output_files;
use crate::data::dataset::listed;
use crate::data::dataset::{self, DatasetOptions};
use crate::data::fingerprint::{self, advice_on_sides};
use crate::data::model_file::ModelFile;
use crate::data::model_metadata::ModelMetadata;
use crate::presentation::summary;
use anyhow::{Context, Result, bail};
use clap::Args;
use servoid_identification::Options;
use servoid_identification::comparison::{Comparison, ComparisonOptions, compare, compare_models};
use servoid_identification::results::Advice;
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
    /// The result to write, as JSON
    #[arg(long, short, value_name = "FILE.json")]
    out: Option<PathBuf>,
    /// Replace the file if it exists
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    talk: Talk,
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
        if let Err(error) = options.identification.check() {
            wrong_usage(error);
        }
        if let Some(out) = &self.out {
            output_files::check_free(out, self.force)?;
        }
        let (a, b) = match &self.sides[..] {
            [a, b] => (std::slice::from_ref(a), std::slice::from_ref(b)),
            _ => (&self.a[..], &self.b[..]),
        };
        let (mut found, same) = match (a, b) {
            ([a], [b]) if is_model(a) && is_model(b) => models(a, b, &options)?,
            _ => recordings([a, b], &self.table.into(), options, self.talk)?,
        };
        // What makes all the rest pointless is said first.
        found.advice.splice(0..0, same);
        let text = summary::of_comparison(&listed(a), &listed(b), &found);
        if let Some(out) = &self.out {
            output_files::write_file(out, self.force, &output_files::to_json(&found)?)?;
        }
        self.talk.result(text, &found)
    }
}

/// What comes of a comparison, and what is to be said where both sides have the same samples.
type Compared = (Comparison, Option<Advice>);

fn models(a: &Path, b: &Path, options: &ComparisonOptions) -> Result<Compared> {
    let (name_a, name_b) = (a.display().to_string(), b.display().to_string());
    let [a, b] = [ModelFile::read(a)?, ModelFile::read(b)?];
    a.metadata.same_units(&name_a, &b.metadata, &name_b)?;
    let found = compare_models(&a.model, &b.model, options)
        .with_context(|| format!("{name_a} against {name_b}"))?;
    Ok((found, advice_on_sides(&a.fingerprints, &b.fingerprints)))
}

fn recordings(
    sides: [&[PathBuf]; 2],
    table: &DatasetOptions,
    options: ComparisonOptions,
    talk: Talk,
) -> Result<Compared> {
    if let Some(model) = sides.iter().copied().flatten().find(|file| is_model(file)) {
        bail!("{model:?} is a model: compare two models, or recordings on both sides");
    }
    let [name_a, name_b] = sides.map(listed);
    let [a, b] = dataset::load_sides(sides, table)?;
    for remark in a.about.remarks.iter().chain(&b.about.remarks) {
        talk.say(remark);
    }
    let [from_a, from_b] = [&a, &b].map(|side| ModelMetadata::from(&side.about));
    from_a.same_units(&name_a, &from_b, &name_b)?;
    let same = advice_on_sides(&fingerprint::of(&a.record), &fingerprint::of(&b.record));
    let options = ComparisonOptions {
        input_unit: a.about.input_unit_with(&b.about),
        output_unit: a.about.output_unit_with(&b.about),
        ..options
    };
    let mut found = compare(&a.record, &b.record, &options)
        .with_context(|| format!("{name_a} against {name_b}"))?;
    found.advice.extend(a.about.advice);
    found.advice.extend(b.about.advice);
    Ok((found, same))
}
