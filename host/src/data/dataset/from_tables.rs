//! Any CSV file with its columns named.

use super::about::About;
use super::error::DatasetError;
use super::loaded::{Loaded, run};
use super::options::DatasetOptions;
use super::time_column::{self, TimeUnit};
use super::{sentinel_values, suggestion};
use crate::data::table::{Table, TableError, unit_of};
use crate::data::timeline::{self, Stretch, TimeColumn};
use servoid_identification::results::{Advice, Check};
use std::path::Path;

/// The runs of a table.
pub(super) fn from_table(table: &Table, options: &DatasetOptions) -> Result<Loaded, DatasetError> {
    let path = table.path();
    let (Some(input), Some(output)) = (&options.input, &options.output) else {
        return Err(DatasetError::Unnamed {
            path: path.to_owned(),
            columns: table.columns_said(),
            options: suggestion::options(table.columns()),
        });
    };
    let column = table.column(input)?;
    if column == table.column(output)? {
        return Err(DatasetError::OneColumn {
            path: path.to_owned(),
            column: column.to_owned(),
        });
    }
    let Columns { u, y, time, labels } = Columns::read(table, input, output, options)?;
    if u.len() < 2 {
        return Err(TableError::Empty {
            path: path.to_owned(),
        }
        .into());
    }
    let layout = table.remarks().iter();
    let mut remarks: Vec<String> = layout
        .map(|remark| format!("{}: {remark}", path.display()))
        .collect();
    let Spacing {
        period_s,
        time,
        remark,
    } = Spacing::of(path, time, options)?;
    remarks.extend(remark.map(|remark| format!("{}: {remark}", path.display())));
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
    let unit = |name: &str| Ok::<_, TableError>(unit_of(table.column(name)?).map(str::to_owned));
    let mut about = About {
        input_unit: unit(input)?,
        output_unit: unit(output)?,
        provenance: vec![provenance],
        remarks,
        ..About::default()
    };
    for (name, column) in [(input, &u), (output, &y)] {
        tell_stand_in(&mut about, path, name, column);
    }
    Ok(Loaded {
        runs,
        rest: Vec::new(),
        period_s,
        phase_s: 0.0,
        about,
    })
}

/// Says where a number of a column seems to stand for no reading: as it is, it counts as one.
fn tell_stand_in(about: &mut About, path: &Path, name: &str, column: &[f64]) {
    let Some((value, rows)) = sentinel_values::find(column) else {
        return;
    };
    let finding = format!(
        "{}: column {name:?} is {value} in {rows} rows of {}, far from all its other values",
        path.display(),
        column.len()
    );
    about.remarks.push(format!(
        "{finding}; where that stands for no reading, leave the cells empty"
    ));
    let finding = format!("{finding}.");
    let remedy =
        "Where that stands for no reading, leave the cells empty: they count as missing then.";
    let advice = Advice::new(Check::SentinelValues, finding, rows as f64, 0.0, remedy);
    about.advice.push(advice);
}

/// Longest step that a column of time without a unit has in seconds: beyond it, milliseconds and
/// microseconds are as likely \[s\].
const LONGEST_STEP_S: f64 = 0.5;

/// Scatter of time stamps that is worth a remark \[steps\].
const SCATTER: f64 = 0.02;

/// How far apart rows are, and how that is known.
struct Spacing {
    period_s: f64,
    /// The column that says where rows are missing, and its name.
    time: Option<(String, TimeColumn)>,
    /// What to say of it.
    remark: Option<String>,
}

impl Spacing {
    fn of(
        path: &Path,
        clock: Option<Clock>,
        options: &DatasetOptions,
    ) -> Result<Self, DatasetError> {
        if let Some(period_s) = options.period_s {
            return Ok(Self::stated(period_s, clock, options));
        }
        let path = path.to_owned();
        let Some(Clock { name, unit, times }) = clock else {
            return Err(DatasetError::NoPeriod { path });
        };
        let Some(times) = times else {
            return Err(DatasetError::TimeNotNumbers { path, column: name });
        };
        let times = match TimeColumn::new(times) {
            Ok(times) => times,
            Err(reason) => {
                return Err(DatasetError::UnevenTime {
                    path,
                    column: name,
                    reason,
                });
            }
        };
        let step = times.step();
        let (unit, hint) = match options.time_unit.or(unit) {
            Some(unit) => (unit, ""),
            None if step < LONGEST_STEP_S => (TimeUnit::Seconds, " (--time-unit says otherwise)"),
            None => {
                return Err(DatasetError::NoTimeUnit {
                    path,
                    column: name,
                    step,
                });
            }
        };
        let period_s = step * unit.seconds();
        let mut remark = format!(
            "time (column {name:?}) read as {}: rows are {} apart{hint}",
            unit.word(),
            time_column::said(period_s)
        );
        if times.scatter() > SCATTER {
            remark += &format!(
                "; its time stamps scatter by {:.0} % of that, and the rows are taken as evenly spaced",
                100.0 * times.scatter()
            );
        }
        Ok(Self {
            period_s,
            time: Some((name, times)),
            remark: Some(remark),
        })
    }

    /// The period that was stated; a column of time then says where rows are missing, if it agrees.
    fn stated(period_s: f64, clock: Option<Clock>, options: &DatasetOptions) -> Self {
        let plain = Self {
            period_s,
            time: None,
            remark: None,
        };
        let Some(Clock { name, unit, times }) = clock else {
            return plain;
        };
        let Some(times) = times else { return plain };
        let unit = options.time_unit.or(unit);
        let possible = unit
            .as_ref()
            .map_or(&TimeUnit::ALL[..], std::slice::from_ref);
        let agrees = |unit: &TimeUnit| TimeColumn::with_step(&times, period_s / unit.seconds());
        if let Some(column) = possible.iter().find_map(agrees) {
            return Self {
                time: Some((name, column)),
                ..plain
            };
        }
        let Ok(column) = TimeColumn::new(times) else {
            let remark = format!(
                "column {name:?} is too uneven to say where rows are missing, and is not used"
            );
            return Self {
                remark: Some(remark),
                ..plain
            };
        };
        let unit = unit.map_or(String::new(), |unit| format!(" {}", unit.name()));
        let remark = format!(
            "by column {name:?} rows are {}{unit} apart, but {period_s} s was stated, and is taken",
            column.step()
        );
        Self {
            time: Some((name, column)),
            remark: Some(remark),
            ..plain
        }
    }
}

/// A column of time.
struct Clock {
    name: String,
    /// As the name says.
    unit: Option<TimeUnit>,
    /// `None` where it holds no numbers.
    times: Option<Vec<f64>>,
}

/// What is needed of a table.
struct Columns {
    u: Vec<f64>,
    y: Vec<f64>,
    time: Option<Clock>,
    /// Names of runs.
    labels: Option<Vec<f64>>,
}

impl Columns {
    /// Reads all of them in one pass.
    fn read(
        table: &Table,
        input: &str,
        output: &str,
        options: &DatasetOptions,
    ) -> Result<Self, TableError> {
        let run = options.run.as_deref();
        let clock = match &options.time {
            Some(name) => {
                let column = table.column(name)?;
                Some((column, time_column::unit_in(column)))
            }
            None => time_column::column(table.columns()),
        };
        let mut wanted = vec![input, output];
        wanted.extend(run);
        let (numbers, times) = table.numbers_beside(&wanted, clock.map(|(name, _)| name))?;
        let mut numbers = numbers.into_iter();
        let mut next = || numbers.next().unwrap_or_default();
        Ok(Self {
            u: next(),
            y: next(),
            labels: run.map(|_| next()),
            time: clock.map(|(name, unit)| Clock {
                name: name.to_owned(),
                unit,
                times,
            }),
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
            "{}: column {column:?} goes back, stands still or jumps far ahead {} times; a new run begins at each (--run COLUMN names runs)",
            path.display(),
            found.len() - 1
        ));
    }
    remarks
}
