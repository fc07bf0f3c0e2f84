//! `servoid demo`

use super::capture::{CaptureJob, Monitor, capture};
use super::ctrl_c;
use super::output_args::Talk;
use crate::commands::output_files;
use crate::data::dataset::{self, DatasetOptions};
use crate::data::model_file::ModelDocument;
use crate::data::model_metadata::ModelMetadata;
use crate::data::rig_file::RigFile;
use crate::presentation::paper_values;
use crate::presentation::plots::paper_figures;
use crate::presentation::report::{self, Page, Servo};
use crate::presentation::summary;
use anyhow::{Context, Result};
use clap::Args;
use serde::Serialize;
use servoid_identification::comparison::{Comparison, ComparisonOptions, compare};
use servoid_identification::results::Metrics;
use servoid_identification::{Options, Record, identify_explained};
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
    /// Replace files of the same names that are not from a demo
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    talk: Talk,
}

/// What it writes beside the plots.
const FILES: [&str; 7] = [
    "bench.csv",
    "aircraft.csv",
    "bench.json",
    "aircraft.json",
    "comparison.json",
    "summary.json",
    REPORT,
];

/// What its recordings carry, and its summary: how they are known again.
const NOTES: &str = "simulated by servoid demo";
const PAPER_KEY: &str = "\"paper\"";

/// The page with everything.
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
        std::fs::create_dir_all(&self.out)
            .with_context(|| format!("the folder {:?} cannot be made", self.out))?;
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
        self.write("comparison.json", &output_files::to_json(&comparison)?)?;
        let summary = Summary {
            bench: bench.model.metrics,
            aircraft: aircraft.model.metrics,
            paper: paper_values::facts(&bench.model, &aircraft.model, &comparison),
        };
        self.write("summary.json", &output_files::to_json(&summary)?)?;
        let plots = self.draw(&bench, &aircraft, &comparison, &summary.paper)?;
        let text = format!(
            "{}\n{}\nThe first is the bench, the second the aircraft.\n{}\n\nrecordings, models, comparison.json, summary.json and {plots} plots are in {}\nopen {} in a browser to look around\n",
            summary::table_of_comparison("bench", "aircraft", &comparison),
            paper_values::as_table(&summary.paper),
            summary::wrapped(&comparison.summary, 0),
            self.out.display(),
            self.out.join(REPORT).display()
        );
        self.talk.result(text, &summary)
    }

    /// Fails if a file would be replaced that no demo has made: people call recordings "bench.csv".
    fn check_folder(&self) -> Result<()> {
        let made_by_demo = |name: &str, mark: &str| {
            let text = std::fs::read_to_string(self.out.join(name));
            text.is_ok_and(|text| text.contains(mark))
        };
        let demo_was_here = made_by_demo("summary.json", PAPER_KEY);
        for name in FILES {
            let recording = name.ends_with(".csv");
            let own = demo_was_here && (!recording || made_by_demo(name, NOTES));
            if !own {
                output_files::check_free(&self.out.join(name), self.force)?;
            }
        }
        Ok(())
    }

    /// The paper's figures, one by one and on a page; returns how many.
    fn draw(
        &self,
        bench: &Servo,
        aircraft: &Servo,
        comparison: &Comparison,
        paper: &[paper_values::Fact],
    ) -> Result<usize> {
        let (first, second) = (bench.part(), aircraft.part());
        let figures = paper_figures::paper(&first.subject, Some(&second.subject));
        let plots = output_files::write_figures(&self.out.join("plots"), true, &figures)?;
        let page = report::page(&Page {
            title: "A servo on the bench and on the aircraft, simulated",
            first,
            second: Some(second),
            comparison: Some(comparison),
            paper,
        })?;
        self.write(REPORT, &page)?;
        Ok(plots.len())
    }

    fn write(&self, name: &str, content: &str) -> Result<()> {
        output_files::write_file(&self.out.join(name), true, content)
    }

    /// Captures a simulated servo and identifies it.
    fn measure(&self, condition: &str) -> Result<(Servo, Record)> {
        let file = self.out.join(format!("{condition}.csv"));
        let address = format!("sim:{condition}?seed=1");
        capture(
            &CaptureJob {
                address: &address,
                rig: RigFile::default(),
                reference: Reference::Staircase(Staircase::PAPER),
                condition,
                notes: NOTES,
                release: false,
                files: std::slice::from_ref(&file),
                force: true,
            },
            &Monitor::plain(self.talk),
            self.talk,
        )?;
        let data = dataset::load(std::slice::from_ref(&file), &DatasetOptions::default())?;
        let found = identify_explained(&data.record, &Options::default())
            .with_context(|| file.display().to_string())?;
        let model = &found.model;
        self.write(
            &format!("{condition}.json"),
            &output_files::to_json(&ModelDocument {
                model,
                metadata: ModelMetadata::from(&data.about),
                record: Some(&data.record),
            })?,
        )?;
        self.talk.say(summary::of_model(
            &file.display().to_string(),
            model,
            data.about.units(),
        ));
        let record = data.record.clone();
        Ok((Servo::of_data(condition.to_owned(), data, found), record))
    }
}
