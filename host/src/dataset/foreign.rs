//! Any CSV file with its columns named.

use super::{About, DatasetError, DatasetOptions, Loaded, run, suggestion};
use crate::table::{Table, TableError};
use crate::timeline::{self, Stretch, TimeColumn};
use std::path::Path;

/// The runs of a table.
pub(super) fn from_table(table: &Table, options: &DatasetOptions) -> Result<Loaded, DatasetError> {
    let path = table.path();
    let (Some(input), Some(output)) = (&options.input, &options.output) else {
        return Err(DatasetError::Unnamed {
            path: path.to_owned(),
            columns: table.columns_listed(),
            options: suggestion::options(table.columns()),
        });
    };
    let Columns { u, y, time, labels } =
        Columns::read(table, input, output, options.run.as_deref())?;
    if u.len() < 2 {
        return Err(TableError::Empty {
            path: path.to_owned(),
        }
        .into());
    }
    let mut remarks = Vec::new();
    let period_s = match (options.period_s, &time) {
        (Some(period_s), _) => period_s,
        (None, Some((column, time))) => {
            remarks.push(format!(
                "{}: rows are {} s apart by column {column:?}; --period says otherwise",
                path.display(),
                time.step()
            ));
            time.step()
        }
        (None, None) => {
            return Err(DatasetError::NoPeriod {
                path: path.to_owned(),
            });
        }
    };
    let found = timeline::stretches(u.len(), time.as_ref().map(|(_, t)| t), labels.as_deref());
    if let Some((column, _)) = &time {
        remarks.extend(remark_on_time(path, column, &found, labels.is_some()));
    }
    let mut runs = Vec::new();
    for stretch in &found {
        let at_rest = options.at_rest.filter(|_| !stretch.continues);
        runs.push(run(stretch.place(&u), stretch.place(&y), path, at_rest)?);
    }
    let provenance = vec![
        ("file".to_owned(), path.display().to_string()),
        (
            "columns".to_owned(),
            format!("input {input}, output {output}"),
        ),
        ("sample period s".to_owned(), period_s.to_string()),
    ];
    let about = About {
        provenance: vec![provenance],
        remarks,
        ..About::default()
    };
    Ok(Loaded {
        runs,
        period_s,
        phase_s: 0.0,
        about,
    })
}

/// What is needed of a table.
struct Columns {
    u: Vec<f64>,
    y: Vec<f64>,
    /// The column of time and its name, where there is one with even steps.
    time: Option<(String, TimeColumn)>,
    /// Names of runs.
    labels: Option<Vec<f64>>,
}

impl Columns {
    /// Reads all of them in one pass.
    fn read(
        table: &Table,
        input: &str,
        output: &str,
        run: Option<&str>,
    ) -> Result<Self, TableError> {
        let mut columns = table.columns().iter();
        let time = columns.find(|column| suggestion::TIMES.contains(&column.as_str()));
        let mut wanted = vec![input, output];
        wanted.extend(time.map(String::as_str));
        wanted.extend(run);
        let mut numbers = table.numbers(&wanted)?.into_iter();
        let mut next = || numbers.next().unwrap_or_default();
        Ok(Self {
            u: next(),
            y: next(),
            time: time.and_then(|name| Some((name.clone(), TimeColumn::new(next())?))),
            labels: run.map(|_| next()),
        })
    }
}

/// What a column of time has shown: gaps, and runs that the user has not named.
fn remark_on_time(path: &Path, column: &str, found: &[Stretch], labelled: bool) -> Vec<String> {
    let mut remarks = Vec::new();
    let missing: usize = found.iter().map(Stretch::missing).sum();
    if missing > 0 {
        remarks.push(format!(
            "{}: column {column:?} has gaps; {missing} samples count as missing",
            path.display()
        ));
    }
    if found.len() > 1 && !labelled {
        remarks.push(format!(
            "{}: column {column:?} goes back or far ahead {} times; a new run begins at each (--run COLUMN names runs)",
            path.display(),
            found.len() - 1
        ));
    }
    remarks
}
