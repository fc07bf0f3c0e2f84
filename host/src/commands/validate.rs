//! `servoid validate`

use super::file_names::stem;
use super::output_args::Talk;
use super::table_args::TableArgs;
use crate::commands::output_files;
use crate::data::dataset;
use crate::data::dataset::listed;
use crate::data::fingerprint;
use crate::data::model_file::ModelFile;
use crate::data::model_metadata::ModelMetadata;
use crate::presentation::plots::named::Named;
use crate::presentation::plots::signals;
use crate::presentation::summary;
use anyhow::{Context, Result};
use clap::Args;
use serde::Serialize;
use servoid_identification::results::{Advice, Model, Validation};
use servoid_identification::{Record, Run};
use std::path::PathBuf;

/// Compare a model with a recording that it was not identified from
///
/// The model is simulated with the recording's input. Fit is 100 % for a perfect prediction, 0 % for one no
/// better than the mean, and below 0 % for one worse than the mean.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  servoid validate bench.json another-bench.csv --plots plots
  servoid validate mine.json another.csv --input u --output y --period 0.02")]
pub(super) struct Validate {
    /// The model, as 'servoid identify -o' writes it
    #[arg(value_name = "MODEL.json")]
    model: PathBuf,
    /// Recordings, or CSV files
    #[arg(required = true, value_name = "FILE.csv")]
    files: Vec<PathBuf>,
    /// The result to write, as JSON
    #[arg(long, short, value_name = "FILE.json")]
    out: Option<PathBuf>,
    /// Folder for plots of model against measurement
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
    /// Replace files that exist
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    talk: Talk,
    #[command(flatten)]
    table: TableArgs,
}

impl Validate {
    pub(super) fn run(self) -> Result<String> {
        if let Some(out) = &self.out {
            output_files::check_free(out, self.force)?;
        }
        let ModelFile {
            model,
            metadata,
            fingerprints,
            ..
        } = ModelFile::read(&self.model)?;
        let data = dataset::load(&self.files, &self.table.clone().into())?;
        metadata.same_units(
            &self.model.display().to_string(),
            &ModelMetadata::from(&data.about),
            &listed(&self.files),
        )?;
        let own = fingerprint::advice_on_validation(&fingerprints, &fingerprint::of(&data.record));
        data.about
            .remarks
            .iter()
            .for_each(|remark| self.talk.say(remark));
        let result = model
            .validate(&data.record)
            .with_context(|| listed(&self.files))?;
        let unit = data.about.output_unit;
        let advice: Vec<Advice> = own.into_iter().chain(data.about.advice).collect();
        let validated = Validated {
            validation: &result,
            advice: &advice,
        };
        if let Some(out) = &self.out {
            output_files::write_file(out, self.force, &output_files::to_json(&validated)?)?;
        }
        self.draw(&model, &data.record, unit.as_deref())?;
        self.talk.result(
            summary::of_validation(&result, unit.as_deref(), &advice),
            &validated,
        )
    }

    /// Writes a plot of each run, where a folder for them was named.
    fn draw(&self, model: &Model, record: &Record, unit: Option<&str>) -> Result<()> {
        let (Some(folder), Some(first)) = (&self.plots, self.files.first()) else {
            return Ok(());
        };
        let (name, first) = (stem(&self.model), stem(first));
        let named = [Named { name: &name, model }];
        let of_run = |(run, number): (&Run, usize)| {
            let file = format!("{name}-on-{first}-run-{number}");
            signals::validation(&file, "Model against measurement", &named, run, unit)
        };
        let figures: Vec<_> = record.runs().iter().zip(1..).map(of_run).collect();
        let files = output_files::write_figures(folder, self.force, &figures)?;
        self.talk.say(format_args!("plots: {}", listed(&files)));
        Ok(())
    }
}

/// The result as JSON: with what has to be known about the files.
#[derive(Serialize)]
struct Validated<'a> {
    #[serde(flatten)]
    validation: &'a Validation,
    #[serde(skip_serializing_if = "<[Advice]>::is_empty")]
    advice: &'a [Advice],
}
