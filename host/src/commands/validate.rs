//! `servoid validate`

use super::input::TableArgs;
use super::output::{Output, stem};
use crate::analysis::Validated;
use crate::data::PredictedRun;
use crate::data::dataset::listed;
use crate::data::model_file::ModelFile;
use crate::presentation::plots;
use anyhow::Result;
use clap::Args;
use std::path::PathBuf;

/// Compare a model with a recording that it was not identified from
///
/// The model is simulated with the recording's input: the command of each row acts from that row on, without a pulse frame unless one is stated. Fit is 100 %
/// for a perfect prediction, 0 % for one no better than the mean, and below 0 % for one worse than the mean.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  servoid validate bench.json again.csv --plots plots
  servoid validate mine.json another.csv          (read as the file that mine.json is of)
  servoid validate mine.json flight.csv --frame-ms 20          (commands waited for pulses)")]
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
    /// Folder for plots of each run: the models against the measurement
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
    /// Time between pulses (ms), where the commands of the recording waited for them, as those of a receiver or a flight controller do: each
    /// acts from the next pulse on. When pulses came is looked for, and the exact time between them within 2.5 % of this: those with which the model is closest
    /// are taken. Only for a model whose own recording has commands at their pulses: elsewhere half a frame is in its delay already
    #[arg(long, value_name = "MS")]
    frame_ms: Option<f64>,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    table: TableArgs,
}

impl Validate {
    pub(super) fn run(self) -> Result<String> {
        let read = self.files.iter().chain([&self.model]);
        self.output.check_beside(&self.out, read)?;
        let file = ModelFile::read(&self.model)?;
        let data = self
            .table
            .load_as(&file.read_as, &self.files, self.output.talk)?;
        let (model_name, files) = (self.model.display().to_string(), listed(&self.files));
        let validated = Validated::of(&file, &model_name, &data, &files, self.frame_ms)?;
        let unit = data.about.output_unit.as_deref();
        if validated.servo_model.is_none() {
            self.output.talk.say(format_args!(
                "{model_name} has no servo model, so the linear model alone is validated; 'servoid identify --servo-model' adds one"
            ));
        }
        self.output.write_json(self.out.as_ref(), &validated)?;
        if let (Some(folder), Some(first)) = (&self.plots, self.files.first()) {
            let (name, first) = (stem(&self.model), stem(first));
            let of_run = |(run, number): (&PredictedRun, usize)| {
                let file = format!("{name}-on-{first}-run-{number}");
                plots::predicted(&file, "Models against measurement", run, unit)
            };
            let figures: Vec<_> = validated.predicted.iter().zip(1..).map(of_run).collect();
            self.output.draw(folder, &figures)?;
        }
        self.output.talk.result(validated.as_text(unit), &validated)
    }
}
