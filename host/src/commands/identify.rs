//! `servoid identify`

use super::file_names::stem;
use super::output_args::Talk;
use super::table_args::TableArgs;
use super::usage::wrong_usage;
use crate::commands::output_files;
use crate::data::dataset;
use crate::data::dataset::Dataset;
use crate::data::dataset::listed;
use crate::data::dataset::suggestion::quoted;
use crate::data::model_file::ModelDocument;
use crate::data::model_metadata::ModelMetadata;
use crate::presentation::explanation;
use crate::presentation::plots::{paper_figures, structure};
use crate::presentation::summary;
use anyhow::{Context, Result};
use clap::Args;
use serde::Serialize;
use servoid_identification::diagnostics::Explanation;
use servoid_identification::flight_model::{FlightModel, FlightModelOptions};
use servoid_identification::nonlinear::{DirectionModel, Limits, split_by_direction};
use servoid_identification::results::{Model, StepResponse};
use servoid_identification::{
    Frequencies, NoiseOrder, Options, Settling, flight_model, identify_explained,
};
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
  servoid identify bench.csv --limits --level 95")]
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
    /// Explain the structure: the candidates, and the reason for the choice
    #[arg(long)]
    explain: bool,
    /// Also fit a low-order model for flight simulations: gain, delay, one to three poles. The model file keeps
    /// it for 'servoid export'
    #[arg(long)]
    flight_model: bool,
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
    /// Replace files that exist
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    talk: Talk,
    #[command(flatten)]
    table: TableArgs,
}

impl Identify {
    pub(super) fn run(self) -> Result<String> {
        let options = Options {
            settling: self.settling,
            frequencies: self.frequencies,
            noise_order: self.noise_order,
            level: self.level,
            ..Options::default()
        };
        if let Err(error) = options.check() {
            wrong_usage(error);
        }
        if let Some(out) = &self.out {
            output_files::check_free(out, self.force)?;
        }
        let data = dataset::load(&self.files, &self.table.clone().into())?;
        data.about
            .remarks
            .iter()
            .for_each(|remark| self.talk.say(remark));
        let mut found =
            identify_explained(&data.record, &options).with_context(|| listed(&self.files))?;
        found.model.advice.extend(data.about.advice.iter().cloned());
        let (model, units) = (&found.model, data.about.units());
        let explanation = self.explain.then_some(&found.explanation);
        let flight = self.flight_model.then(|| fit_flight_model(&data, model));

        let mut result = Identified::of(model, &data);
        result.flight_model = flight.as_ref().and_then(|fitted| fitted.as_ref().ok());
        if let Some(out) = &self.out {
            output_files::write_file(out, self.force, &output_files::to_json(&result)?)?;
            self.talk.say(format_args!("model: {}", out.display()));
        }
        self.draw(&data, model, explanation)?;

        let mut text = summary::of_model(&listed(&self.files), model, units);
        text.extend(explanation.map(|e| explanation::as_text(e, model)));
        result.explanation = explanation;
        match &flight {
            Some(Ok(fitted)) => text += &summary::of_flight_model(fitted),
            Some(Err(reason)) => {
                text += &format!("\nno model of low order: {reason}\n");
                result.no_flight_model = Some(reason);
            }
            None => {}
        }
        if self.limits {
            let limits = Limits::of(&data.record, model, self.level);
            // A recording with strokes of one direction only has no split; the summary says so.
            let split = split_by_direction(&data.record, model).ok();
            text += &summary::of_limits(&limits, split.as_ref(), units.common());
            result.directions = split.map(Directions::from);
            result.limits = Some(limits);
        }
        self.talk.say(self.next());
        self.talk.result(text, &result)
    }

    /// Writes the plots, where a folder for them was named.
    fn draw(&self, data: &Dataset, model: &Model, explanation: Option<&Explanation>) -> Result<()> {
        let (Some(folder), Some(first)) = (&self.plots, self.files.first()) else {
            return Ok(());
        };
        let name = stem(first);
        let mut figures =
            paper_figures::identification(&name, &data.record, model, data.about.units());
        let structure = |explanation| {
            let file = format!("{name}-structure");
            structure::structure(&file, "Choice of structure", explanation, model)
        };
        figures.extend(explanation.map(structure));
        let files = output_files::write_figures(folder, self.force, &figures)?;
        self.talk.say(format_args!("plots: {}", listed(&files)));
        Ok(())
    }

    /// The command that shows all of this.
    fn next(&self) -> String {
        let files: Vec<String> = self
            .files
            .iter()
            .map(|file| quoted(&file.display().to_string()))
            .collect();
        let several = if files.len() > 1 { "--a " } else { "" };
        let page = self
            .files
            .first()
            .map_or_else(String::new, |file| format!("{}.html", stem(file)));
        format!(
            "to look at it: servoid report {several}{}{} -o {}",
            files.join(" "),
            self.table.as_typed(),
            quoted(&page)
        )
    }
}

/// The model of low order, or why there is none.
fn fit_flight_model(data: &Dataset, model: &Model) -> Result<FlightModel, String> {
    let options = FlightModelOptions {
        frame_period_s: ModelMetadata::from(&data.about).pulse_frame_s,
        ..FlightModelOptions::default()
    };
    flight_model::fit(&data.record, model, &options).map_err(|error| error.to_string())
}

/// The model as `--json` prints it, and beside it what else was asked for.
#[derive(Serialize)]
struct Identified<'a> {
    #[serde(flatten)]
    model: ModelDocument<'a>,
    #[serde(skip_serializing_if = "Option::is_none")]
    explanation: Option<&'a Explanation>,
    #[serde(skip_serializing_if = "Option::is_none")]
    flight_model: Option<&'a FlightModel>,
    /// Why there is no model of low order though one was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    no_flight_model: Option<&'a String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    limits: Option<Limits>,
    #[serde(skip_serializing_if = "Option::is_none")]
    directions: Option<Directions>,
}

impl<'a> Identified<'a> {
    fn of(model: &'a Model, data: &'a Dataset) -> Self {
        Self {
            model: ModelDocument {
                model,
                metadata: ModelMetadata::from(&data.about),
                record: Some(&data.record),
            },
            explanation: None,
            flight_model: None,
            no_flight_model: None,
            limits: None,
            directions: None,
        }
    }
}

/// Up and down strokes apart.
#[derive(Serialize)]
struct Directions {
    asymmetric: bool,
    p: f64,
    largest_difference_percent: f64,
    at_s: f64,
    up: StepResponse,
    down: StepResponse,
}

impl From<DirectionModel> for Directions {
    fn from(split: DirectionModel) -> Self {
        Self {
            asymmetric: split.symmetry.asymmetric,
            p: split.symmetry.p,
            largest_difference_percent: 100.0 * split.symmetry.largest_difference,
            at_s: split.symmetry.at_s,
            up: split.up,
            down: split.down,
        }
    }
}
