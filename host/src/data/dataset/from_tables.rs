//! Any CSV file with its columns named: cells, time axis, runs.

use super::about::About;
use super::error::DatasetFault;
use super::loaded::{Loaded, late_by_polling, run};
use super::moving_command::unseen_within_rows;
use super::options::DatasetOptions;
use super::pulse_waits::note_common_wait;
use super::time_column::{self, TimeUnit};
use super::{run_labels, sentinel_values, suggested_columns, wrapped_angle};
use crate::data::pulse_widths;
use crate::data::table::{Table, TableFault, unit_of};
use crate::data::timeline::{self, Stretch, TimeColumn};
use clap::ValueEnum;
use servoid_identification::Run;
use servoid_identification::results::{Advice, Check, six_digits};
use std::path::Path;

/// The runs of a table, which is the file `path`.
pub(super) fn from_table(
    table: &Table,
    path: &Path,
    options: &DatasetOptions,
) -> Result<Loaded<'static>, DatasetFault> {
    let (Some(input), Some(output)) = (&options.input, &options.output) else {
        return Err(columns_not_named(table));
    };
    let names = [table.column(input)?, table.column(output)?];
    if names[0] == names[1] {
        return Err(DatasetFault::OneColumn(names[0].to_owned()));
    }
    let Columns {
        u,
        mut y,
        labels,
        label_texts,
        drivers,
        clock,
    } = Columns::read(table, names, options)?;
    if u.len() < 2 {
        return Err(TableFault::Empty.into());
    }
    let clock_name = clock.as_ref().map(|clock| clock.name);
    let Spacing {
        period_s,
        uncertain_s,
        time,
        remark,
        doubt,
    } = Spacing::of(clock, options)?;
    let found = timeline::stretches(u.len(), time.as_ref(), labels.as_deref());
    let mut remarks = table.remarks().to_vec();
    let mut changes: Vec<(String, usize)> =
        table.cut_row().into_iter().map(|cut| (cut, 1)).collect();
    if let Some(angle) = wrapped_angle::put_together(output, &y, unit_of(names[1])) {
        y = angle.column;
        changes.push((angle.remark, angle.jumps));
    }
    remarks.extend(remark);
    remarks.extend(label_texts);
    remarks.extend(controllers_not_named(table, options));
    if let (Some(column), Some(_)) = (clock_name, &time) {
        remarks.extend(remarks_on_time(column, &found, labels.is_some()));
    }
    let driver = |stretch: &Stretch| drivers.as_ref()?.get(stretch.rows.start).copied();
    let controllers = found.iter().filter_map(driver).collect();
    let runs = runs(&found, [&u, &y], labels.as_deref(), options)?;
    let mut about = about(table, path, options, names, period_s);
    let file = path.display();
    about.remarks = remarks
        .iter()
        .map(|remark| format!("{file}: {remark}"))
        .collect();
    for (change, rows) in changes {
        about.add_change(format!("{file}: {change}."), rows);
    }
    let phase_s = late_by_polling(options.polled, period_s);
    let unseen_s = match options.polled || options.exact_command {
        true => 0.0,
        false => unseen_within_rows(&runs, period_s, &mut about, &format!("{file}: ")),
    };
    about.sensor_delay_uncertainty_s = phase_s + uncertain_s + unseen_s;
    note_common_wait(&runs, period_s, &mut about);
    if let Some(Doubt { finding, times }) = doubt {
        let remedy =
            "Make sure which of the two is right: all times and frequencies follow from it.";
        about.add(
            Check::TimeColumn,
            format!("{file}: {finding}"),
            times,
            remedy,
        );
    }
    about
        .remarks
        .extend(unit_in_doubt(names[0], &u).map(|remark| format!("{file}: {remark}")));
    about
        .remarks
        .extend(grad_in_doubt(names[1]).map(|remark| format!("{file}: {remark}")));
    for (name, column) in [(input, &u), (output, &y)] {
        note_sentinel_value(&mut about, &file.to_string(), name, column);
    }
    Ok(Loaded {
        runs,
        controllers,
        rest: Vec::new(),
        period_s,
        phase_s,
        about,
    })
}

/// That no columns are named, with those that may be meant.
fn columns_not_named(table: &Table) -> DatasetFault {
    if let [only] = table.columns() {
        return DatasetFault::OneCell(only.clone());
    }
    DatasetFault::Unnamed {
        columns: table.columns_clause(),
        options: match table.begins_with_times() {
            true => suggested_columns::options_behind_times(table.columns()),
            false => suggested_columns::options(table.columns()),
        },
    }
}

/// The stretches `found` of the columns of input and output as runs.
fn runs(
    found: &[Stretch],
    [u, y]: [&[f64]; 2],
    labels: Option<&[f64]>,
    options: &DatasetOptions,
) -> Result<Vec<Run<'static>>, DatasetFault> {
    let of_stretch = |stretch: &Stretch| {
        let at_rest = options.at_rest.filter(|_| !stretch.continues);
        let run = run(stretch.place(u), stretch.place(y), at_rest)?;
        let run = match options.exact_command {
            true => run.with_exact_input(),
            false => run,
        };
        let label = labels.and_then(|labels| labels.get(stretch.rows.start));
        Ok(match label {
            Some(label) => run.with_label(*label),
            None => run,
        })
    };
    found.iter().map(of_stretch).collect()
}

/// Where the columns `names` of input and output come from.
fn about(
    table: &Table,
    path: &Path,
    options: &DatasetOptions,
    names: [&str; 2],
    period_s: f64,
) -> About {
    let asked = |name: &Option<String>| name.clone().unwrap_or_default();
    let facts = [
        ("file", path.display().to_string()),
        (
            "columns",
            format!(
                "input {}, output {}",
                asked(&options.input),
                asked(&options.output)
            ),
        ),
        ("sample period s", period_s.to_string()),
    ];
    let [input_unit, output_unit] = names.map(|name| unit_of(name).map(str::to_owned));
    About {
        input_unit,
        output_unit,
        provenance: vec![facts.map(|(key, value)| (key.to_owned(), value)).into()],
        other_input: suggested_columns::another_input(table.columns(), names),
        commands_at_rows: !options.polled,
        polled: options.polled,
        exact_command: options.exact_command,
        ..About::default()
    }
}

/// That a command is a pulse width by its size, and called something else.
fn unit_in_doubt(name: &str, column: &[f64]) -> Option<String> {
    let values = || column.iter().filter(|value| !value.is_nan());
    let least = values().copied().fold(f64::INFINITY, f64::min);
    let largest = values().copied().fold(f64::NEG_INFINITY, f64::max);
    let doubt = pulse_widths::doubt(unit_of(name), least, largest)?;
    Some(format!(
        "column {name:?} {doubt}: if they are, put us into its name, as in command_us, since files for simulators follow the unit"
    ))
}

/// That "grad" is a degree in German and 0.9 degrees elsewhere.
fn grad_in_doubt(name: &str) -> Option<String> {
    let unit = unit_of(name).filter(|unit| unit.eq_ignore_ascii_case("grad"))?;
    Some(format!(
        "column {name:?}: {unit} may be degrees or 0.9 degrees; put deg into its name where it is degrees, and speeds are said in s/60°, too"
    ))
}

/// Remarks where a number of a column seems to stand for no reading: as it is, it counts as one.
pub(super) fn note_sentinel_value(about: &mut About, place: &str, name: &str, column: &[f64]) {
    let Some((value, rows)) = sentinel_values::find(column) else {
        return;
    };
    let finding = format!(
        "{place}: column {name:?} is {value} in {rows} rows of {}, far from all its other values",
        column.len()
    );
    about.remarks.push(format!(
        "{finding}; where that stands for no reading, leave the cells empty"
    ));
    let remedy =
        "Where that stands for no reading, leave the cells empty: they count as missing then.";
    let advice = Advice::new(
        Check::SentinelValues,
        finding + ".",
        rows as f64,
        0.0,
        remedy,
    );
    about.advice.push(advice);
}

/// Values of a column up to which it may name controllers.
const MOST_NAMES: usize = 9;

/// A remark where a column that is not used seems to name several controllers.
fn controllers_not_named(table: &Table, options: &DatasetOptions) -> Option<String> {
    let used = [&options.input, &options.output, &options.controller];
    let column = suggested_columns::controller(table.columns())?;
    if options.controller.is_some() || used.contains(&&Some(column.clone())) {
        return None;
    }
    let (mut names, _) = table.numbers_beside(&[column.as_str()], None).ok()?;
    let mut names = names.pop()?;
    names.sort_by(f64::total_cmp);
    names.dedup();
    let all: Vec<String> = names.iter().map(f64::to_string).collect();
    (2..=MOST_NAMES).contains(&names.len()).then(|| {
        format!(
            "column {column:?} has the values {}; where it is a controller or its gain, --controller {} lets the servo model have one mechanism under \
             several controllers",
            all.join(", "),
            suggested_columns::quoted(column)
        )
    })
}

/// The columns that are needed of a table.
struct Columns<'a> {
    u: Vec<f64>,
    y: Vec<f64>,
    /// Names of runs.
    labels: Option<Vec<f64>>,
    /// A remark on which number stands for which run, where the file has texts.
    label_texts: Option<String>,
    /// Names of controllers.
    drivers: Option<Vec<f64>>,
    clock: Option<Clock<'a>>,
}

/// A column of time.
struct Clock<'a> {
    name: &'a str,
    /// As the name gives it.
    unit: Option<TimeUnit>,
    /// `None` where it holds no times.
    times: Option<Vec<f64>>,
}

impl<'a> Columns<'a> {
    /// Reads all of them in one pass.
    fn read(
        table: &'a Table,
        names: [&str; 2],
        options: &DatasetOptions,
    ) -> Result<Self, TableFault> {
        let run = options.run.as_deref();
        let clock = match &options.time {
            Some(name) => {
                let column = table.column(name)?;
                Some((column, time_column::unit_in(column)))
            }
            None => time_column::column(table.columns()),
        };
        let driver = options.controller.as_deref();
        let wanted: Vec<&str> = names.into_iter().chain(run).chain(driver).collect();
        let beside = clock.map(|(name, _)| name);
        let read = table.numbers_beside(&wanted, beside);
        let ((numbers, times), labels) = match (read, run) {
            (Err(TableFault::NotANumber { column, .. }), Some(run)) if column == run => {
                let others: Vec<&str> = names.into_iter().chain(driver).collect();
                let texts = run_labels::of_texts(run, &table.texts(run)?);
                (table.numbers_beside(&others, beside)?, Some(texts))
            }
            (read, _) => (read?, None),
        };
        // Hours, minutes and seconds are seconds whatever the name says.
        let of_clock = times.as_ref().is_some_and(|times| times.of_clock);
        let mut numbers = numbers.into_iter();
        let mut next = || numbers.next().unwrap_or_default();
        let (u, y) = (next(), next());
        let (labels, label_texts) = match labels {
            Some((labels, remark)) => (Some(labels), Some(remark)),
            None => (run.map(|_| next()), None),
        };
        Ok(Self {
            u,
            y,
            labels,
            label_texts,
            drivers: driver.map(|_| next()),
            clock: clock.map(|(name, unit)| Clock {
                name,
                unit: of_clock.then_some(TimeUnit::Seconds).or(unit),
                times: times.map(|times| times.numbers),
            }),
        })
    }
}

/// Longest step that a column of time without a unit has in seconds: beyond it, milliseconds and
/// microseconds are as likely \[s\].
const LONGEST_STEP_S: f64 = 0.5;

/// Scatter of time stamps that is worth a remark \[steps\].
const SCATTER: f64 = 0.02;

/// Part of a step that is nothing beside it.
const ROUNDED: f64 = 1e-3;

/// How far apart rows are, and how that is known.
struct Spacing {
    period_s: f64,
    /// How far the even times that rows are taken at may lie from those of the commands \[s\].
    uncertain_s: f64,
    /// The column that shows where rows are missing.
    time: Option<TimeColumn>,
    remark: Option<String>,
    /// That the stated period is not that of the column.
    doubt: Option<Doubt>,
}

/// A column of time that does not agree with the period that was stated.
struct Doubt {
    finding: String,
    /// The period by the column, in its unit, and the one that was stated \[s\].
    times: [f64; 2],
}

impl Spacing {
    fn of(clock: Option<Clock<'_>>, options: &DatasetOptions) -> Result<Self, DatasetFault> {
        if let Some(period_s) = options.period_s {
            return match clock {
                Some(clock) => Self::beside_stated(period_s, clock, options),
                None => Ok(Self::stated(period_s)),
            };
        }
        let Clock { name, unit, times } = clock.ok_or(DatasetFault::NoPeriod)?;
        let times = times.ok_or_else(|| DatasetFault::TimeNotNumbers(name.to_owned()))?;
        let time = TimeColumn::new(times)
            .map_err(|fault| DatasetFault::UnevenTime(name.to_owned(), fault))?;
        let step = time.step();
        let (unit, hint) = match options.time_unit.or(unit) {
            Some(unit) => (unit, ""),
            None if step < LONGEST_STEP_S => {
                (TimeUnit::Seconds, " (--time-unit states another unit)")
            }
            None => {
                return Err(DatasetFault::NoTimeUnit {
                    column: name.to_owned(),
                    step,
                });
            }
        };
        let period_s = step * unit.seconds();
        let mut remark = format!(
            "time (column {name:?}) read as {}: rows are {} apart{hint}",
            unit.names().1,
            time_column::shown(period_s)
        );
        let mut uncertain_s = 0.0;
        if time.scatter() > SCATTER {
            uncertain_s = period_s * time.half_spread();
            remark += &format!(
                "; its time stamps scatter by {:.0} % of that, and the rows are taken as evenly spaced (a logger with a clock of its own sees commands late: --polled)",
                100.0 * time.scatter()
            );
            // All of the scatter may be that of the writing.
            if uncertain_s > ROUNDED * period_s {
                remark += &format!(
                    "; where commands are even and rows late, times from the edge come out up to {} too short, and their intervals allow for that",
                    time_column::shown(uncertain_s)
                );
            }
        }
        Ok(Self {
            period_s,
            uncertain_s,
            time: Some(time),
            remark: Some(remark),
            doubt: None,
        })
    }

    /// By statement alone.
    fn stated(period_s: f64) -> Self {
        Self {
            period_s,
            uncertain_s: 0.0,
            time: None,
            remark: None,
            doubt: None,
        }
    }

    /// The column of time beside a period that was stated: it shows where rows are missing, if it agrees.
    fn beside_stated(
        period_s: f64,
        Clock { name, unit, times }: Clock<'_>,
        options: &DatasetOptions,
    ) -> Result<Self, DatasetFault> {
        let Some(times) = times else {
            return Ok(Self::stated(period_s));
        };
        let unit = options.time_unit.or(unit);
        let possible = unit
            .as_ref()
            .map_or(TimeUnit::value_variants(), std::slice::from_ref);
        let agrees = |unit: &TimeUnit| TimeColumn::with_step(&times, period_s / unit.seconds());
        if let Some(column) = possible.iter().find_map(agrees) {
            let uncertain_s = match column.scatter() > SCATTER {
                true => period_s * column.half_spread(),
                false => 0.0,
            };
            return Ok(Self {
                uncertain_s,
                time: Some(column),
                ..Self::stated(period_s)
            });
        }
        let column = TimeColumn::new(times).ok();
        let apart = |found: &TimeColumn, unit: &TimeUnit| found.step() * unit.seconds();
        let near = |seconds: f64| (1.0 / SLIP..SLIP).contains(&(period_s / seconds));
        if let Some(found) = &column
            && !(unit.is_none() && found.step() == COUNT)
            && !possible.iter().any(|unit| near(apart(found, unit)))
        {
            // A column without a unit is one of seconds where its steps are short enough for that.
            let unit = unit.unwrap_or(TimeUnit::Seconds);
            return Err(DatasetFault::PeriodAgainstTime {
                stated: period_s,
                column: name.to_owned(),
                found: six_digits(apart(found, &unit)),
            });
        }
        let (remark, doubt) = match &column {
            Some(column) => {
                let unit = unit.map_or(String::new(), |unit| format!(" {}", unit.names().0));
                let finding = format!(
                    "by column {name:?} rows are {}{unit} apart, but {period_s} s was stated, and is taken",
                    column.step()
                );
                let times = [column.step(), period_s];
                (None, Some(Doubt { finding, times }))
            }
            None => {
                let remark = format!(
                    "column {name:?} is too uneven to say where rows are missing, and is not used"
                );
                (Some(remark), None)
            }
        };
        Ok(Self {
            period_s,
            uncertain_s: 0.0,
            time: column,
            remark,
            doubt,
        })
    }
}

/// A stated period that is so many times as long or as short as that of a column of time is a slip: clocks differ by less. Which of
/// the two is right only the user knows, and a wrong one makes every time wrong.
const SLIP: f64 = 1.1;

/// Steps of a column without a unit that counts rows.
const COUNT: f64 = 1.0;

/// Gaps that a column of time shows, and runs that the user has not named.
fn remarks_on_time(column: &str, found: &[Stretch], labelled: bool) -> Vec<String> {
    let mut remarks = Vec::new();
    let missing: usize = found.iter().map(Stretch::missing).sum();
    if missing > 0 {
        remarks.push(format!(
            "column {column:?} has gaps; {missing} samples count as missing"
        ));
    }
    if found.len() > 1 && !labelled {
        remarks.push(format!(
            "column {column:?} goes back, stands still or jumps far ahead {} {}; a new run begins at each (--run COLUMN names runs)",
            found.len() - 1,
            if found.len() == 2 { "time" } else { "times" }
        ));
    }
    remarks
}
