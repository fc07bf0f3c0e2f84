//! `servoid report`

use super::table_args::TableArgs;
use super::{Talk, listed, stem};
use crate::dataset::{self, Dataset, DatasetOptions};
use crate::output;
use crate::plots::figures::Subject;
use crate::report::{self, Part};
use anyhow::{Context, Result};
use clap::Args;
use servoid_identification::{Model, Options, identify};
use std::path::{Path, PathBuf};

/// Put one servo, or two side by side, on one page with figures to zoom in
///
/// Takes recordings (identified with everything chosen from the data) or models, one or two. The
/// page is a single file that opens in any browser, without a network.
#[derive(Debug, Args)]
#[command(after_help = "Example:
  servoid report bench.csv aircraft.csv -o report.html
  servoid report mine.csv --input u --output y --period 0.02 -o report.html")]
pub(super) struct Report {
    /// Recordings or models, the reference condition first
    #[arg(required = true, num_args = 1..=2, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The page to write
    #[arg(long, short, value_name = "FILE.html")]
    out: PathBuf,
    /// What the page is called
    #[arg(long, default_value = "How the servo moves")]
    title: String,
    /// Replace the file if it exists
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    talk: Talk,
    #[command(flatten)]
    table: TableArgs,
}

/// A file, read and identified.
struct Read {
    name: String,
    model: Model,
    data: Option<Dataset>,
    provenance: Vec<(String, String)>,
}

impl Report {
    pub(super) fn run(self) -> Result<String> {
        output::check_free(&self.out, self.force)?;
        let options: DatasetOptions = self.table.into();
        let mut read = Vec::new();
        for file in &self.files {
            read.push(read_file(file, &options, self.talk)?);
        }
        name_apart(&mut read);
        let parts: Vec<Part<'_>> = read.iter().map(Read::part).collect();
        let (first, second) = (&parts[0], parts.get(1));
        let page = report::page(&self.title, first, second)?;
        output::write_file(&self.out, self.force, &page)?;
        let result = serde_json::json!({ "file": self.out });
        self.talk.result(
            format!("{}: open it in a browser\n", self.out.display()),
            &result,
        )
    }
}

impl Read {
    fn part(&self) -> Part<'_> {
        let data = self.data.as_ref();
        let subject = Subject {
            name: &self.name,
            model: &self.model,
            record: data.map(|data| &data.record),
            unit: data.and_then(|data| data.about.unit),
        };
        Part {
            subject,
            provenance: &self.provenance,
        }
    }
}

fn read_file(file: &Path, options: &DatasetOptions, talk: Talk) -> Result<Read> {
    if file.extension().is_some_and(|ending| ending == "json") {
        let (model, data) = (output::read_model(file)?, None);
        return Ok(Read {
            name: stem(file),
            model,
            data,
            provenance: Vec::new(),
        });
    }
    let files = [file.to_owned()];
    let data = dataset::load(&files, options)?;
    data.about
        .remarks
        .iter()
        .for_each(|remark| talk.say(remark));
    let model = identify(&data.record, &Options::default()).with_context(|| listed(&files))?;
    let provenance = data.about.provenance.clone();
    let name = data.about.condition.clone().unwrap_or_else(|| stem(file));
    Ok(Read {
        name,
        model,
        data: Some(data),
        provenance,
    })
}

/// Two curves of one name could not be told apart.
fn name_apart(read: &mut [Read]) {
    if let [first, second] = read
        && first.name == second.name
    {
        first.name.push_str(" 1");
        second.name.push_str(" 2");
    }
}
