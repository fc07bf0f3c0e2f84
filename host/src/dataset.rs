//! From files to a record: recordings of this program, or any CSV file with its columns named.
//!
//! Of a recording of this program only the reference is used, not the rest at neutral around it: the
//! strokes from and to neutral are half as long as those of the reference, and a servo does not
//! answer half a stroke with half the motion. On the simulated bench servo the rest made the model's
//! error 2.6 times larger (0.128 against 0.050 degrees rms).

pub(crate) mod suggestion;

use crate::recording::{self, Completeness, ReadError, Recording};
use crate::table::{Table, TableError};
use crate::timeline::{self, Stretch, TimeColumn};
use servoid_identification::{Error as DataError, Record, Run};
use std::path::{Path, PathBuf};

/// How to read files that are not recordings of this program.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DatasetOptions {
    /// The column with the input.
    pub input: Option<String>,
    /// The column with the output.
    pub output: Option<String>,
    /// Time between rows (s).
    pub period_s: Option<f64>,
    /// The column whose value changes where a new run begins.
    pub run: Option<String>,
    /// The input before the first row of each run.
    pub at_rest: Option<f64>,
    /// Use the rest around the reference too.
    pub with_rest: bool,
}

/// Why files did not become a record. The text says what to do.
#[derive(Debug, thiserror::Error)]
pub enum DatasetError {
    /// A recording.
    #[error(transparent)]
    Recording(#[from] ReadError),
    /// A table.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The numbers themselves.
    #[error("{files}: {error}")]
    Data {
        /// Which files.
        files: String,
        /// What is wrong with them.
        error: DataError,
    },
    /// Columns are not named.
    #[error(
        "{path:?} is no recording of servoid, so say which of its columns is what; its columns are {columns}, so perhaps add: {options}"
    )]
    Unnamed {
        /// Which file.
        path: PathBuf,
        /// What there is.
        columns: String,
        /// What to add to the command, as far as the names of the columns tell.
        options: String,
    },
    /// The sampling period is not known.
    #[error(
        "{path:?} has no column of time ('t', 'time' or 'time_s') with even steps: say how far apart its rows are with --period SECONDS"
    )]
    NoPeriod {
        /// Which file.
        path: PathBuf,
    },
    /// Files that do not go together.
    #[error(
        "{path:?} was sampled every {found} s and the file before it every {expected} s: identify them apart"
    )]
    MixedPeriods {
        /// Which file.
        path: PathBuf,
        /// Its period (s).
        found: f64,
        /// The other's period (s).
        expected: f64,
    },
    /// Files that do not go together.
    #[error(
        "{path:?} was sampled {found} s after the edges of its reference and the file before it {expected} s: identify them apart"
    )]
    MixedPhases {
        /// Which file.
        path: PathBuf,
        /// Its phase (s).
        found: f64,
        /// The other's phase (s).
        expected: f64,
    },
}

/// A record, and what is known of where it comes from.
#[derive(Clone, Debug)]
pub struct Dataset {
    /// The runs.
    pub record: Record,
    /// What the files say of themselves.
    pub about: About,
}

/// What files say of themselves.
#[derive(Clone, Debug, Default)]
pub struct About {
    /// The unit of input and output, where the files say it and agree.
    pub unit: Option<&'static str>,
    /// Under what condition it was recorded, where the files say it and agree.
    pub condition: Option<String>,
    /// Where the data come from, file by file: name and value of each thing that is known.
    pub provenance: Vec<Vec<(String, String)>>,
    /// What a user should know about the files: partial recordings, guessed periods.
    pub remarks: Vec<String>,
}

impl About {
    fn merge(&mut self, other: Self) {
        self.unit = self.unit.filter(|unit| Some(*unit) == other.unit);
        self.condition = self
            .condition
            .take()
            .filter(|c| Some(c) == other.condition.as_ref());
        self.provenance.extend(other.provenance);
        self.remarks.extend(other.remarks);
    }
}

struct Loaded {
    runs: Vec<Run>,
    period_s: f64,
    /// From a change of the input to the first sample that carries it (s).
    phase_s: f64,
    about: About,
}

/// Reads files, each one run or more, into one record.
///
/// # Errors
/// [`DatasetError`].
pub fn load(paths: &[PathBuf], options: &DatasetOptions) -> Result<Dataset, DatasetError> {
    let mut all: Option<Loaded> = None;
    for path in paths {
        let next = load_one(path, options)?;
        let Some(all) = &mut all else {
            all = Some(next);
            continue;
        };
        if (next.period_s / all.period_s - 1.0).abs() > PERIOD_TOLERANCE {
            let (found, expected) = (next.period_s, all.period_s);
            return Err(DatasetError::MixedPeriods {
                path: path.clone(),
                found,
                expected,
            });
        }
        if next.phase_s != all.phase_s {
            let (found, expected) = (next.phase_s, all.phase_s);
            return Err(DatasetError::MixedPhases {
                path: path.clone(),
                found,
                expected,
            });
        }
        all.runs.extend(next.runs);
        all.about.merge(next.about);
    }
    let files = || {
        let names: Vec<_> = paths.iter().map(|p| format!("{}", p.display())).collect();
        names.join(", ")
    };
    let Loaded {
        runs,
        period_s,
        phase_s,
        about,
    } = all.unwrap_or(Loaded {
        runs: Vec::new(),
        period_s: f64::NAN,
        phase_s: 0.0,
        about: About::default(),
    });
    let record = Record::new(period_s, runs).map_err(|error| DatasetError::Data {
        files: files(),
        error,
    })?;
    Ok(Dataset {
        record: record.with_sample_phase(phase_s),
        about,
    })
}

/// Periods that differ by less are the same: it is far below what any result resolves, and above
/// the rounding of times that are written with a few decimals.
const PERIOD_TOLERANCE: f64 = 1e-3;

fn load_one(path: &Path, options: &DatasetOptions) -> Result<Loaded, DatasetError> {
    let bytes = std::fs::read(path).map_err(|reason| TableError::Unreadable {
        path: path.to_owned(),
        reason,
    })?;
    let named = options.input.is_some() || options.output.is_some();
    if !named && recording::is_recording(&bytes) {
        from_recording(&Recording::parse(&bytes, path)?, path, options)
    } else {
        from_table(&Table::parse(path, bytes)?, options)
    }
}

fn from_recording(
    recording: &Recording,
    path: &Path,
    options: &DatasetOptions,
) -> Result<Loaded, DatasetError> {
    let range = if options.with_rest {
        0..u64::MAX
    } else {
        recording.reference_samples()
    };
    let (input, mut output) = recording.columns(range);
    let healthy = recording.header.healthy_degrees();
    let broken = healthy.map_or(0, |range| drop_unhealthy(&mut output, range));
    let run = run(input, output, path, options.at_rest)?;
    let mut remarks = Vec::new();
    if let Completeness::Partial(reason) = &recording.completeness {
        let rows = recording.samples.len();
        remarks.push(format!(
            "{} is partial ({reason}): it has {rows} rows",
            path.display()
        ));
    }
    if broken > 0 {
        remarks.push(format!(
            "{}: in {broken} samples the sensor read outside its healthy range; they count as missing",
            path.display()
        ));
    }
    let period_s = recording.header.sample_period_s;
    if options.period_s.is_some() {
        remarks.push(format!(
            "{} is a recording and says itself that its samples are {period_s} s apart; --period is not used for it",
            path.display()
        ));
    }
    let condition = Some(recording.header.condition.clone()).filter(|c| !c.is_empty());
    let end = match &recording.completeness {
        Completeness::Partial(reason) => format!("partial ({reason})"),
        Completeness::Complete => "complete".to_owned(),
    };
    let mut provenance = vec![
        ("file".to_owned(), path.display().to_string()),
        ("end".to_owned(), end),
    ];
    provenance.extend(recording.header.facts());
    let about = About {
        unit: Some("deg"),
        condition,
        provenance: vec![provenance],
        remarks,
    };
    let phase_s = recording.header.sample_phase_s;
    if !(phase_s >= 0.0 && phase_s.is_finite()) {
        let reason = "sample_phase_s is no time after an edge".to_owned();
        return Err(ReadError::DamagedHeader {
            path: path.to_owned(),
            line: 1,
            reason,
        }
        .into());
    }
    Ok(Loaded {
        runs: vec![run],
        period_s,
        phase_s,
        about,
    })
}

/// Marks readings that no healthy sensor gives as missing; returns how many.
fn drop_unhealthy(output: &mut [f64], (lowest, highest): (f64, f64)) -> usize {
    // Positions are written with four decimals, so the range's own ends may seem to be beyond it.
    let slack = 1e-3;
    let healthy = (lowest - slack)..=(highest + slack);
    let broken = output
        .iter_mut()
        .filter(|y| !y.is_nan() && !healthy.contains(*y));
    broken.map(|y| *y = f64::NAN).count()
}

fn from_table(table: &Table, options: &DatasetOptions) -> Result<Loaded, DatasetError> {
    let path = table.path();
    let (Some(input), Some(output)) = (&options.input, &options.output) else {
        return Err(DatasetError::Unnamed {
            path: path.to_owned(),
            columns: table.columns_listed(),
            options: suggestion::options(table.columns()),
        });
    };
    let [u, y] = table.numbers([input.as_str(), output.as_str()])?;
    if u.len() < 2 {
        return Err(TableError::Empty {
            path: path.to_owned(),
        }
        .into());
    }
    let mut remarks = Vec::new();
    let time = time_column(table)?;
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
    let labels = match &options.run {
        Some(column) => table.numbers([column.as_str()])?.into_iter().next(),
        None => None,
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

fn run(
    input: Vec<f64>,
    output: Vec<f64>,
    path: &Path,
    at_rest: Option<f64>,
) -> Result<Run, DatasetError> {
    let files = path.display().to_string();
    let run = Run::new(input, output).map_err(|error| DatasetError::Data { files, error })?;
    Ok(match at_rest {
        Some(input) => run.with_input_at_rest(input),
        None => run,
    })
}

/// The column of time and its name, where there is one with even steps.
fn time_column(table: &Table) -> Result<Option<(String, TimeColumn)>, TableError> {
    let mut columns = table.columns().iter();
    let Some(name) = columns.find(|c| suggestion::TIMES.contains(&c.as_str())) else {
        return Ok(None);
    };
    let [times] = table.numbers([name.as_str()])?;
    Ok(TimeColumn::new(times).map(|column| (name.clone(), column)))
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

#[cfg(test)]
mod tests {
    use super::*;

    fn write(dir: &Path, name: &str, text: &str) -> PathBuf {
        let path = dir.join(name);
        std::fs::write(&path, text).unwrap();
        path
    }

    fn named() -> DatasetOptions {
        DatasetOptions {
            input: Some("u".into()),
            output: Some("y".into()),
            ..DatasetOptions::default()
        }
    }

    #[test]
    fn runs_are_kept_apart_and_the_period_is_found() {
        let dir = tempfile::tempdir().unwrap();
        let path = write(
            dir.path(),
            "a.csv",
            "t,u,y,run\n0,1,2,1\n.02,2,3,1\n.04,1,,1\n0,5,6,2\n.02,7,8,2\n",
        );
        let options = DatasetOptions {
            run: Some("run".into()),
            at_rest: Some(0.0),
            ..named()
        };
        // One of four steps is the restart: not even enough for a column of time.
        assert!(matches!(
            load(std::slice::from_ref(&path), &options),
            Err(DatasetError::NoPeriod { .. })
        ));
        let options = DatasetOptions {
            period_s: Some(0.02),
            ..options
        };
        let set = load(&[path.clone(), path], &options).unwrap();
        let lengths: Vec<_> = set.record.runs().iter().map(Run::len).collect();
        assert_eq!(lengths, [3, 2, 3, 2]);
        assert_eq!(set.record.missing(), 2);
        assert_eq!(set.record.runs()[1].input_at_rest(), Some(0.0));
    }

    #[test]
    fn an_even_column_of_time_gives_the_period() {
        let dir = tempfile::tempdir().unwrap();
        let rows: String = (0..100)
            .map(|k| format!("{:.2},{},{}\n", 0.02 * f64::from(k), k % 7, k % 5))
            .collect();
        let path = write(dir.path(), "a.csv", &format!("t,u,y\n{rows}"));
        let set = load(&[path], &named()).unwrap();
        assert_eq!(set.record.sample_period_s(), 0.02);
        assert_eq!(set.about.remarks.len(), 1);
    }

    #[test]
    fn rows_that_are_missing_are_not_closed_up() {
        let dir = tempfile::tempdir().unwrap();
        let rows: String = (0..200)
            .filter(|k| !(50..70).contains(k))
            .map(|k| format!("{:.2},{},{}\n", 0.02 * f64::from(k), k % 7, k % 5))
            .collect();
        let path = write(dir.path(), "a.csv", &format!("t,u,y\n{rows}"));
        let set = load(&[path], &named()).unwrap();
        assert_eq!((set.record.samples(), set.record.missing()), (200, 20));
        assert!(
            set.about.remarks.iter().any(|r| r.contains("20 samples")),
            "{:?}",
            set.about.remarks
        );
    }

    #[test]
    fn columns_that_are_not_named_are_asked_for() {
        let dir = tempfile::tempdir().unwrap();
        let path = write(dir.path(), "a.csv", "t,u,y\n0,1,2\n");
        let error = load(&[path], &DatasetOptions::default())
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("--input") && error.contains("t, u, y"),
            "{error}"
        );
    }
}
