//! The options that describe CSV files of other programs.

use crate::data::dataset::suggestion::quoted;
use crate::data::dataset::{DatasetOptions, TimeUnit};
use clap::Args;

#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Input files")]
pub(super) struct TableArgs {
    /// Column of the input (the command), for files that servoid has not recorded. Its unit may be left out
    /// where that is clear: angle for "angle [deg]"
    #[arg(long, value_name = "COLUMN")]
    input: Option<String>,
    /// Column of the output (the measured motion)
    #[arg(long, value_name = "COLUMN")]
    output: Option<String>,
    /// Time between rows (s); without it, from a time column such as 't', 'time_ms', 'Time [s]' or 'Zeit'
    #[arg(long, value_name = "SECONDS", value_parser = super::value_parsers::period)]
    period: Option<f64>,
    /// Time column, where its name is not recognised
    #[arg(long, value_name = "COLUMN")]
    time: Option<String>,
    /// Unit of a time column whose name does not have it
    #[arg(long, value_enum, value_name = "UNIT")]
    time_unit: Option<TimeUnit>,
    /// Column whose value changes where a new run begins
    #[arg(long, value_name = "COLUMN")]
    run: Option<String>,
    /// The input's value during at least the settling time before each run; then no row is left out. Give it
    /// only if it is true: a wrong value is far worse than none
    #[arg(long, value_name = "INPUT", allow_negative_numbers = true, value_parser = super::value_parsers::finite)]
    at_rest: Option<f64>,
    /// Use the rest at neutral before and after the reference of servoid's recordings too. Its strokes are half
    /// as long, and a real servo does not follow them in proportion
    #[arg(long)]
    with_rest: bool,
}

impl TableArgs {
    /// These options as a user types them, each with a space before it.
    pub(super) fn as_typed(&self) -> String {
        let texts = [
            ("--input", self.input.clone()),
            ("--output", self.output.clone()),
            ("--period", self.period.map(|period| period.to_string())),
            ("--time", self.time.clone()),
            (
                "--time-unit",
                self.time_unit.map(|unit| unit.names().0.to_owned()),
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
