//! `servoid demo`

use super::capture::{Job, capture};
use super::{Talk, interrupt};
use crate::dataset::{self, Dataset, DatasetOptions};
use crate::plots::figures::{self, Subject};
use crate::rig::RigFile;
use crate::{output, paper, summary};
use anyhow::{Context, Result};
use clap::Args;
use serde::Serialize;
use servoid_identification::metrics::Metrics;
use servoid_identification::{Model, Options, identify};
use std::fmt::Write;
use std::path::PathBuf;

/// Run the whole paper on simulated rigs: capture, identify, compare bench and aircraft
///
/// Writes two recordings, two models, the paper's figures and summary.json. Needs no hardware.
#[derive(Debug, Args)]
#[command(after_help = "Example:
  servoid demo --out demo")]
pub(super) struct Demo {
    /// Folder for everything that it writes; files in it are replaced
    #[arg(long, short, default_value = "demo", value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    talk: Talk,
}

/// `summary.json`
#[derive(Serialize)]
struct Summary {
    bench: Metrics,
    aircraft: Metrics,
    paper: Vec<paper::Fact>,
}

impl Demo {
    pub(super) fn run(self) -> Result<String> {
        std::fs::create_dir_all(&self.out)
            .with_context(|| format!("the folder {:?} cannot be made", self.out))?;
        interrupt::listen()?;
        let (bench_data, bench) = self.measure("bench")?;
        let (aircraft_data, aircraft) = self.measure("aircraft")?;
        let facts = match aircraft_data.record.runs() {
            [run, ..] => paper::facts(&bench, &aircraft, run),
            [] => Vec::new(),
        };
        let [first, second] = [
            ("bench", &bench, &bench_data),
            ("aircraft", &aircraft, &aircraft_data),
        ]
        .map(|(name, model, data)| Subject {
            name,
            model,
            record: Some(&data.record),
            unit: data.about.unit,
        });
        let figures = figures::paper(&first, Some(&second));
        let plots = output::write_figures(&self.out.join("plots"), true, &figures)?;
        let summary = Summary {
            bench: bench.metrics,
            aircraft: aircraft.metrics,
            paper: facts,
        };
        let path = self.out.join("summary.json");
        output::write_file(&path, true, &output::to_json(&summary)?)?;
        let mut text = summary::side_by_side(&summary.bench, &summary.aircraft);
        writeln!(
            text,
            "\n{:50} {:>6} {:>10} {:>10}",
            "the paper", "figure", "paper", "here"
        )?;
        for paper::Fact {
            figure,
            fact,
            paper,
            here,
        } in &summary.paper
        {
            writeln!(text, "{fact:50} {figure:>6} {paper:>10} {here:>10.2}")?;
        }
        writeln!(
            text,
            "\nrecordings, models, summary.json and {} plots are in {}",
            plots.len(),
            self.out.display()
        )?;
        self.talk.result(text, &summary)
    }

    /// Captures a simulated servo and identifies it.
    fn measure(&self, condition: &str) -> Result<(Dataset, Model)> {
        let file = self.out.join(format!("{condition}.csv"));
        let address = format!("sim:{condition}?seed=1");
        capture(
            &Job {
                address: &address,
                rig: RigFile::default(),
                amplitude_deg: 5.0,
                condition,
                notes: "simulated",
                release: false,
                out: &file,
                force: true,
            },
            self.talk,
        )?;
        let data = dataset::load(std::slice::from_ref(&file), &DatasetOptions::default())?;
        let model = identify(&data.record, &Options::default())
            .with_context(|| file.display().to_string())?;
        let json = self.out.join(format!("{condition}.json"));
        output::write_file(&json, true, &output::to_json(&model)?)?;
        self.talk.say(summary::of_model(
            &file.display().to_string(),
            &model,
            data.about.unit,
        ));
        Ok((data, model))
    }
}
