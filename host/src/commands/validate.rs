//! `servoid validate`

use super::input::TableArgs;
use super::output::{Output, stem};
use crate::data::dataset::listed;
use crate::data::fingerprint;
use crate::data::model_file::ModelFile;
use crate::data::model_metadata::ModelMetadata;
use crate::presentation::plots::{self, Named};
use crate::presentation::summary;
use anyhow::{Context, Result};
use clap::Args;
use serde::Serialize;
use servoid_identification::Run;
use servoid_identification::results::{Advice, Validation};
use std::path::PathBuf;

/// Compare a model with a recording that it was not identified from
///
/// The model is simulated with the recording's input. Fit is 100 % for a perfect prediction, 0 % for one no
/// better than the mean, and below 0 % for one worse than the mean.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  servoid validate bench.json another-bench.csv --plots plots
  servoid validate mine.json another.csv          (read as the file that mine.json is of)")]
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
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    table: TableArgs,
}

impl Validate {
    pub(super) fn run(self) -> Result<String> {
        self.output.check(&self.out)?;
        let file = ModelFile::read(&self.model)?;
        let servo = file.servo_model()?;
        let ModelFile {
            model,
            metadata,
            fingerprints,
            read_as,
            ..
        } = file;
        let data = self
            .table
            .load_as(&read_as, &self.files, self.output.talk)?;
        let (model_name, files) = (self.model.display().to_string(), listed(&self.files));
        metadata.same_units(&model_name, &ModelMetadata::from(&data.about), &files)?;
        let own = fingerprint::advice_on_validation(&fingerprints, &fingerprint::of(&data.record));
        let validation = model.validate(&data.record).context(files)?;
        let servo = servo.map(|servo| -> Result<Validation> {
            let controllers = data.controllers.among(&servo.controller_names)?;
            Ok(servo.model.validate(&data.record, &controllers)?)
        });
        let servo = servo.transpose()?;
        let unit = data.about.output_unit.as_deref();
        let advice: Vec<Advice> = own.into_iter().chain(data.about.advice).collect();
        let validated = Validated {
            validation: &validation,
            servo_model: servo.as_ref(),
            advice: &advice,
        };
        self.output.write_json(self.out.as_ref(), &validated)?;
        if let (Some(folder), Some(first)) = (&self.plots, self.files.first()) {
            let (name, first) = (stem(&self.model), stem(first));
            let named = [Named {
                name: &name,
                model: &model,
            }];
            let of_run = |(run, number): (&Run, usize)| {
                let file = format!("{name}-on-{first}-run-{number}");
                plots::validation(&file, "Model against measurement", &named, run, unit)
            };
            let figures: Vec<_> = data.record.runs().iter().zip(1..).map(of_run).collect();
            self.output.draw(folder, &figures)?;
        }
        let text = summary::of_validation(&validation, servo.as_ref(), unit, &advice);
        self.output.talk.result(text, &validated)
    }
}

/// The result as JSON, with advice on the files.
#[derive(Serialize)]
struct Validated<'a> {
    #[serde(flatten)]
    validation: &'a Validation,
    /// The same of the servo model, where the file has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    servo_model: Option<&'a Validation>,
    #[serde(skip_serializing_if = "<[Advice]>::is_empty")]
    advice: &'a [Advice],
}
