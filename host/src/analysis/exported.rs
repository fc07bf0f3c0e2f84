//! A model of a file for another program, with what whoever uses it must know.

use crate::data::model_file::ModelFile;
use crate::data::model_metadata::{ModelMetadata, PULSE_FRAMES_S, SHORTEST_FRAME_S};
use crate::presentation::export::servo_model::{JSBSIM_STEP_S, ServoExport, ServoExportOptions};
use crate::presentation::export::{Export, ExportError, Target};
use anyhow::Result;
use serde_json::{Map, Value, json};

/// Steps of time that a simulation may have \[ms\]; beyond, it is a slip.
const STEPS_MS: std::ops::RangeInclusive<f64> = 0.05..=100.0;

/// What is to be written, and how.
#[derive(Clone, Debug)]
pub struct ExportRequest {
    /// The program that it is for.
    pub target: Target,
    /// Whether it is the servo model also where the target takes the linear one.
    pub servo_model: bool,
    /// The controller of the servo model, as the recordings call it.
    pub controller: Option<f64>,
    /// Step of time of the servo model \[ms\]; without it, one that suits servo and target.
    pub step_ms: Option<f64>,
    /// The command that fully deflects a servo of ArduPilot \[unit of the command\].
    pub full_command: Option<f64>,
    /// The pulse frame \[ms\]; without it, that of the model.
    pub frame_ms: Option<f64>,
    /// Name of the servo; any text.
    pub name: String,
    /// Where the model comes from; any text.
    pub source: String,
}

impl ExportRequest {
    /// Whether the options are possible, and fit each other.
    ///
    /// # Errors
    /// What is wrong, by the names of the options.
    pub fn check(&self) -> Result<(), &'static str> {
        let frame_s = self.frame_s();
        let is_frame = |frame_s: f64| {
            PULSE_FRAMES_S.contains(&frame_s) && (frame_s == 0.0 || frame_s >= SHORTEST_FRAME_S)
        };
        if frame_s.is_some_and(|frame_s| !is_frame(frame_s)) {
            return Err("--frame-ms must be a number of milliseconds: 0, or 1 to 1000");
        }
        if self.step_ms.is_some_and(|step| !STEPS_MS.contains(&step)) {
            return Err("--step-ms must be a number of milliseconds from 0.05 to 100");
        }
        if self
            .full_command
            .is_some_and(|full| full.is_nan() || full <= 0.0)
        {
            return Err("--full-command must be a command above 0");
        }
        if self.full_command.is_some() && self.target != Target::Ardupilot {
            return Err(
                "--full-command is for --to ardupilot: other files take the command as it was recorded",
            );
        }
        if !self.is_of_servo_model() && (self.controller.is_some() || self.step_ms.is_some()) {
            return Err(
                "--controller and --step-ms are for a servo model: add --servo-model. The linear model is of the sample period of its recording alone; for another rate, record or resample at that",
            );
        }
        Ok(())
    }

    /// Whether the servo as a machine is written, and not the linear model.
    #[must_use]
    pub fn is_of_servo_model(&self) -> bool {
        self.servo_model || self.target.needs_servo_model()
    }

    fn frame_s(&self) -> Option<f64> {
        self.frame_ms.map(|frame| 1e-3 * frame)
    }
}

/// A file for another program.
#[derive(Clone, Debug, PartialEq)]
pub struct Exported {
    /// Its text.
    pub text: String,
    /// What whoever uses it must know, a sentence each.
    pub remarks: Vec<String>,
    /// What limits its use, a sentence each.
    pub warnings: Vec<String>,
    /// How far a servo model for this program is from that of the file, and under which command.
    difference: Map<String, Value>,
}

impl Exported {
    /// The model of a file, for the target of the request.
    ///
    /// # Errors
    /// The file has no such model, or the target cannot have it.
    pub fn of(file: &ModelFile, request: &ExportRequest) -> Result<Self> {
        let metadata = file.metadata.clone().with_stated_frame(request.frame_s());
        match request.is_of_servo_model() {
            true => Self::of_servo_model(file, metadata, request),
            false => Self::of_linear_model(file, metadata, request),
        }
    }

    fn of_linear_model(
        file: &ModelFile,
        metadata: ModelMetadata,
        request: &ExportRequest,
    ) -> Result<Self> {
        let (fitted, servo) = (file.flight_model()?, file.servo_model()?);
        let (name, source) = (&request.name, &request.source);
        let waits = servo
            .as_ref()
            .and_then(|servo| servo.model.fit.waits_for_pulses);
        let of_frame = match waits {
            Some(waits) => Some(ModelMetadata::wait_remark(waits)),
            None => metadata.frame_remark(),
        };
        let export = Export::new(name, source, &file.model, fitted, metadata)
            .beside(servo.as_ref().map(|servo| &servo.model));
        Ok(Self {
            text: export.write(request.target)?,
            remarks: (export.which_model().into_iter()).chain(of_frame).collect(),
            warnings: export.warnings(),
            difference: Map::new(),
        })
    }

    fn of_servo_model(
        file: &ModelFile,
        metadata: ModelMetadata,
        request: &ExportRequest,
    ) -> Result<Self> {
        let document = file.servo_model()?.ok_or(ExportError::NoServoModel)?;
        let metadata = metadata.behind_pulses(document.model.fit.waits_for_pulses);
        let step_s = request.step_ms.map_or(JSBSIM_STEP_S, |step| 1e-3 * step);
        let frame = match request.target {
            Target::Jsbsim => metadata.with_frame_in_steps(step_s),
            _ => metadata.with_frame_as_it_is(),
        };
        let metadata = &frame.metadata;
        let options = ServoExportOptions {
            controller: request.controller,
            step_s: request.step_ms.map(|step| 1e-3 * step),
            full_command: request.full_command,
        };
        let (name, source) = (&request.name, &request.source);
        let export =
            ServoExport::new(name, source, &document, metadata, options)?.beside(&file.model);
        let written = export.write(request.target)?;
        let share = export.share_of_stroke(&written);
        let mut remarks = vec![format!("largest difference from the servo model: {share}")];
        remarks.extend(written.remarks);
        remarks.extend(metadata.frame_remark());
        remarks.extend(frame.remark);
        remarks.extend(export.hold_remark(request.target));
        let mut warnings = export.warnings(request.target);
        warnings.extend(written.warnings);
        warnings.extend(frame.warning);
        let difference = Map::from_iter([
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
        Ok(Self {
            text: written.text,
            remarks,
            warnings,
            difference,
        })
    }

    /// What `--json` prints of it, without the text.
    #[must_use]
    pub fn document(&self, target: Target) -> Map<String, Value> {
        let mut found = Map::from_iter([
            ("target".to_owned(), json!(target)),
            ("warnings".to_owned(), json!(self.warnings)),
        ]);
        found.extend(self.difference.clone());
        found
    }
}
