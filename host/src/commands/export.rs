//! `servoid export`

use super::output::{Output, stem, wrong_usage};
use crate::data::model_file::ModelFile;
use crate::data::model_metadata::{ModelMetadata, PULSE_FRAMES_S};
use crate::presentation::export::servo_model::{ServoExport, ServoExportOptions};
use crate::presentation::export::{Export, ExportError, Target, identifier};
use anyhow::Result;
use clap::Args;
use serde_json::{Map, Value, json};
use std::path::PathBuf;

/// The shortest pulse frame \[s\]: narrow pulses come in 1.8 ms, and 0.02 is a frame in seconds.
const SHORTEST_FRAME_S: f64 = 1e-3;

/// Steps of time that a simulation may have \[ms\]; beyond, it is a slip.
const STEPS_MS: std::ops::RangeInclusive<f64> = 0.05..=100.0;

/// Write a model for another program: MATLAB, Python, Julia, C, a CSV table, JSBSim, ArduPilot, or MuJoCo
///
/// The finite impulse response is the identified model itself. Where a ratio of polynomials is needed, a
/// low-order model is fitted to it, and the file states the difference between the two. Every file states its
/// sample times, units and signs, and where its bounds do not hold.
///
/// With --servo-model, and for ArduPilot and MuJoCo, it is the servo as a machine, which 'servoid identify
/// --servo-model' finds. The file then states its largest difference from it, and what it leaves out.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  servoid export bench.json --to c -o servo_bench.h
  servoid export bench.json --to python --name \"DS610 on the bench\" > servo_bench.py
  servoid export bench.json --to c --servo-model --step-ms 1 -o servo_bench.h
  servoid export bench.json --to mujoco -o servo_bench.xml")]
pub(super) struct ExportArgs {
    /// The model, as 'servoid identify -o' writes it
    #[arg(value_name = "MODEL.json")]
    model: PathBuf,
    /// Target program
    #[arg(long, value_enum, value_name = "TARGET")]
    to: Target,
    /// The servo as a machine, which the model file must have, in place of the linear model
    #[arg(long)]
    servo_model: bool,
    /// The controller of the servo model, as the recordings call it, where it has several
    #[arg(long, value_name = "CONTROLLER", allow_negative_numbers = true, value_parser = super::value_parsers::finite)]
    controller: Option<f64>,
    /// Step of time of the servo model in the file (ms); without it, one that suits servo and target
    #[arg(long, value_name = "MS", allow_negative_numbers = true, value_parser = super::value_parsers::finite)]
    step_ms: Option<f64>,
    /// The command that fully deflects a servo of ArduPilot, for --to ardupilot; without it 500 us from 1500 us, 45
    /// degrees, or 1 where the command has no unit
    #[arg(long, value_name = "COMMAND", allow_negative_numbers = true, value_parser = super::value_parsers::finite)]
    full_command: Option<f64>,
    /// The file to write; without it, standard output
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Name of the servo in it; without it, the name of the model file
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Pulse frame, which holds a command (ms); 0 where commands take effect at once. Without it, that of the
    /// model: 20 ms where it is from recordings of servoid, unknown otherwise. State it only where the recorded
    /// commands were written at the pulses that carried them: elsewhere the mean wait for a pulse, half a frame,
    /// is in the model's delay already
    #[arg(long, value_name = "MS", allow_negative_numbers = true, value_parser = super::value_parsers::finite)]
    frame_ms: Option<f64>,
    #[command(flatten)]
    output: Output,
}

impl ExportArgs {
    pub(super) fn run(self) -> Result<String> {
        let stated_s = self.frame_ms.map(|frame| 1e-3 * frame);
        let is_frame = |frame_s: f64| {
            PULSE_FRAMES_S.contains(&frame_s) && (frame_s == 0.0 || frame_s >= SHORTEST_FRAME_S)
        };
        if stated_s.is_some_and(|frame_s| !is_frame(frame_s)) {
            wrong_usage("--frame-ms must be a number of milliseconds: 0, or 1 to 1000");
        }
        if self.step_ms.is_some_and(|step| !STEPS_MS.contains(&step)) {
            wrong_usage("--step-ms must be a number of milliseconds from 0.05 to 100");
        }
        if self.full_command.is_some_and(|full| full <= 0.0) {
            wrong_usage("--full-command must be a command above 0");
        }
        if self.full_command.is_some() && self.to != Target::Ardupilot {
            wrong_usage(
                "--full-command is for --to ardupilot: other files take the command as it was recorded",
            );
        }
        let servo_model = self.servo_model || self.to.needs_servo_model();
        if !servo_model && (self.controller.is_some() || self.step_ms.is_some()) {
            wrong_usage(
                "--controller and --step-ms are for a servo model: add --servo-model. The linear model is of the sample period of its recording alone; for another rate, record or resample at that",
            );
        }
        self.output.check_beside(&self.out, [&self.model])?;
        let file = ModelFile::read(&self.model)?;
        let metadata = file.metadata.clone().with_stated_frame(stated_s);
        if servo_model {
            self.write_servo_model(&file, &metadata)
        } else {
            self.write_linear_model(&file, metadata)
        }
    }

    fn write_linear_model(&self, file: &ModelFile, metadata: ModelMetadata) -> Result<String> {
        let fitted = file.flight_model()?;
        let (name, source) = (self.servo_name(), self.source());
        let servo = file.servo_model()?;
        let export = Export::new(&name, &source, &file.model, fitted, metadata)
            .beside(servo.as_ref().map(|servo| &servo.model));
        let text = export.write(self.to)?;
        if let Some(which) = export.which_model() {
            self.output.talk.say(which);
        }
        self.finish(&text, &export.warnings(), Map::new())
    }

    fn write_servo_model(&self, file: &ModelFile, metadata: &ModelMetadata) -> Result<String> {
        let document = file.servo_model()?.ok_or(ExportError::NoServoModel)?;
        let (name, source) = (self.servo_name(), self.source());
        let options = ServoExportOptions {
            controller: self.controller,
            step_s: self.step_ms.map(|step| 1e-3 * step),
            full_command: self.full_command,
        };
        let export =
            ServoExport::new(&name, &source, &document, metadata, options)?.beside(&file.model);
        let written = export.write(self.to)?;
        self.output.talk.say(format_args!(
            "largest difference from the servo model: {}",
            export.share_of_stroke(&written)
        ));
        for remark in &written.remarks {
            self.output.talk.say(remark);
        }
        if let Some(remark) = self.name_of_function(&name) {
            self.output.talk.say(remark);
        }
        let comparison = Map::from_iter([
            ("trial".to_owned(), json!(written.trial)),
            (
                "largest_difference".to_owned(),
                json!(written.largest_difference),
            ),
            (
                "largest_difference_in_strokes".to_owned(),
                json!(written.largest_difference_in_strokes),
            ),
            (
                "root_mean_square_difference".to_owned(),
                json!(written.root_mean_square_difference),
            ),
        ]);
        let mut warnings = export.warnings(self.to);
        warnings.extend(written.warnings);
        self.finish(&written.text, &warnings, comparison)
    }

    /// That MATLAB and Octave find a function by the name of its file alone.
    fn name_of_function(&self, name: &str) -> Option<String> {
        let function = identifier(name);
        let file = self.out.as_ref().filter(|_| self.to == Target::Matlab)?;
        (stem(file) != function).then(|| {
            format!(
                "warning: the file holds the function {function}, and MATLAB and Octave look for it in a file of that name: call it {function}.m"
            )
        })
    }

    /// The file that the model came from, without its folder.
    fn source(&self) -> String {
        let name = self.model.file_name().unwrap_or_default();
        name.to_string_lossy().into_owned()
    }

    fn servo_name(&self) -> String {
        self.name.clone().unwrap_or_else(|| stem(&self.model))
    }

    /// Writes or prints the text; `more` are further fields of the result.
    fn finish(&self, text: &str, warnings: &[String], more: Map<String, Value>) -> Result<String> {
        let talk = self.output.talk;
        for warning in warnings {
            talk.say(format_args!("warning: {warning}"));
        }
        let mut result = Map::from_iter([
            ("target".to_owned(), json!(self.to)),
            ("warnings".to_owned(), json!(warnings)),
        ]);
        result.extend(more);
        let Some(out) = &self.out else {
            result.insert("text".to_owned(), json!(text));
            return talk.result(text.to_owned(), &result);
        };
        self.output.write(out, text)?;
        result.insert("file".to_owned(), json!(out));
        talk.result(format!("{}\n", out.display()), &result)
    }
}
