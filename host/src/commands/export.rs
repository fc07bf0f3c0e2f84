//! `servoid export`

use super::output::{Output, stem, wrong_usage};
use crate::data::model_file::ModelFile;
use crate::data::model_metadata::PULSE_FRAMES_S;
use crate::presentation::export::{Export, Target};
use anyhow::Result;
use clap::Args;
use serde_json::json;
use std::path::PathBuf;

/// Write a model for another program: MATLAB, Python, Julia, C, a CSV table, or JSBSim
///
/// The finite impulse response is the identified model itself. Where a ratio of polynomials is needed, a
/// low-order model is fitted to it, and the file states the difference between the two. Every file states its
/// sample times, units and signs, and where its bounds do not hold.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  servoid export bench.json --to c -o servo_bench.h
  servoid export bench.json --to python --name \"DS610 on the bench\" > servo_bench.py")]
pub(super) struct ExportArgs {
    /// The model, as 'servoid identify -o' writes it
    #[arg(value_name = "MODEL.json")]
    model: PathBuf,
    /// Target program
    #[arg(long, value_enum, value_name = "TARGET")]
    to: Target,
    /// The file to write; without it, standard output
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Name of the servo in it; without it, the name of the model file
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Pulse frame, which holds a command (ms); 0 where commands take effect at once. Without it, that of the
    /// model: 20 ms where it is from recordings of servoid, unknown otherwise
    #[arg(long, value_name = "MS")]
    frame_ms: Option<f64>,
    #[command(flatten)]
    output: Output,
}

impl ExportArgs {
    pub(super) fn run(self) -> Result<String> {
        let stated_s = self.frame_ms.map(|frame| 1e-3 * frame);
        if stated_s.is_some_and(|frame| !PULSE_FRAMES_S.contains(&frame)) {
            wrong_usage("--frame-ms must be a number of milliseconds from 0 to 1000");
        }
        self.output.check(&self.out)?;
        let file = ModelFile::read(&self.model)?;
        let fitted = file.flight_model()?;
        let mut metadata = file.metadata;
        metadata.pulse_frame_s = stated_s.or(metadata.pulse_frame_s);
        let source = self.model.file_name().unwrap_or_default().to_string_lossy();
        let name = self.name.clone().unwrap_or_else(|| stem(&self.model));
        let export = Export::new(&name, &source, &file.model, fitted, metadata);
        let text = export.write(self.to)?;
        let (talk, warnings) = (self.output.talk, export.warnings());
        for warning in &warnings {
            talk.say(format_args!("warning: {warning}"));
        }
        let Some(out) = &self.out else {
            let result = json!({ "target": self.to, "warnings": warnings, "text": text });
            return talk.result(text, &result);
        };
        self.output.write(out, &text)?;
        let result = json!({ "target": self.to, "warnings": warnings, "file": out });
        talk.result(format!("{}\n", out.display()), &result)
    }
}
