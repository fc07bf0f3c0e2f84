//! How to read files of other programs.

use super::suggested_columns::quoted;
use super::time_column::TimeUnit;
use serde::{Deserialize, Serialize};

/// How to read files that are not recordings of this program.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct DatasetOptions {
    /// The column with the input.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub input: Option<String>,
    /// The column with the output.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub output: Option<String>,
    /// Time between rows (s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub period_s: Option<f64>,
    /// The column of time; without it, one that is called like one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<String>,
    /// The unit of a column of time whose name does not say it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_unit: Option<TimeUnit>,
    /// The column whose value changes where a new run begins.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub run: Option<String>,
    /// The column that says which controller drove a run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub controller: Option<String>,
    /// The input before the first row of each run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_rest: Option<f64>,
    /// The command changed between rows, as a logger with a clock of its own sees it.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub polled: bool,
    /// The servo was sent the command as it is written, with its noise and to its last digit.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub exact_command: bool,
    /// Use the rest around the reference too.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub with_rest: bool,
}

impl DatasetOptions {
    /// Whether nothing is said.
    pub fn are_default(&self) -> bool {
        *self == Self::default()
    }

    /// These options as a user types them, each with a space before it.
    #[must_use]
    pub fn as_typed(&self) -> String {
        let number = |number: f64| number.to_string();
        let given = [
            ("--input", self.input.clone()),
            ("--output", self.output.clone()),
            ("--period", self.period_s.map(number)),
            ("--time", self.time.clone()),
            (
                "--time-unit",
                self.time_unit.map(|unit| unit.names().0.to_owned()),
            ),
            ("--run", self.run.clone()),
            ("--controller", self.controller.clone()),
            ("--at-rest", self.at_rest.map(number)),
        ];
        let typed = given.into_iter().filter_map(|(option, value)| {
            let value = quoted(&value?);
            Some(format!(" {option} {value}"))
        });
        let flags = [
            (self.polled, " --polled"),
            (self.exact_command, " --exact-command"),
            (self.with_rest, " --with-rest"),
        ];
        let flags = flags
            .iter()
            .filter_map(|(given, flag)| given.then_some(*flag));
        typed.collect::<String>() + &flags.collect::<String>()
    }

    /// These, and the columns, times and runs that they leave open as in `other`. Where a servo stood before a run is a fact of that
    /// run alone.
    #[must_use]
    pub fn or(self, other: &Self) -> Self {
        let other = other.clone();
        // A period and a column of time say the same.
        let (period_s, time, time_unit) = match self.period_s.is_some() || self.time.is_some() {
            true => (self.period_s, self.time, self.time_unit),
            false => (
                other.period_s,
                other.time,
                self.time_unit.or(other.time_unit),
            ),
        };
        Self {
            input: self.input.or(other.input),
            output: self.output.or(other.output),
            period_s,
            time,
            time_unit,
            run: self.run.or(other.run),
            controller: self.controller.or(other.controller),
            at_rest: self.at_rest.or(other.at_rest),
            polled: self.polled || other.polled,
            exact_command: self.exact_command || other.exact_command,
            ..self
        }
    }
}
