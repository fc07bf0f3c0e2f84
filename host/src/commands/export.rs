//! `servoid export`

use super::output::{Output, stem, wrong_usage};
use crate::analysis::{ExportRequest, Exported};
use crate::data::model_file::ModelFile;
use crate::presentation::export::{Target, identifier};
use anyhow::Result;
use clap::Args;
use serde_json::json;
use std::path::PathBuf;

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
    /// Step of time of the servo model in the file (ms), 0.05 to 100; without it, one that suits servo and target, which the file and the terminal name: call the file once in each step
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
    /// model: 20 ms where it is from recordings of servoid, for a servo model also that of pulses that 'servoid identify'
    /// found, unknown otherwise. State it only where the recorded commands were written at the pulses that carried
    /// them: elsewhere the mean wait for a pulse, half a frame, is in the model's delay already
    #[arg(long, value_name = "MS", allow_negative_numbers = true, value_parser = super::value_parsers::finite)]
    frame_ms: Option<f64>,
    #[command(flatten)]
    output: Output,
}

impl ExportArgs {
    pub(super) fn run(self) -> Result<String> {
        let source = self.model.file_name().unwrap_or_default();
        let request = ExportRequest {
            target: self.to,
            servo_model: self.servo_model,
            controller: self.controller,
            step_ms: self.step_ms,
            full_command: self.full_command,
            frame_ms: self.frame_ms,
            name: self.name.clone().unwrap_or_else(|| stem(&self.model)),
            source: source.to_string_lossy().into_owned(),
        };
        if let Err(wrong) = request.check() {
            wrong_usage(wrong);
        }
        self.output.check_beside(&self.out, [&self.model])?;
        let exported = Exported::of(&ModelFile::read(&self.model)?, &request)?;
        self.finish(&exported, &request)
    }

    /// That the program finds what the file holds by the name of the file alone, where it has another one.
    fn other_name(&self, request: &ExportRequest) -> Option<String> {
        let name = identifier(&request.name);
        let file = self.out.as_ref()?;
        let is_function = self.to == Target::Matlab && request.is_of_servo_model();
        let wanted = match self.to {
            Target::Matlab if is_function => format!(
                "the file holds the function {name}, and MATLAB and Octave look for it in a file of that name: call it {name}.m"
            ),
            Target::Jsbsim => format!(
                "JSBSim looks for <system file=\"{name}\"/> in a file of that name: call it {name}.xml"
            ),
            _ => return None,
        };
        (stem(file) != name).then(|| format!("warning: {wanted}"))
    }

    /// Writes or prints the text.
    fn finish(&self, exported: &Exported, request: &ExportRequest) -> Result<String> {
        let talk = self.output.talk;
        for remark in &exported.remarks {
            talk.say(remark);
        }
        if let Some(remark) = self.other_name(request) {
            talk.say(remark);
        }
        for warning in &exported.warnings {
            talk.say(format_args!("warning: {warning}"));
        }
        let mut result = exported.document(self.to);
        let Some(out) = &self.out else {
            result.insert("text".to_owned(), json!(exported.text));
            return talk.result(exported.text.clone(), &result);
        };
        self.output.write(out, &exported.text)?;
        result.insert("file".to_owned(), json!(out));
        talk.result(format!("{}\n", out.display()), &result)
    }
}
