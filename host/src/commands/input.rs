//! The input of commands: recordings, CSV files of other programs, and models.

use super::output::{Talk, stem, wrong_usage};
use crate::data::dataset::suggestion::quoted;
use crate::data::dataset::{self, Dataset, DatasetOptions, TimeUnit, listed};
use crate::data::fingerprint;
use crate::data::model_metadata::ModelMetadata;
use crate::instrument::simulated_servo::{self, SimulatedServoError};
use anyhow::{Context, Result};
use clap::Args;
use servoid_identification::comparison::{Comparison, ComparisonOptions, compare};
use servoid_identification::results::{Advice, Check};
use servoid_identification::{Identification, Options, identify_explained};
use servoid_protocol::hello::INTERNAL_CLOCK_ERROR;
use servoid_simulator::SimulationOptions;
use std::path::{Path, PathBuf};

/// The options that describe CSV files of other programs.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Input files")]
pub(super) struct TableArgs {
    /// Column of the input (the command), for files that servoid has not recorded. Its unit may be left out
    /// where that is clear: angle for "angle [deg]"
    #[arg(long, value_name = "COLUMN")]
    input: Option<String>,
    /// Column of the output (the measured motion)
    #[arg(long, value_name = "COLUMN")]
    output: Option<String>,
    /// Time between rows (s); without it, from a time column such as 't', 'time_ms', 'Time [s]' or 'Zeit'
    #[arg(long, value_name = "SECONDS", value_parser = super::value_parsers::period)]
    period: Option<f64>,
    /// Time column, where its name is not recognised
    #[arg(long, value_name = "COLUMN")]
    time: Option<String>,
    /// Unit of a time column whose name does not have it
    #[arg(long, value_enum, value_name = "UNIT")]
    time_unit: Option<TimeUnit>,
    /// Column whose value changes where a new run begins
    #[arg(long, value_name = "COLUMN")]
    run: Option<String>,
    /// Column with the name or gain of the controller that drove the run, where several drove the same mechanism: the
    /// servo model fits them together
    #[arg(long, value_name = "COLUMN")]
    controller: Option<String>,
    /// The input's value during at least the settling time before each run; then no row is left out. Give it
    /// only if it is true: a wrong value is far worse than none
    #[arg(long, value_name = "INPUT", allow_negative_numbers = true, value_parser = super::value_parsers::finite)]
    at_rest: Option<f64>,
    /// Use the rest at neutral before and after the reference of servoid's recordings too. Its strokes are half
    /// as long, and a real servo does not follow them in proportion
    #[arg(long)]
    with_rest: bool,
}

impl TableArgs {
    /// These options as a user types them, each with a space before it.
    pub(super) fn as_typed(&self) -> String {
        let number = |number: f64| number.to_string();
        let given = [
            ("--input", self.input.clone()),
            ("--output", self.output.clone()),
            ("--period", self.period.map(number)),
            ("--time", self.time.clone()),
            (
                "--time-unit",
                self.time_unit.map(|unit| unit.names().0.to_owned()),
            ),
            ("--run", self.run.clone()),
            ("--controller", self.controller.clone()),
            ("--at-rest", self.at_rest.map(number)),
        ];
        let typed = given.into_iter().filter_map(|(option, value)| {
            let value = quoted(&value?);
            Some(format!(" {option} {value}"))
        });
        let with_rest = if self.with_rest { " --with-rest" } else { "" };
        typed.collect::<String>() + with_rest
    }

    /// How these options say that files are to be read.
    pub(super) fn options(&self) -> DatasetOptions {
        let args = self.clone();
        DatasetOptions {
            input: args.input,
            output: args.output,
            period_s: args.period,
            time: args.time,
            time_unit: args.time_unit,
            run: args.run,
            controller: args.controller,
            at_rest: args.at_rest,
            with_rest: args.with_rest,
        }
    }

    /// The runs of these files together.
    pub(super) fn load(&self, files: &[PathBuf], talk: Talk) -> Result<Dataset> {
        self.load_as(&DatasetOptions::default(), files, talk)
    }

    /// The runs of these files together, read as the runs of a model were unless these options say otherwise. Files that cannot
    /// be read so, such as recordings of servoid, are read for themselves.
    pub(super) fn load_as(
        &self,
        model: &DatasetOptions,
        files: &[PathBuf],
        talk: Talk,
    ) -> Result<Dataset> {
        let own = self.options();
        let options = self.options().or(model);
        let data = match dataset::load(files, &options) {
            Err(error) if options != own => dataset::load(files, &own).map_err(|_| error)?,
            read => {
                if options != own {
                    talk.say("the files are read as those of the model were (columns, period, runs); options override this");
                }
                read?
            }
        };
        data.about
            .remarks
            .iter()
            .for_each(|remark| talk.say(remark));
        Ok(data)
    }

    /// The two sides of a comparison.
    pub(super) fn load_sides(&self, sides: [&[PathBuf]; 2], talk: Talk) -> Result<[Dataset; 2]> {
        let sides = dataset::load_sides(sides, &self.options())?;
        let remarks = sides.iter().flat_map(|side| &side.about.remarks);
        remarks.for_each(|remark| talk.say(remark));
        Ok(sides)
    }
}

/// The simulated servo with this text, which a port has after `sim:`; one that is none is wrong usage.
pub(super) fn simulated_servo(text: &str) -> Result<SimulationOptions> {
    use SimulatedServoError::{NoControllers, Options, Unknown};
    match simulated_servo::options(text) {
        Err(error @ (Options(_) | Unknown(_) | NoControllers(_))) => wrong_usage(error),
        other => Ok(other?),
    }
}

/// Whether a file is a model, by its ending; any other file is read as a recording.
pub(super) fn is_model(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "json")
}

/// Identifies data; its advice becomes the model's.
pub(super) fn identified(
    data: &Dataset,
    files: &[PathBuf],
    options: &Options,
) -> Result<Identification> {
    let found = identify_explained(&data.record, options);
    let mut found = found.with_context(|| listed(files))?;
    found.model.advice.extend(data.about.advice.iter().cloned());
    let doubtful = unlikely_period(data.record.sample_period_s());
    found.model.advice.splice(0..0, doubtful);
    if data.about.inexact_clock {
        let [slow, fast] = INTERNAL_CLOCK_ERROR;
        found.model.metrics = found.model.metrics.with_clock_error(slow, fast);
    }
    Ok(found)
}

/// Sample periods of recordings of a servo \[s\]: with a longer one its motion is over between two samples, and no converter for
/// servos has a shorter one.
const PERIODS_S: std::ops::RangeInclusive<f64> = 20e-6..=0.2;

/// That no servo is recorded with this time between samples.
fn unlikely_period(seconds: f64) -> Option<Advice> {
    if PERIODS_S.contains(&seconds) {
        return None;
    }
    let (limit, rather) = match seconds > *PERIODS_S.end() {
        true => (*PERIODS_S.end(), 1e-3 * seconds),
        false => (*PERIODS_S.start(), 1e3 * seconds),
    };
    Some(Advice::new(
        Check::Period,
        format!(
            "The time between samples is taken to be {seconds} s, which is not that of a recording of a servo: all times and frequencies \
             follow from it."
        ),
        seconds,
        limit,
        format!(
            "State it in seconds: --period {} if it is {} ms.",
            rounded(rather),
            rounded(1e3 * rather)
        ),
    ))
}

/// The first digits of a number.
fn rounded(number: f64) -> f64 {
    (number * 1e9).round() / 1e9
}

/// The name of data: their condition, or that of the first file.
pub(super) fn name_of(data: &Dataset, files: &[PathBuf]) -> String {
    let first = || files.first().map(|file| stem(file));
    data.about
        .condition
        .clone()
        .or_else(first)
        .unwrap_or_default()
}

/// Compares the data of two sides. The most important advice comes first: that both have the same samples.
pub(super) fn compared(
    [a, b]: [&Dataset; 2],
    names: [&str; 2],
    options: ComparisonOptions,
) -> Result<Comparison> {
    let metadata = [a, b].map(|side| ModelMetadata::from(&side.about));
    metadata[0].same_units(names[0], &metadata[1], names[1])?;
    let options = ComparisonOptions {
        input_unit: a.about.input_unit_with(&b.about),
        output_unit: a.about.output_unit_with(&b.about),
        ..options
    };
    let found = compare(&a.record, &b.record, &options);
    let mut found = found.with_context(|| names.join(" against "))?;
    let [prints_a, prints_b] = [a, b].map(|side| fingerprint::of(&side.record));
    let same = fingerprint::advice_on_sides(&prints_a, &prints_b);
    found.advice.splice(0..0, same);
    found.advice.extend(a.about.other_calibration(&b.about));
    Ok(found)
}
