//! `servoid report`

use super::compare::warn_of_small_margin;
use super::input::{SecondSideArgs, TableArgs, common_name, name_of};
use super::output::{Output, Talk, sides_are_open, stem, wrong_usage};
use super::servo_search::{NoServoModel, ServoSearch};
use crate::analysis::{
    compared, compared_models, compared_servos, identified, low_order, servo_fit,
};
use crate::data::dataset::{Dataset, DatasetOptions, listed};
use crate::data::model_file::{ModelFile, is_model};
use crate::presentation::report::{self, Page, Servo};
use anyhow::Result;
use clap::Args;
use servoid_identification::Options;
use servoid_identification::comparison::{Comparison, ComparisonOptions, ServoModelComparison};
use std::path::PathBuf;

/// Write a page on one servo, or on the comparison of two, with figures to zoom in
///
/// Takes one or two recordings or models, or several runs of each side. Recordings are identified with the
/// structure chosen from the data. The page is a single file that opens in any browser, without a network.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  servoid report bench.csv aircraft.csv -o report.html
  servoid report --a bench1.csv bench2.csv bench3.csv --b air1.csv air2.csv air3.csv -o report.html
  servoid report mine.csv --input u --output y --period 0.02 -o report.html")]
pub(super) struct Report {
    /// A recording or a model, or two, the reference condition first
    #[arg(required_unless_present = "a", num_args = 1.., value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Recordings of the servo, or of the reference condition, several runs
    #[arg(long, num_args = 1.., value_name = "FILE", conflicts_with = "files")]
    a: Vec<PathBuf>,
    /// Recordings of the other condition, several runs
    #[arg(long, num_args = 1.., value_name = "FILE", conflicts_with = "files", requires = "a")]
    b: Vec<PathBuf>,
    /// The page to write
    #[arg(long, short, value_name = "FILE.html")]
    out: PathBuf,
    /// Title of the page
    #[arg(long, default_value = report::TITLE)]
    title: String,
    /// The largest difference that still counts as the same (percent of the step)
    #[arg(long, default_value_t = 5.0, value_name = "PERCENT", value_parser = super::value_parsers::margin)]
    margin: f64,
    /// Also find the servo as a machine in every recording. It is found by itself where the servo is not linear
    #[arg(long)]
    servo_model: bool,
    #[command(flatten)]
    no_servo_model: NoServoModel,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    table: TableArgs,
    #[command(flatten)]
    second: SecondSideArgs,
}

impl Report {
    pub(super) fn run(self) -> Result<String> {
        let talk = self.output.talk;
        if self.files.len() > 2 {
            wrong_usage(sides_are_open("report", &self.files));
        }
        let read = self.files.iter().chain(&self.a).chain(&self.b);
        self.output.check_beside([&self.out], read)?;
        let sides: Vec<&[PathBuf]> = match &self.files[..] {
            [] if self.b.is_empty() => vec![&self.a],
            [] => vec![&self.a, &self.b],
            files => files.chunks(1).collect(),
        };
        let mut servos = match sides[..] {
            [a, b] if model_file(a).is_none() && model_file(b).is_none() => {
                let [data_a, data_b] = self.table.load_sides([a, b], &self.second, talk)?;
                vec![self.servo(a, data_a)?, self.servo(b, data_b)?]
            }
            ref sides => {
                // A recording beside a model is read as the file of the model was.
                let models = sides.iter().copied().find_map(model_file);
                let like = models.map(|model| ModelFile::read(model)).transpose()?;
                let like = like.map(|model| model.read_as).unwrap_or_default();
                let servos = sides.iter().map(|side| self.read(side, &like));
                servos.collect::<Result<_>>()?
            }
        };
        if let ([first, second], [a, b]) = (&mut servos[..], &sides[..]) {
            distinguish([first, second], [a, b]);
        }
        let comparison = match &servos[..] {
            [a, b] => comparison(a, b, self.margin, talk)?,
            _ => None,
        };
        let servo_models = match &servos[..] {
            [a, b] => servo_models(a, b),
            _ => None,
        };
        let [first, others @ ..] = &servos[..] else {
            wrong_usage("name a recording or a model to report on");
        };
        let page = report::page(&Page {
            title: &self.title,
            first: first.part(),
            second: others.first().map(Servo::part),
            comparison: comparison.as_ref(),
            servo_models: servo_models.as_ref(),
            paper: &[],
        })?;
        self.output.write(&self.out, &page)?;
        let text = format!("{}: open it in a browser\n", self.out.display());
        talk.result(text, &serde_json::json!({ "file": self.out }))
    }

    fn read(&self, files: &[PathBuf], like: &DatasetOptions) -> Result<Servo> {
        let Some(file) = model_file(files) else {
            let data = self.table.load_as(like, files, self.output.talk)?;
            return self.servo(files, data);
        };
        Ok(Servo::of_file(stem(file), &ModelFile::read(file)?)?)
    }

    fn servo(&self, files: &[PathBuf], data: Dataset<'static>) -> Result<Servo> {
        let (options, talk) = (Options::default(), self.output.talk);
        let mut found = identified(&data, &listed(files), &options)?;
        let low_order = low_order(false, &data, &found).and_then(Result::ok);
        let search = self.no_servo_model.or(self.servo_model);
        let machine = servo_fit::is_wanted(search, &found).then(|| {
            let search = ServoSearch::begin("the servo as a machine", talk);
            servo_fit::find(&data, &mut found, &options, true, &search)
        });
        let mut servo = Servo::of_data(name_of(&data, files), data, found);
        servo.low_order = low_order;
        match machine.map(|found| (found.model, found.held_out)) {
            Some((Ok(model), held_out)) => {
                (servo.servo_model, servo.held_out) = (Some(model), held_out);
            }
            Some((Err(reason), _)) => {
                talk.say(format_args!("{}: no servo model: {reason}", listed(files)));
            }
            None => {}
        }
        Ok(servo)
    }
}

/// Gives two servos two names: those of their files where the conditions are the same.
fn distinguish([first, second]: [&mut Servo; 2], files: [&[PathBuf]; 2]) {
    if first.name == second.name {
        [first.name, second.name] = files.map(common_name);
    }
    if first.name == second.name {
        first.name.push_str(" 1");
        second.name.push_str(" 2");
    }
}

/// The model that a side is, where it is one.
fn model_file(files: &[PathBuf]) -> Option<&PathBuf> {
    match files {
        [file] if is_model(file) => Some(file),
        _ => None,
    }
}

/// The two servos as machines beside each other, where both were found and have the same units.
fn servo_models(a: &Servo, b: &Servo) -> Option<ServoModelComparison> {
    a.metadata.same_units(&a.name, &b.metadata, &b.name).ok()?;
    let both = a.servo_model.as_ref().zip(b.servo_model.as_ref())?;
    let models = [&both.0.model, &both.1.model];
    Some(compared_servos(models, [&a.metadata, &b.metadata]))
}

/// The comparison of the two; `None` where there is none, as for a recording beside a model.
fn comparison(a: &Servo, b: &Servo, margin: f64, talk: Talk) -> Result<Option<Comparison>> {
    warn_of_small_margin(margin, talk);
    let options = ComparisonOptions {
        margin_percent: margin,
        ..ComparisonOptions::default()
    };
    if let Err(reason) = a.metadata.same_units(&a.name, &b.metadata, &b.name) {
        talk.say(format_args!("no verdict: {reason}"));
        return Ok(None);
    }
    match (&a.data, &b.data) {
        (Some(data_a), Some(data_b)) => {
            compared([data_a, data_b], [&a.name, &b.name], options).map(Some)
        }
        (None, None) => {
            let (models, metadata) = ([&a.model, &b.model], [&a.metadata, &b.metadata]);
            compared_models(models, metadata, [&a.name, &b.name], options).map(Some)
        }
        _ => {
            talk.say("no verdict on a recording beside a model: the page shows both; a verdict needs two recordings or two models");
            Ok(None)
        }
    }
}
