//! `servoid demo`

use super::capture::{CaptureJob, Monitor, capture, first_partial};
use super::ctrl_c;
use super::output::{Output, Talk, make_folder, typed_path};
use crate::analysis::identified;
use crate::data::dataset::{self, DatasetOptions, listed};
use crate::data::model_file::ModelDocument;
use crate::data::model_metadata::ModelMetadata;
use crate::data::rig_file::RigFile;
use crate::presentation::report::{self, Page, Servo};
use crate::presentation::{paper_values, plots, summary};
use anyhow::Result;
use clap::Args;
use serde::Serialize;
use servoid_identification::comparison::{ComparisonOptions, compare};
use servoid_identification::results::Metrics;
use servoid_identification::{Options, Record};
use servoid_protocol::reference::{Reference, Staircase};
use std::path::PathBuf;

/// Repeat the paper on simulated rigs: capture, identify, compare bench and aircraft
///
/// Needs no hardware. Writes two recordings, two models, their comparison, the paper's figures, a report for the
/// browser, and summary.json.
#[derive(Debug, Args)]
#[command(after_help = "Example:
  servoid demo --out demo")]
pub(super) struct Demo {
    /// Folder for all files; those of an earlier demo in it are replaced
    #[arg(long, short, default_value = "demo", value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    output: Output,
}

/// The files beside the plots.
const FILES: [&str; 7] = [
    "bench.csv",
    "aircraft.csv",
    "bench.json",
    "aircraft.json",
    "comparison.json",
    "summary.json",
    REPORT,
];

/// Marks of its recordings and of its summary, by which a later demo recognises them.
const NOTES: &str = "simulated by servoid demo";
const PAPER_KEY: &str = "\"paper\"";

/// The page with all results.
const REPORT: &str = "report.html";

/// `summary.json`
#[derive(Serialize)]
struct Summary {
    bench: Metrics,
    aircraft: Metrics,
    paper: Vec<paper_values::Fact>,
}

impl Demo {
    pub(super) fn run(self) -> Result<String> {
        make_folder(&self.out)?;
        self.check_folder()?;
        ctrl_c::listen()?;
        let (bench, bench_record) = self.measure("bench")?;
        let (aircraft, aircraft_record) = self.measure("aircraft")?;
        let options = ComparisonOptions {
            wait_samples: Some(paper_values::WAIT_SAMPLES),
            input_unit: "deg".to_owned(),
            output_unit: "deg".to_owned(),
            ..ComparisonOptions::default()
        };
        let comparison = compare(&bench_record, &aircraft_record, &options)?;
        let replace = self.replace();
        replace.write_json(Some(&self.out.join("comparison.json")), &comparison)?;
        let summary = Summary {
            bench: bench.model.metrics,
            aircraft: aircraft.model.metrics,
            paper: paper_values::facts(&bench.model, &aircraft.model, &comparison),
        };
        replace.write_json(Some(&self.out.join("summary.json")), &summary)?;
        let (first, second) = (bench.part(), aircraft.part());
        let figures = plots::paper(&first.subject, Some(&second.subject), true);
        let figures: Vec<plots::Figure> = figures.into_iter().map(|found| found.figure).collect();
        let quiet = Output {
            talk: Talk {
                quiet: true,
                ..replace.talk
            },
            ..replace
        };
        quiet.draw(&self.out.join("plots"), &figures)?;
        let page = report::page(&Page {
            title: "A servo on the bench and on the aircraft, simulated",
            first,
            second: Some(second),
            comparison: Some(&comparison),
            servo_models: None,
            paper: &summary.paper,
        })?;
        replace.write(&self.out.join(REPORT), &page)?;
        let text = format!(
            "The first is the bench, the second the aircraft.\n{}\n\n{}\n{}\nrecordings, models, comparison.json, summary.json and {} plots are in {}\nopen {} in a browser to look around, or see a step response here: servoid identify {}\n",
            summary::wrapped(&comparison.summary, 0),
            summary::table_of_comparison("bench", "aircraft", &comparison),
            paper_values::as_table(&summary.paper),
            figures.len(),
            self.out.display(),
            self.out.join(REPORT).display(),
            typed_path(&self.out.join("bench.csv"))
        );
        replace.talk.result(text, &summary)
    }

    /// Files of the demo are replaced once the folder is checked.
    fn replace(&self) -> Output {
        Output {
            force: true,
            ..self.output
        }
    }

    /// Fails if a file would be replaced that no demo has made: people call recordings "bench.csv".
    fn check_folder(&self) -> Result<()> {
        let made_by_demo = |name: &str, mark: &str| {
            let text = std::fs::read_to_string(self.out.join(name));
            text.is_ok_and(|text| text.contains(mark))
        };
        let demo_was_here = made_by_demo("summary.json", PAPER_KEY);
        let is_own =
            |name: &str| demo_was_here && (!name.ends_with(".csv") || made_by_demo(name, NOTES));
        let others = FILES.iter().filter(|name| !is_own(name));
        let others: Vec<PathBuf> = others.map(|name| self.out.join(name)).collect();
        self.output.check(&others)
    }

    /// Captures a simulated servo and identifies it.
    fn measure(&self, condition: &str) -> Result<(Servo, Record<'static>)> {
        let talk = self.output.talk;
        let files = [self.out.join(format!("{condition}.csv"))];
        let job = CaptureJob {
            address: &format!("sim:{condition}?seed=1"),
            rig: RigFile::default(),
            reference: Reference::Staircase(Staircase::PAPER),
            condition,
            notes: NOTES,
            release: false,
            files: &files,
            force: true,
            inexact_clock: false,
        };
        let ends = capture(&job, &Monitor::plain(talk), talk)?;
        if let Some(partial) = first_partial(&files, &ends) {
            return Err(partial.into());
        }
        let data = dataset::load(&files, &DatasetOptions::default())?;
        let found = identified(&data, &listed(&files), &Options::default())?;
        let document = ModelDocument {
            model: &found.model,
            metadata: ModelMetadata::from(&data.about),
            record: Some(&data.record),
            servo_model: None,
        };
        let file = self.out.join(format!("{condition}.json"));
        self.replace().write_json(Some(&file), &document)?;
        talk.say(summary::of_model(
            &listed(&files),
            &found.model,
            &ModelMetadata::from(&data.about),
            summary::Extent::default(),
        ));
        let record = data.record.clone();
        Ok((Servo::of_data(condition.to_owned(), data, found), record))
    }
}
