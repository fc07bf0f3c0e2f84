//! The input of commands: recordings, CSV files of other programs, and models.

use super::output::{Talk, stem, wrong_usage};
use crate::data::dataset::{self, Dataset, DatasetError, DatasetOptions, TimeUnit};
use crate::instrument::simulated_servo::SimulatedServoError;
use anyhow::{Result, anyhow};
use clap::Args;
use std::path::PathBuf;

/// The options that describe CSV files of other programs.
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
    /// Column with the name or gain of the controller that drove the run, where several drove the same mechanism: the
    /// servo model fits them together
    #[arg(long, value_name = "COLUMN")]
    controller: Option<String>,
    /// The input's value during at least the settling time before each run; then no row is left out. Give it
    /// only if it is true: a wrong value is far worse than none
    #[arg(long, value_name = "INPUT", allow_negative_numbers = true, value_parser = super::value_parsers::finite)]
    at_rest: Option<f64>,
    /// The command changed between rows: a logger with a clock of its own wrote the file. Times are then corrected by half a row,
    /// and their intervals allow for the other half
    #[arg(long)]
    polled: bool,
    /// The servo was sent the command as it is written, to its last digit and with its row: what noise its holds have moved the
    /// servo, too, nothing was rounded, and no change waited for a pulse. servoid's own recordings are so in any case
    #[arg(long)]
    exact_command: bool,
    /// Use the rest at neutral before and after the reference of servoid's recordings too. Its strokes are half
    /// as long, and a real servo does not follow them in proportion
    #[arg(long)]
    with_rest: bool,
}

/// The columns of a second side, where they have other names than those of the first.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Input files")]
pub(super) struct SecondSideArgs {
    /// Column of the input of the second side, where it is called otherwise than that of the first
    #[arg(long, value_name = "COLUMN", requires = "input")]
    input_b: Option<String>,
    /// Column of the output of the second side, likewise
    #[arg(long, value_name = "COLUMN", requires = "output")]
    output_b: Option<String>,
}

impl SecondSideArgs {
    /// How the second side is to be read, whose first is read so.
    fn options(&self, first: &DatasetOptions) -> DatasetOptions {
        let or = |own: &Option<String>, of_first: &Option<String>| own.clone().or(of_first.clone());
        DatasetOptions {
            input: or(&self.input_b, &first.input),
            output: or(&self.output_b, &first.output),
            ..first.clone()
        }
    }

    /// The error of reading two sides, with what names the columns of the second, where that is what it lacks.
    fn named(&self, error: DatasetError) -> anyhow::Error {
        let open = self.input_b.is_none() && self.output_b.is_none();
        match open && error.is_of_a_missing_column() {
            true => anyhow!(
                "{error}; where the columns of the two sides have different names, --input and --output are those of the first, and --input-b and \
                 --output-b those of the second"
            ),
            false => error.into(),
        }
    }
}

impl TableArgs {
    /// These options as a user types them, each with a space before it.
    pub(super) fn as_typed(&self) -> String {
        self.options().as_typed()
    }

    /// How these options say that files are to be read.
    pub(super) fn options(&self) -> DatasetOptions {
        let args = self.clone();
        DatasetOptions {
            input: args.input,
            output: args.output,
            period_s: args.period,
            time: args.time,
            time_unit: args.time_unit,
            run: args.run,
            controller: args.controller,
            at_rest: args.at_rest,
            polled: args.polled,
            exact_command: args.exact_command,
            with_rest: args.with_rest,
        }
    }

    /// The runs of these files together.
    pub(super) fn load(&self, files: &[PathBuf], talk: Talk) -> Result<Dataset<'static>> {
        self.load_as(&DatasetOptions::default(), files, talk)
    }

    /// The runs of these files together, read as the runs of a model were unless these options say otherwise. Files that cannot
    /// be read so, such as recordings of servoid, are read for themselves.
    pub(super) fn load_as(
        &self,
        model: &DatasetOptions,
        files: &[PathBuf],
        talk: Talk,
    ) -> Result<Dataset<'static>> {
        let data = dataset::load_as(files, &self.options(), model)?;
        say_remarks(&data, talk);
        Ok(data)
    }

    /// These options, and what they leave open as the file of a model was read, as a user types them for a file of this kind.
    pub(super) fn as_typed_like(&self, model: &DatasetOptions) -> String {
        self.options().or(model).as_typed()
    }

    /// The two sides of a comparison.
    pub(super) fn load_sides(
        &self,
        sides: [&[PathBuf]; 2],
        second: &SecondSideArgs,
        talk: Talk,
    ) -> Result<[Dataset<'static>; 2]> {
        let first = self.options();
        let both = [&first, &second.options(&first)];
        let sides = dataset::load_sides(sides, both).map_err(|error| second.named(error))?;
        sides.iter().for_each(|side| say_remarks(side, talk));
        Ok(sides)
    }
}

/// Says what is to be known of data before their results. Text has the findings among it as advice, and JSON nobody reads.
fn say_remarks(data: &Dataset, talk: Talk) {
    let about = &data.about;
    let is_advice = |remark: &String| about.advice.iter().any(|item| item.finding == *remark);
    let remarks = about.remarks.iter();
    let remarks = remarks.filter(|remark| talk.json || !is_advice(remark));
    remarks.for_each(|remark| talk.say(remark));
}

/// That there is no such simulated servo; a text that describes none is wrong usage.
pub(super) fn no_servo(error: SimulatedServoError) -> anyhow::Error {
    use SimulatedServoError::{NoControllers, Options, TwoSeeds, Unknown};
    match error {
        Options(_) | Unknown(_) | NoControllers(_) | TwoSeeds { .. } => wrong_usage(error),
        other => other.into(),
    }
}

/// The name of data: their condition, or what the names of their files have in common.
pub(super) fn name_of(data: &Dataset, files: &[PathBuf]) -> String {
    let condition = data.about.condition.clone();
    condition.unwrap_or_else(|| common_name(files))
}

/// What the names of files begin with alike, without a number or a mark at its end, such as "old" of old_1 and old_2; where that is nothing, the first name.
pub(super) fn common_name(files: &[PathBuf]) -> String {
    let (first, further) = match files {
        [] => return String::new(),
        [one] => return stem(one),
        [first, further @ ..] => (stem(first), further),
    };
    let alike = further.iter().fold(first.as_str(), |alike, file| {
        let name = stem(file);
        let same = alike.chars().zip(name.chars()).take_while(|(a, b)| a == b);
        let length = same.map(|(letter, _)| letter.len_utf8()).sum();
        alike.get(..length).unwrap_or_default()
    });
    let without_number = alike.trim_end_matches(|letter: char| letter.is_ascii_digit());
    match without_number.trim_end_matches(|letter: char| !letter.is_alphanumeric()) {
        "" => first,
        alike => alike.to_owned(),
    }
}
