//! `servoid identify`

use super::input::{TableArgs, identified};
use super::output::{Output, stem, wrong_usage};
use super::servo_fit;
use crate::data::dataset::suggestion::quoted;
use crate::data::dataset::{Dataset, DatasetOptions, listed};
use crate::data::model_file::ModelDocument;
use crate::data::model_metadata::ModelMetadata;
use crate::presentation::explanation;
use crate::presentation::plots::{self, Figure};
use crate::presentation::scope::step_as_text;
use crate::presentation::summary::{self, Extent};
use anyhow::Result;
use clap::Args;
use serde::Serialize;
use servoid_identification::diagnostics::Explanation;
use servoid_identification::flight_model::{FlightModel, FlightModelOptions};
use servoid_identification::nonlinear::{DirectionModel, Limits, split_by_direction};
use servoid_identification::results::{Model, StepResponse};
use servoid_identification::{Detrend, Frequencies, NoiseOrder, Options, Settling, flight_model};
use std::path::PathBuf;

/// Identify the servo's step and frequency response, with bounds
///
/// Takes recordings of servoid, or any CSV file with its columns named. Several files are several runs of the
/// same servo under the same condition; they are never joined end to end. Without other options the structure
/// is chosen from the data. -o writes the model for 'servoid validate', 'compare', 'report' and 'export'.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  servoid identify bench.csv -o bench.json --plots plots
  servoid identify mine.csv --input u --output y --period 0.02
  servoid identify bench.csv --limits --level 95
  servoid identify mine.csv --input u --output y --period 0.02 --servo-model")]
pub(super) struct Identify {
    /// Recordings, or CSV files
    #[arg(required = true, value_name = "FILE.csv")]
    files: Vec<PathBuf>,
    /// Settling time N (samples), or auto
    #[arg(long, default_value_t = Settling::Auto, value_name = "N|auto")]
    settling: Settling,
    /// Number n of frequencies (odd, at most N). auto takes all that the input excites. narrow takes the number
    /// with the narrowest band, which holds only where the response falls steeply above them
    #[arg(long, default_value_t = Frequencies::Auto, value_name = "n|auto|narrow")]
    frequencies: Frequencies,
    /// Order d of the noise model, or auto; 0 is white noise
    #[arg(long, default_value_t = NoiseOrder::Auto, value_name = "d|auto")]
    noise_order: NoiseOrder,
    /// Confidence level of every bound, as a fraction (0.99) or in percent (99)
    #[arg(long, default_value_t = 0.99, value_parser = super::value_parsers::level)]
    level: f64,
    /// What is taken out of the output of each run, within the regression: an offset, or an offset and a straight line. auto takes
    /// offsets where the runs differ, and lines where the output drifts
    #[arg(long, default_value_t = Detrend::Auto, value_name = "auto|none|offset|linear")]
    detrend: Detrend,
    /// Explain the structure: the candidates, and the reason for the choice
    #[arg(long)]
    explain: bool,
    /// Also fit a low-order model for flight simulations: gain, delay, one to three poles. The model file keeps
    /// it for 'servoid export'
    #[arg(long)]
    flight_model: bool,
    /// Also find the servo as a machine: delay, stiffness, limit of the drive, two speeds, dead band, friction and load, as
    /// far as prediction needs them. It is found by itself where the linear model has no bounds
    #[arg(long)]
    servo_model: bool,
    /// Also test for motion that is not linear: up and down strokes that differ, rate limits, hysteresis of the
    /// rest position, ends of the travel
    #[arg(long)]
    limits: bool,
    /// The model to write
    #[arg(long, short, value_name = "MODEL.json")]
    out: Option<PathBuf>,
    /// Folder for plots of input and output, step response, frequency response and validation
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    table: TableArgs,
}

/// Columns and rows of the picture of the step response: a terminal of 80 columns and 24 rows shows it with the sentence.
const PICTURE: (u16, u16) = (78, 16);

impl Identify {
    pub(super) fn run(self) -> Result<String> {
        let options = Options {
            settling: self.settling,
            frequencies: self.frequencies,
            noise_order: self.noise_order,
            level: self.level,
            detrend: self.detrend,
            ..Options::default()
        };
        if let Err(error) = options.check() {
            wrong_usage(error);
        }
        let (output, talk) = (self.output, self.output.talk);
        output.check(&self.out)?;
        let data = self.table.load(&self.files, talk)?;
        let found = identified(&data, &self.files, &options)?;
        let (model, units) = (&found.model, data.about.units());
        let explanation = self.explain.then_some(&found.explanation);
        let flight = self.flight_model.then(|| fit_flight_model(&data, model));
        let (fitted, reason) = match flight {
            Some(Ok(fitted)) => (Some(fitted), None),
            Some(Err(reason)) => (None, Some(reason)),
            None => (None, None),
        };
        let servo = servo_fit::is_wanted(self.servo_model, model.level().withdrawn())
            .then(|| servo_fit::find(&data, model, &options, self.plots.is_some(), talk));
        let (servo, no_servo, held_out) = match servo {
            Some(found) => match found.model {
                Ok(servo) => (Some(servo), None, found.held_out),
                Err(reason) => (None, Some(reason), None),
            },
            None => (None, None, None),
        };
        let mut text = String::new();
        text.extend(
            servo
                .as_ref()
                .map(|servo| summary::servo_sentence(&servo.model, units) + "\n\n"),
        );
        // A step response of which not even the times are findings is no picture of the servo.
        let picture = match talk.quiet || model.metrics.withheld.is_some() {
            true => String::new(),
            false => step_as_text(&model.step, PICTURE.0, PICTURE.1),
        };
        let extent = Extent {
            picture: &picture,
            statistics: self.explain,
        };
        text += &summary::of_model(&listed(&self.files), model, units, extent);
        text.extend(
            servo
                .as_ref()
                .map(|servo| summary::of_servo_model(&servo.model, units, self.explain)),
        );
        text.extend(
            no_servo
                .as_ref()
                .map(|reason| format!("\nno servo model: {reason}\n")),
        );
        text.extend(explanation.map(|e| explanation::as_text(e, model)));
        text.extend(fitted.as_ref().map(summary::of_flight_model));
        text.extend(
            reason
                .as_ref()
                .map(|reason| format!("\nno low-order model: {reason}\n")),
        );
        let mut result = Identified {
            model: ModelDocument {
                model,
                metadata: ModelMetadata::from(&data.about),
                record: Some(&data.record),
                servo_model: servo.as_ref(),
            },
            read_as: self.table.options(),
            explanation,
            flight_model: fitted.as_ref(),
            no_flight_model: reason.as_ref(),
            no_servo_model: no_servo.as_ref(),
            limits: None,
            directions: None,
        };
        if self.limits {
            let limits = Limits::of(&data.record, model, self.level);
            // A recording with strokes of one direction only has no split; the summary mentions it.
            let split = split_by_direction(&data.record, model).ok();
            text += &summary::of_limits(&limits, split.as_ref(), units.common());
            (result.limits, result.directions) = (Some(limits), split.map(Directions::from));
        }
        if let Some(out) = &self.out {
            output.write_json(Some(out), &result)?;
            talk.say(format_args!("model: {}", out.display()));
        }
        if let (Some(folder), Some(first)) = (&self.plots, self.files.first()) {
            let mut figures = drawn(&stem(first), &data, model, explanation);
            figures.extend(held_out.map(|found| {
                let file = format!("{}-servo-model", stem(first));
                let title = format!("Servo model, on {} that it has not seen", found.stretch);
                plots::held_out(&file, &title, &found, units.output)
            }));
            self.output.draw(folder, &figures)?;
        }
        text += &talk.next(self.next());
        talk.result(text, &result)
    }

    /// The command that shows all of this.
    fn next(&self) -> String {
        let name = |file: &PathBuf| quoted(&file.display().to_string());
        let files: Vec<String> = self.files.iter().map(name).collect();
        let several = if files.len() > 1 { "--a " } else { "" };
        let page = self
            .files
            .first()
            .map(|file| format!("{}.html", stem(file)));
        format!(
            "servoid report {several}{}{} -o {}",
            files.join(" "),
            self.table.as_typed(),
            quoted(&page.unwrap_or_default())
        )
    }
}

/// The figures of the linear model.
fn drawn(
    name: &str,
    data: &Dataset,
    model: &Model,
    explanation: Option<&Explanation>,
) -> Vec<Figure> {
    let mut figures = plots::identification(name, &data.record, model, data.about.units());
    figures.extend(explanation.map(|explanation| {
        let file = format!("{name}-structure");
        plots::structure(&file, "Choice of structure", explanation, model)
    }));
    figures
}

/// The low-order model, or the reason why there is none.
fn fit_flight_model(data: &Dataset, model: &Model) -> Result<FlightModel, String> {
    let options = FlightModelOptions {
        frame_period_s: ModelMetadata::from(&data.about).pulse_frame_s,
        ..FlightModelOptions::default()
    };
    flight_model::fit(&data.record, model, &options).map_err(|error| error.to_string())
}

/// The model as `--json` prints it and `-o` writes it, with the further results that were asked for.
#[derive(Serialize)]
struct Identified<'a> {
    #[serde(flatten)]
    model: ModelDocument<'a>,
    #[serde(skip_serializing_if = "DatasetOptions::are_default")]
    read_as: DatasetOptions,
    #[serde(skip_serializing_if = "Option::is_none")]
    explanation: Option<&'a Explanation>,
    #[serde(skip_serializing_if = "Option::is_none")]
    flight_model: Option<&'a FlightModel>,
    /// The reason why there is none though one was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    no_flight_model: Option<&'a String>,
    /// The reason why there is no servo model though one was looked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    no_servo_model: Option<&'a String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    limits: Option<Limits>,
    #[serde(skip_serializing_if = "Option::is_none")]
    directions: Option<Directions>,
}

/// Up and down strokes apart. Whether they differ is `null` where bounds are withdrawn.
#[derive(Serialize)]
struct Directions {
    asymmetric: Option<bool>,
    p: Option<f64>,
    largest_difference_percent: Option<f64>,
    at_s: Option<f64>,
    up: StepResponse,
    down: StepResponse,
}

impl From<DirectionModel> for Directions {
    fn from(split: DirectionModel) -> Self {
        let symmetry = split.symmetry.valid();
        Self {
            asymmetric: symmetry.map(|found| found.asymmetric),
            p: symmetry.map(|found| found.p),
            largest_difference_percent: symmetry.map(|found| 100.0 * found.largest_difference),
            at_s: symmetry.map(|found| found.at_s),
            up: split.up,
            down: split.down,
        }
    }
}
