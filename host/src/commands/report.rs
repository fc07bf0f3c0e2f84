//! `servoid report`

use super::file_names::is_model;
use super::file_names::stem;
use super::output_args::Talk;
use super::table_args::TableArgs;
use super::usage::wrong_usage;
use crate::commands::output_files;
use crate::data::dataset::listed;
use crate::data::dataset::{self, Dataset, DatasetOptions};
use crate::data::fingerprint;
use crate::data::model_file::ModelFile;
use crate::presentation::report::{self, Page, Servo};
use anyhow::{Context, Result};
use clap::Args;
use servoid_identification::comparison::{Comparison, ComparisonOptions, compare, compare_models};
use servoid_identification::{Options, identify_explained};
use std::path::PathBuf;

/// Write a page on one servo, or on the comparison of two, with figures to zoom in
///
/// Takes one or two recordings or models, or several runs of each side. Recordings are identified with the
/// structure chosen from the data. The page is a single file that opens in any browser, without a network.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  servoid report bench.csv aircraft.csv -o report.html
  servoid report --a bench1.csv bench2.csv bench3.csv --b air1.csv air2.csv air3.csv -o report.html
  servoid report mine.csv --input u --output y --period 0.02 -o report.html")]
pub(super) struct Report {
    /// A recording or a model, or two, the reference condition first
    #[arg(required_unless_present = "a", num_args = 1..=2, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Recordings of the servo, or of the reference condition, several runs
    #[arg(long, num_args = 1.., value_name = "FILE", conflicts_with = "files")]
    a: Vec<PathBuf>,
    /// Recordings of the other condition, several runs
    #[arg(long, num_args = 1.., value_name = "FILE", requires = "a")]
    b: Vec<PathBuf>,
    /// The page to write
    #[arg(long, short, value_name = "FILE.html")]
    out: PathBuf,
    /// Title of the page
    #[arg(long, default_value = "How the servo moves")]
    title: String,
    /// The largest difference that still counts as the same (percent of the step)
    #[arg(long, default_value_t = 5.0, value_name = "PERCENT", value_parser = super::value_parsers::margin)]
    margin: f64,
    /// Replace the file if it exists
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    talk: Talk,
    #[command(flatten)]
    table: TableArgs,
}

impl Report {
    pub(super) fn run(self) -> Result<String> {
        output_files::check_free(&self.out, self.force)?;
        let options: DatasetOptions = self.table.into();
        let sides: Vec<&[PathBuf]> = match &self.files[..] {
            [] => [&self.a[..], &self.b[..]]
                .into_iter()
                .filter(|side| !side.is_empty())
                .collect(),
            files => files.chunks(1).collect(),
        };
        let mut servos = match sides[..] {
            [a, b] if model_file(a).is_none() && model_file(b).is_none() => {
                let [data_a, data_b] = dataset::load_sides([a, b], &options)?;
                vec![
                    identified(a, data_a, self.talk)?,
                    identified(b, data_b, self.talk)?,
                ]
            }
            ref sides => sides
                .iter()
                .map(|side| read(side, &options, self.talk))
                .collect::<Result<_>>()?,
        };
        name_apart(&mut servos);
        let comparison = match &servos[..] {
            [a, b] => comparison(a, b, self.margin, self.talk)?,
            _ => None,
        };
        let [first, others @ ..] = &servos[..] else {
            wrong_usage("name a recording or a model to report on");
        };
        let page = report::page(&Page {
            title: &self.title,
            first: first.part(),
            second: others.first().map(Servo::part),
            comparison: comparison.as_ref(),
            paper: &[],
        })?;
        output_files::write_file(&self.out, self.force, &page)?;
        let result = serde_json::json!({ "file": self.out });
        self.talk.result(
            format!("{}: open it in a browser\n", self.out.display()),
            &result,
        )
    }
}

/// The model that a side is, where it is one.
fn model_file(files: &[PathBuf]) -> Option<&PathBuf> {
    match files {
        [file] if is_model(file) => Some(file),
        _ => None,
    }
}

fn read(files: &[PathBuf], options: &DatasetOptions, talk: Talk) -> Result<Servo> {
    let Some(file) = model_file(files) else {
        return identified(files, dataset::load(files, options)?, talk);
    };
    let ModelFile {
        model, metadata, ..
    } = ModelFile::read(file)?;
    Ok(Servo::of_model(stem(file), model, metadata))
}

fn identified(files: &[PathBuf], data: Dataset, talk: Talk) -> Result<Servo> {
    data.about
        .remarks
        .iter()
        .for_each(|remark| talk.say(remark));
    let mut found =
        identify_explained(&data.record, &Options::default()).with_context(|| listed(files))?;
    found.model.advice.extend(data.about.advice.iter().cloned());
    let name = data.about.condition.clone();
    let name = name.unwrap_or_else(|| files.first().map_or_else(String::new, |file| stem(file)));
    Ok(Servo::of_data(name, data, found))
}

/// What lies between the two; `None` for a recording beside a model, which are shown all the same.
fn comparison(a: &Servo, b: &Servo, margin: f64, talk: Talk) -> Result<Option<Comparison>> {
    let options = ComparisonOptions {
        margin_percent: margin,
        ..ComparisonOptions::default()
    };
    if let Err(why) = a.metadata.same_units(&a.name, &b.metadata, &b.name) {
        talk.say(format_args!("no verdict: {why}"));
        return Ok(None);
    }
    let found = match (&a.data, &b.data) {
        (Some(a), Some(b)) => {
            let sides = [a, b].map(|side| fingerprint::of(&side.record));
            let options = ComparisonOptions {
                input_unit: a.about.input_unit_with(&b.about),
                output_unit: a.about.output_unit_with(&b.about),
                ..options
            };
            compare(&a.record, &b.record, &options).map(|mut found| {
                let same = fingerprint::advice_on_sides(&sides[0], &sides[1]);
                found.advice.splice(0..0, same);
                found
            })
        }
        (None, None) => compare_models(&a.model, &b.model, &options),
        _ => {
            talk.say("a recording and a model are shown side by side, but without a verdict: that takes two recordings, or two models");
            return Ok(None);
        }
    };
    found
        .map(Some)
        .with_context(|| format!("{} against {}", a.name, b.name))
}

/// Two curves of one name could not be told apart.
fn name_apart(servos: &mut [Servo]) {
    if let [first, second] = servos
        && first.name == second.name
    {
        first.name.push_str(" 1");
        second.name.push_str(" 2");
    }
}
