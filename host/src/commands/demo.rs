//! `servoid demo`

use super::capture::{Job, capture};
use super::{Talk, interrupt};
use crate::dataset::{self, Dataset, DatasetOptions};
use crate::plots::figures::{self, Named};
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
        let plots = self.plot((&bench_data, &bench), (&aircraft_data, &aircraft))?;
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
            data.unit,
        ));
        Ok((data, model))
    }

    /// The paper's Figs 4-12. As there, the aircraft's results are drawn with the bench's.
    fn plot(
        &self,
        bench: (&Dataset, &Model),
        aircraft: (&Dataset, &Model),
    ) -> Result<Vec<PathBuf>> {
        let unit = bench.0.unit;
        let b = Named {
            name: "bench model",
            model: bench.1,
        };
        let a = Named {
            name: "aircraft model",
            model: aircraft.1,
        };
        let mut all = vec![
            figures::input_output(
                "fig-04-bench",
                "Bench: reference and measurement",
                &bench.0.record,
                unit,
            ),
            figures::step_response("fig-05-bench-step", "Bench: step response", &[b]),
            figures::bode("fig-06-bench-bode", "Bench: frequency response", &[b]),
            figures::input_output(
                "fig-08-aircraft",
                "Aircraft: reference and measurement",
                &aircraft.0.record,
                unit,
            ),
            figures::step_response("fig-10-step", "Step response, bench and aircraft", &[b, a]),
            figures::bode(
                "fig-11-bode",
                "Frequency response, bench and aircraft",
                &[b, a],
            ),
        ];
        let on = |name: &str, title: &str, models: &[Named<'_>], data: &Dataset| {
            let run = data.record.runs().first()?;
            Some(figures::validation(name, title, models, run, unit))
        };
        all.extend(on(
            "fig-07-bench-validation",
            "Bench model on bench data",
            &[b],
            bench.0,
        ));
        all.extend(on(
            "fig-09-bench-on-aircraft",
            "Bench model on aircraft data",
            &[b],
            aircraft.0,
        ));
        all.extend(on(
            "fig-12-both-on-aircraft",
            "Both models on aircraft data",
            &[b, a],
            aircraft.0,
        ));
        output::write_figures(&self.out.join("plots"), true, &all)
    }
}
