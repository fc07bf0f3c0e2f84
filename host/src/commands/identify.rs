//! `servoid identify`

use super::input::TableArgs;
use super::output::{Output, stem, wrong_usage};
use super::servo_search::{NoServoModel, ServoSearch};
use crate::analysis::{Identified, IdentifyRequest, text_of_file};
use crate::data::dataset::suggested_columns::quoted;
use crate::data::dataset::{Dataset, listed};
use crate::data::model_file::{self, ModelFile};
use crate::data::model_metadata::ModelMetadata;
use crate::presentation::plots::{self, Figure};
use crate::presentation::summary::{self, AskedSine};
use anyhow::{Result, bail};
use clap::Args;
use servoid_identification::{Detrend, Frequencies, NoiseOrder, Options, Prior, Settling};
use std::path::{Path, PathBuf};

/// Identify the servo's step and frequency response, with bounds
///
/// Takes recordings of servoid, or any CSV file with its columns named. Several files are several runs of the
/// same servo under the same condition; they are never joined end to end. Without other options the structure
/// is chosen from the data. -o writes the model for 'servoid validate', 'compare', 'report' and 'export'. Of such a
/// model alone, what it says is printed again, with --at for other sines.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  servoid identify bench.csv -o bench.json --plots plots
  servoid identify mine.csv --input u --output y --period 0.02
  servoid identify bench.csv --limits --level 95
  servoid identify bench.csv --at 8:5
  servoid identify bench.json --at 6:3,10:3          (of a model that was written before)
  servoid identify mine.csv --input u --output y --period 0.02 --servo-model")]
pub(super) struct Identify {
    /// Recordings, or CSV files; or one model
    #[arg(required = true, value_name = "FILE.csv")]
    files: Vec<PathBuf>,
    /// Settling time N (samples), or auto
    #[arg(long, default_value_t = Settling::Auto, value_name = "N|auto")]
    settling: Settling,
    /// Number n of frequencies (odd, at most N). auto takes all that the input excites, and has the narrowest bounds. narrow
    /// leaves high frequencies out, as the paper does: about twice the number that predicts best. Bounds then contain what is
    /// left out, hold only where the response falls steeply above them, and are wider
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
    /// What is known of the response before the data. none: that it is over after N. stable: that it dies out and is smooth, as
    /// much as the data say; in white noise bounds are then 1.5 to 4 times narrower, and they hold for such responses
    #[arg(long, default_value_t = Prior::None, value_name = "none|stable")]
    prior: Prior,
    /// Explain the structure: the candidates, and the reason for the choice
    #[arg(long)]
    explain: bool,
    /// Also fit a low-order model for flight simulations: gain, delay, one to three poles. The model file keeps
    /// it for 'servoid export'
    #[arg(long)]
    flight_model: bool,
    /// Also find the servo as a machine: delay, stiffness, limit of the drive, two speeds, dead band, friction and load, as
    /// far as prediction needs them. It is found by itself where the servo is not linear
    #[arg(long)]
    servo_model: bool,
    #[command(flatten)]
    no_servo_model: NoServoModel,
    /// Also test for motion that is not linear: up and down strokes that differ, rate limits, hysteresis of the
    /// rest position, ends of the travel
    #[arg(long)]
    limits: bool,
    /// Also print gain and phase at these frequencies (Hz), separated by commas: how much of such a sine arrives, and how late. With
    /// an amplitude to each side (8:5, in the unit of the command), also those of the servo as a machine, which depend on it
    #[arg(long, value_name = "HZ[:AMPLITUDE]", value_delimiter = ',', value_parser = super::value_parsers::sine)]
    at: Vec<AskedSine>,
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

impl Identify {
    pub(super) fn run(self) -> Result<String> {
        let options = Options {
            settling: self.settling,
            frequencies: self.frequencies,
            noise_order: self.noise_order,
            level: self.level,
            detrend: self.detrend,
            prior: self.prior,
            ..Options::default()
        };
        if let Err(error) = options.check() {
            wrong_usage(error);
        }
        if let [file] = &self.files[..]
            && model_file::is_model(file)
            && self.table.as_typed().is_empty()
        {
            return self.said_again(file);
        }
        let (output, talk) = (self.output, self.output.talk);
        output.check_beside(&self.out, &self.files)?;
        let data = self.table.load(&self.files, talk)?;
        let name = listed(&self.files);
        let request = IdentifyRequest {
            options,
            explain: self.explain,
            flight_model: self.flight_model,
            servo_model: self
                .no_servo_model
                .or(self.servo_model || self.at.iter().any(|sine| sine.amplitude.is_some())),
            limits: self.limits,
            held_out: self.plots.is_some(),
        };
        let watch = || ServoSearch::begin("the servo as a machine", talk);
        let found = Identified::of(&data, &name, &request, watch)?;
        let mut text = found.as_text(&data, &name, !talk.quiet);
        let servo = found
            .servo_model
            .as_ref()
            .and_then(|found| found.as_ref().ok());
        let servo = servo.map(|found| &found.model);
        let metadata = ModelMetadata::from(&data.about);
        text += &summary::at_frequencies(&found.model, servo, &metadata, &self.at)?;
        let result = found.document(&data, self.table.options());
        if let Some(out) = &self.out {
            output.write_json(Some(out), &result)?;
            talk.say(format_args!("model: {}", out.display()));
        }
        if let (Some(folder), Some(first)) = (&self.plots, self.files.first()) {
            self.output
                .draw(folder, &drawn(&stem(first), &data, &found))?;
        }
        text += &talk.next(self.next());
        talk.result(text, &result)
    }

    /// What a model file says, and its answers to the sines that are asked for.
    fn said_again(&self, path: &Path) -> Result<String> {
        let (name, talk) = (path.display().to_string(), self.output.talk);
        if self.out.is_some() || self.plots.is_some() {
            bail!("{name} is a model, which is printed again: -o and --plots take its recording");
        }
        talk.say(format_args!(
            "{name} is a model: it is printed again, and nothing is identified"
        ));
        let written = model_file::read_text(path)?;
        let file = ModelFile::parse(&written, path)?;
        let servo = file.servo_model()?;
        let servo = servo.as_ref().map(|servo| &servo.model);
        let sines = summary::at_frequencies(&file.model, servo, &file.metadata, &self.at)?;
        let text = text_of_file(&file, &name)? + &sines;
        talk.result(text, &serde_json::from_str::<serde_json::Value>(&written)?)
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

/// The figures of what was found.
fn drawn(name: &str, data: &Dataset, found: &Identified) -> Vec<Figure> {
    let (model, units) = (&found.model, data.about.units());
    let mut figures = plots::identification(name, &data.record, model, units);
    figures.extend(found.explanation().map(|explanation| {
        let file = format!("{name}-structure");
        plots::structure(&file, "Choice of structure", explanation, model)
    }));
    figures.extend(found.held_out.as_ref().map(|stretch| {
        let file = format!("{name}-servo-model");
        let title = format!("Servo model, on {} that it has not seen", stretch.stretch);
        plots::held_out(&file, &title, stretch, units.output)
    }));
    figures
}
