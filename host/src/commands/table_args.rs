//! The options that say how to read files.

use crate::data::dataset::suggestion::quoted;
use crate::data::dataset::{DatasetOptions, TimeUnit};
use clap::Args;

#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "How to read the files")]
pub(super) struct TableArgs {
    /// The column with the input (what was commanded), of files that servoid has not recorded; without
    /// its unit, if that leaves no doubt: angle for "angle [deg]"
    #[arg(long, value_name = "COLUMN")]
    input: Option<String>,
    /// The column with the output (what was measured)
    #[arg(long, value_name = "COLUMN")]
    output: Option<String>,
    /// Time between rows (seconds); without it, from a column of time such as 't', 'time_ms', 'Time [s]'
    /// or 'Zeit'
    #[arg(long, value_name = "SECONDS", value_parser = positive)]
    period: Option<f64>,
    /// The column of time, where its name does not tell
    #[arg(long, value_name = "COLUMN")]
    time: Option<String>,
    /// The unit of a column of time whose name does not say it
    #[arg(long, value_enum, value_name = "UNIT")]
    time_unit: Option<TimeUnit>,
    /// The column whose value changes where a new run begins
    #[arg(long, value_name = "COLUMN")]
    run: Option<String>,
    /// The input had this value for a settling time before each run: then no row is left out. State
    /// it only where it is true, as a wrong one is far worse than none
    #[arg(long, value_name = "INPUT", allow_negative_numbers = true, value_parser = finite)]
    at_rest: Option<f64>,
    /// Of recordings of servoid, use the rest at neutral before and after the reference too: its
    /// strokes are half as long, which a real servo does not answer in proportion
    #[arg(long)]
    with_rest: bool,
}

impl TableArgs {
    /// These options as they would be typed again, each with a space before it.
    pub(super) fn as_typed(&self) -> String {
        let texts = [
            ("--input", self.input.clone()),
            ("--output", self.output.clone()),
            ("--period", self.period.map(|period| period.to_string())),
            ("--time", self.time.clone()),
            (
                "--time-unit",
                self.time_unit.map(|unit| unit.name().to_owned()),
            ),
            ("--run", self.run.clone()),
            ("--at-rest", self.at_rest.map(|input| input.to_string())),
        ];
        let given = texts
            .into_iter()
            .filter_map(|(key, value)| Some((key, value?)));
        let mut typed: String = given
            .map(|(key, value)| format!(" {key} {}", quoted(&value)))
            .collect();
        if self.with_rest {
            typed.push_str(" --with-rest");
        }
        typed
    }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if PERIODS_S.contains(&number) => Ok(number),
        _ => Err("a number of seconds above 0 is needed".to_owned()),
    }
}

/// From a nanosecond to a day between samples: beyond, it is a slip.
const PERIODS_S: std::ops::RangeInclusive<f64> = 1e-9..=86_400.0;

fn finite(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err("a number is needed".to_owned()),
    }
}

impl From<TableArgs> for DatasetOptions {
    fn from(args: TableArgs) -> Self {
        Self {
            input: args.input,
            output: args.output,
            period_s: args.period,
            time: args.time,
            time_unit: args.time_unit,
            run: args.run,
            at_rest: args.at_rest,
            with_rest: args.with_rest,
        }
    }
}
