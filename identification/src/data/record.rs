//! A record: commanded input and measured output, in one or more runs.
//!
//! Samples are evenly spaced. A missing sample is NaN and keeps its place. Row k of the regression
//! y(k) = φ(k)'θ + v(k) needs the output at k and the input at k, k-1, ..., so a gap removes only the rows
//! whose history it interrupts.

mod known_inputs;
mod missing_samples;

use std::borrow::Cow;
use std::ops::Range;

use crate::data::timing::Timing;
use crate::error::Error;

/// Largest magnitude of a sample. Squares of gains, of a motion this large for commands that move by [`SMALLEST`], are
/// numbers that a model's file may have (1e75).
const LARGEST: f64 = 1e18;

/// Least motion of a column: what moves less, in whatever unit, is the rounding of a computation.
const SMALLEST: f64 = 1e-18;

/// One uninterrupted experiment: input and output, sample by sample. Columns of the caller are borrowed where they are
/// slices, and never copied as long as they stay as they are.
#[derive(Debug, Clone, PartialEq)]
pub struct Run<'a> {
    input: Cow<'a, [f64]>,
    output: Cow<'a, [f64]>,
    at_rest: Option<f64>,
    label: Option<f64>,
    has_exact_input: bool,
    late_s: Option<Cow<'a, [f64]>>,
}

impl<'a> Run<'a> {
    /// Pairs input u and output y, one value of each per sample, NaN where a sample is missing. Each is a vector, or a slice
    /// that is borrowed.
    ///
    /// # Errors
    /// The two differ in length, or a value is infinite or beyond 1e18 (the run is then called run 1).
    pub fn new(
        input: impl Into<Cow<'a, [f64]>>,
        output: impl Into<Cow<'a, [f64]>>,
    ) -> Result<Self, Error> {
        let (input, output) = (input.into(), output.into());
        if input.len() != output.len() {
            return Err(Error::LengthMismatch {
                input: input.len(),
                output: output.len(),
            });
        }
        for (column, values) in [("input", &input), ("output", &output)] {
            if let Some(sample) = values.iter().position(|value| value.abs() > LARGEST) {
                return Err(Error::Infinite {
                    column,
                    run: 1,
                    sample,
                });
            }
        }
        Ok(Self {
            input,
            output,
            at_rest: None,
            label: None,
            has_exact_input: false,
            late_s: None,
        })
    }

    /// States how long after its sample each input came into force, less than a sample period \[s\]: that of a pulse between two samples. Servo models are simulated so; for a linear
    /// model each is in force from its sample on.
    ///
    /// # Errors
    /// There are not as many as samples.
    pub fn with_late_inputs(mut self, late_s: impl Into<Cow<'a, [f64]>>) -> Result<Self, Error> {
        let late_s = late_s.into();
        if late_s.len() != self.len() {
            return Err(Error::LengthMismatch {
                input: self.len(),
                output: late_s.len(),
            });
        }
        self.late_s = Some(late_s);
        Ok(self)
    }

    /// How long after its sample each input came into force \[s\]; `None` where all did at once.
    #[must_use]
    pub fn late_inputs(&self) -> Option<&[f64]> {
        self.late_s.as_deref()
    }

    /// States that the input was constant at `input` for at least a settling time before the first
    /// sample.
    ///
    /// Without this statement the first N-1 rows have no history and are left out. A wrong value is far
    /// worse than none: it can move the step response by several times its bounds.
    #[must_use]
    pub fn with_input_at_rest(mut self, input: f64) -> Self {
        self.at_rest = Some(input);
        self
    }

    /// States that the servo got the input as it is here, to the last digit: pulses that were counted, or what a simulation was given.
    ///
    /// Without this statement an input in even steps may have been rounded where it was written, and the bounds allow for that. An input
    /// that is on no grid needs no statement.
    #[must_use]
    pub fn with_exact_input(mut self) -> Self {
        self.has_exact_input = true;
        self
    }

    /// Whether the input is stated to be what the servo got.
    #[must_use]
    pub fn has_exact_input(&self) -> bool {
        self.has_exact_input
    }

    /// States what the run is called where it comes from, such as its number in a column of runs: findings name it so.
    #[must_use]
    pub fn with_label(mut self, label: f64) -> Self {
        self.label = Some(label);
        self
    }

    /// What the run is called.
    #[must_use]
    pub fn label(&self) -> Option<f64> {
        self.label
    }

    /// The run with another input \[input\], all else as it was.
    ///
    /// # Errors
    /// As of [`Run::new`].
    pub fn with_input(&self, input: Vec<f64>) -> Result<Self, Error> {
        Ok(Self {
            at_rest: self.at_rest,
            label: self.label,
            has_exact_input: self.has_exact_input,
            ..Self::new(input, self.output.clone())?
        })
    }

    /// The run as if nothing were known of its commands before sample `start`.
    pub(crate) fn without_start(&self, start: usize) -> Self {
        let mut input = self.input.to_vec();
        input[..start].fill(f64::NAN);
        Self {
            input: input.into(),
            output: self.output.clone(),
            at_rest: None,
            ..self.clone()
        }
    }

    /// The run with another output of the same length.
    pub(crate) fn with_output(&self, output: Vec<f64>) -> Self {
        debug_assert_eq!(output.len(), self.output.len());
        Self {
            input: self.input.clone(),
            output: output.into(),
            late_s: self.late_s.clone(),
            ..*self
        }
    }

    /// The run with each input, that at rest included, replaced.
    pub(crate) fn with_each_input(&self, by: impl Fn(f64) -> f64) -> Self {
        Self {
            input: self.input.iter().map(|u| by(*u)).collect(),
            at_rest: self.at_rest.map(&by),
            ..self.clone()
        }
    }

    /// The same run, with its columns borrowed.
    fn borrowed(&self) -> Run<'_> {
        Run {
            input: Cow::Borrowed(&self.input),
            output: Cow::Borrowed(&self.output),
            late_s: self.late_s.as_deref().map(Cow::Borrowed),
            ..*self
        }
    }

    /// The run with columns of its own.
    #[must_use]
    pub fn into_owned(self) -> Run<'static> {
        Run {
            input: self.input.into_owned().into(),
            output: self.output.into_owned().into(),
            at_rest: self.at_rest,
            label: self.label,
            has_exact_input: self.has_exact_input,
            late_s: self.late_s.map(|late_s| late_s.into_owned().into()),
        }
    }

    /// The input u, one value per sample, NaN where missing.
    pub fn input(&self) -> &[f64] {
        &self.input
    }

    /// The output y, one value per sample, NaN where missing.
    pub fn output(&self) -> &[f64] {
        &self.output
    }

    /// The input before the first sample, if it was stated.
    pub fn input_at_rest(&self) -> Option<f64> {
        self.at_rest
    }

    /// Number of samples, missing ones included.
    pub fn len(&self) -> usize {
        self.input.len()
    }

    /// Whether the run has no sample.
    pub fn is_empty(&self) -> bool {
        self.input.is_empty()
    }

    /// The part of the run from `range.start` up to `range.end`, as a run of its own.
    ///
    /// Only a part that starts at sample 0 keeps the statement about rest.
    ///
    /// # Panics
    /// When `range` reaches beyond the run.
    pub fn part(&self, range: Range<usize>) -> Run<'_> {
        Run {
            at_rest: self.at_rest.filter(|_| range.start == 0),
            label: self.label,
            has_exact_input: self.has_exact_input,
            input: Cow::Borrowed(&self.input[range.clone()]),
            output: Cow::Borrowed(&self.output[range.clone()]),
            late_s: (self.late_s.as_deref()).map(|late_s| Cow::Borrowed(&late_s[range])),
        }
    }

    /// Input at sample `k`, which may lie before the run when it began at rest.
    pub(crate) fn input_at(&self, k: isize) -> f64 {
        match usize::try_from(k) {
            Ok(k) => self.input[k],
            Err(_) => self.at_rest.unwrap_or(f64::NAN),
        }
    }
}

/// One or more runs of the same servo under the same conditions, at one sample period.
///
/// ```
/// use servoid_identification::{Record, Run};
/// let first = Run::new(vec![0.0, 1.0, 1.0], vec![0.0, 0.2, f64::NAN])?;
/// let second = Run::new(vec![1.0, 0.0, 0.0], vec![1.0, 1.0, 0.7])?.with_input_at_rest(1.0);
/// let record = Record::new(0.002, vec![first, second])?;
/// assert_eq!((record.samples(), record.missing()), (6, 1));
/// # Ok::<(), servoid_identification::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Record<'a> {
    sample_period_s: f64,
    sample_phase_s: f64,
    runs: Vec<Run<'a>>,
    rest: Vec<Run<'a>>,
    /// Of input and output; empty where they are not known.
    units: [String; 2],
}

impl<'a> Record<'a> {
    /// A record of several runs.
    ///
    /// # Errors
    /// The period is not positive; a column is all missing; input or output never change.
    pub fn new(sample_period_s: f64, runs: Vec<Run<'a>>) -> Result<Self, Error> {
        if !(sample_period_s > 0.0 && sample_period_s.is_finite()) {
            return Err(Error::SamplePeriod(sample_period_s));
        }
        check_column(&runs, "input", Run::input, |value| Error::ConstantInput {
            value,
        })?;
        check_column(&runs, "output", Run::output, |value| {
            Error::ConstantOutput { value }
        })?;
        Ok(Self {
            sample_period_s,
            sample_phase_s: 0.0,
            runs,
            rest: Vec::new(),
            units: Default::default(),
        })
    }

    /// States the units of input and output, for the sentences of findings; empty where they are not known.
    #[must_use]
    pub fn with_units(mut self, [input, output]: [&str; 2]) -> Self {
        self.units = [input.to_owned(), output.to_owned()];
        self
    }

    /// The units of input and output; empty where they are not known.
    pub fn units(&self) -> [&str; 2] {
        self.units.each_ref().map(String::as_str)
    }

    /// The record with these runs in place of its own, all else as it was.
    ///
    /// # Errors
    /// As of [`Record::new`].
    pub fn try_with_runs<'r>(&self, runs: Vec<Run<'r>>) -> Result<Record<'r>, Error>
    where
        'a: 'r,
    {
        Ok(Record {
            sample_phase_s: self.sample_phase_s,
            rest: self.rest.clone(),
            units: self.units.clone(),
            ..Record::new(self.sample_period_s, runs)?
        })
    }

    /// States that the output is sampled `seconds` after the instant at which the input of the same
    /// sample takes effect: sample m after an edge is then the servo m Ts + `seconds` after it. The
    /// times and phases of [`Metrics`](crate::results::Metrics) count from the edge.
    ///
    /// # Panics
    /// When `seconds` is negative or not finite.
    #[must_use]
    pub fn with_sample_phase(mut self, seconds: f64) -> Self {
        assert!(
            seconds >= 0.0 && seconds.is_finite(),
            "a sample phase of {seconds} s is not a time after an edge"
        );
        self.sample_phase_s = seconds;
        self
    }

    /// Adds recordings at a constant input, such as the rest before and after a reference. Nothing is
    /// estimated from them. They show the noise at standstill, which the errors in motion are compared with
    /// ([`StandstillNoise`](crate::diagnostics::StandstillNoise)).
    #[must_use]
    pub fn with_rest(mut self, rest: Vec<Run<'a>>) -> Self {
        self.rest = rest;
        self
    }

    /// The recordings at a constant input around the runs.
    pub fn rest(&self) -> &[Run<'a>] {
        &self.rest
    }

    /// Sample period and sample phase.
    pub fn timing(&self) -> Timing {
        Timing {
            sample_period_s: self.sample_period_s,
            sample_phase_s: self.sample_phase_s,
        }
    }

    /// Time from the edge of the input to the sample of the output that belongs to it \[s\].
    pub fn sample_phase_s(&self) -> f64 {
        self.sample_phase_s
    }

    /// A record of a single run.
    ///
    /// # Errors
    /// As [`Run::new`] and [`Record::new`].
    pub fn of_run(
        sample_period_s: f64,
        input: impl Into<Cow<'a, [f64]>>,
        output: impl Into<Cow<'a, [f64]>>,
    ) -> Result<Self, Error> {
        Self::new(sample_period_s, vec![Run::new(input, output)?])
    }

    /// Time between samples \[s\].
    pub fn sample_period_s(&self) -> f64 {
        self.sample_period_s
    }

    /// The same with other runs, which are known to vary (see [`Record::try_with_runs`]).
    pub(crate) fn with_runs(&self, runs: Vec<Run<'a>>) -> Self {
        Self {
            runs,
            ..self.clone()
        }
    }

    /// Each run as a record of its own.
    pub(crate) fn each_run(&self) -> impl Iterator<Item = Self> {
        let alone = |run: &Run<'a>| self.with_runs(vec![run.clone()]);
        self.runs.iter().map(alone)
    }

    /// The same with the missing inputs that the others make known (see [`known_inputs`]).
    pub(crate) fn with_complete_inputs(&self) -> Record<'_> {
        self.with_inputs(Run::with_complete_input)
    }

    /// The same, and with those across which it moves evenly (see [`known_inputs`]).
    pub(crate) fn with_bridged_inputs(&self) -> Record<'_> {
        self.with_inputs(Run::with_bridged_input)
    }

    /// The same with all outputs, those at rest too, of the other sign.
    pub(crate) fn turned_round(&self) -> Self {
        self.with_each_output(|y| -y)
    }

    /// The same with each output, those at rest too, replaced.
    ///
    /// ```
    /// use servoid_identification::Record;
    /// let record = Record::of_run(0.01, vec![0.0, 1.0], vec![5.0, 7.0])?;
    /// let moved = record.with_each_output(|y| y - 5.0);
    /// assert_eq!(moved.runs()[0].output(), [0.0, 2.0]);
    /// # Ok::<(), servoid_identification::Error>(())
    /// ```
    #[must_use]
    pub fn with_each_output(&self, by: impl Fn(f64) -> f64) -> Self {
        let replaced =
            |run: &Run<'a>| run.with_output(run.output().iter().map(|y| by(*y)).collect());
        Self {
            runs: self.runs.iter().map(replaced).collect(),
            rest: self.rest.iter().map(replaced).collect(),
            ..self.clone()
        }
    }

    fn with_inputs<'b>(&'b self, completed: impl Fn(&'b Run<'a>) -> Run<'b>) -> Record<'b> {
        Record {
            runs: self.runs.iter().map(completed).collect(),
            rest: self.rest.iter().map(Run::borrowed).collect(),
            units: self.units.clone(),
            ..*self
        }
    }

    /// The inputs of all runs, one after the other; NaN where one is missing.
    pub fn inputs(&self) -> impl Iterator<Item = f64> {
        self.runs.iter().flat_map(Run::input).copied()
    }

    /// The outputs of all runs, likewise.
    pub fn outputs(&self) -> impl Iterator<Item = f64> {
        self.runs.iter().flat_map(Run::output).copied()
    }

    /// The runs, in the order given.
    pub fn runs(&self) -> &[Run<'a>] {
        &self.runs
    }

    /// Number of samples of all runs, missing ones included.
    pub fn samples(&self) -> usize {
        self.runs.iter().map(Run::len).sum()
    }

    /// Number of samples of all runs that lack the input or the output.
    pub fn missing(&self) -> usize {
        self.runs.iter().map(Run::missing).sum()
    }

    /// Number of complete rows (see [`Run::complete_rows`]).
    pub fn count_rows(&self, input_lags: usize, output_lags: usize) -> usize {
        self.runs
            .iter()
            .flat_map(|run| run.complete_rows(input_lags, output_lags))
            .map(|span| span.len())
            .sum()
    }
}

/// Requires that a column has values and is not constant. [`Run::new`] has checked their magnitude.
fn check_column<'a>(
    runs: &[Run<'a>],
    column: &'static str,
    values: for<'r> fn(&'r Run<'a>) -> &'r [f64],
    constant: fn(f64) -> Error,
) -> Result<(), Error> {
    let mut present = runs.iter().flat_map(values).filter(|value| !value.is_nan());
    let first = *present.next().ok_or(Error::AllMissing { column })?;
    if present.any(|value| (value - first).abs() > SMALLEST) {
        Ok(())
    } else {
        let is_zero = first.abs() <= SMALLEST;
        Err(constant(if is_zero { 0.0 } else { first }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_takes_out_the_rows_whose_history_it_interrupts_and_no_others() {
        let nan = f64::NAN;
        let run = Run::new(
            vec![0.0, 1.0, 2.0, 3.0, nan, 5.0, 6.0, 7.0, 8.0],
            vec![0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, nan],
        )
        .unwrap();
        assert_eq!(run.complete_rows(3, 1), vec![2..4, 7..8]);
        assert_eq!(run.complete_rows(1, 2), vec![1..4, 5..8]);
        assert_eq!(
            run.with_input_at_rest(0.0).complete_rows(3, 1),
            vec![0..4, 7..8]
        );
    }

    #[test]
    fn late_inputs_stay_with_their_samples() {
        let run = Run::new(vec![0.0, 1.0, 2.0, 3.0], vec![0.0; 4]).unwrap();
        assert!(run.clone().with_late_inputs(vec![0.0; 3]).is_err());
        let run = run.with_late_inputs(vec![0.0, 0.1, 0.2, 0.3]).unwrap();
        assert_eq!(run.part(1..3).late_inputs(), Some(&[0.1, 0.2][..]));
        assert_eq!(
            run.with_output(vec![1.0; 4]).late_inputs(),
            run.late_inputs()
        );
        assert_eq!(run.clone().into_owned(), run);
        // Other inputs are in force at other times.
        assert_eq!(run.with_input(vec![1.0; 4]).unwrap().late_inputs(), None);
    }

    #[test]
    fn slices_are_read_where_they_are_and_copied_only_to_be_filled() {
        let (input, output) = ([0.0, 1.0, f64::NAN, 1.0], [0.0, 0.1, 0.2, 0.3]);
        let record = Record::of_run(0.1, &input, &output).unwrap();
        let run = &record.runs()[0];
        assert_eq!(run.input().as_ptr(), input.as_ptr());
        assert_eq!(run.output().as_ptr(), output.as_ptr());
        assert_eq!(run.part(1..3).output().as_ptr(), output[1..].as_ptr());
        let held = record.with_complete_inputs();
        assert_eq!(held.runs()[0].input(), [0.0, 1.0, 1.0, 1.0]);
        assert_eq!(held.runs()[0].output().as_ptr(), output.as_ptr());
        let complete = Record::of_run(0.1, &output, &output).unwrap();
        let held = complete.with_complete_inputs();
        assert_eq!(held.runs()[0].input().as_ptr(), output.as_ptr());
    }

    #[test]
    fn unusable_columns_are_named() {
        let record = |u: &[f64], y: &[f64]| Record::of_run(0.1, u, y).unwrap_err();
        assert_eq!(
            record(&[1.0, 1.0], &[0.0, 1.0]),
            Error::ConstantInput { value: 1.0 }
        );
        assert_eq!(
            record(&[1.0, 2.0], &[3.0, 3.0]),
            Error::ConstantOutput { value: 3.0 }
        );
        assert_eq!(
            record(&[f64::NAN, f64::NAN], &[0.0, 1.0]),
            Error::AllMissing { column: "input" }
        );
        assert_eq!(
            record(&[1.0, 2.0], &[1e-200, 3e-200]),
            Error::ConstantOutput { value: 0.0 }
        );
        assert_eq!(record(&[], &[]), Error::AllMissing { column: "input" });
        assert_eq!(
            record(&[0.0, 1.0], &[0.0, f64::INFINITY]),
            Error::Infinite {
                column: "output",
                run: 1,
                sample: 1
            }
        );
        assert_eq!(
            record(&[1.0], &[1.0, 2.0]),
            Error::LengthMismatch {
                input: 1,
                output: 2
            }
        );
        for period in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let error = Record::of_run(period, &[0.0, 1.0], &[0.0, 1.0]).unwrap_err();
            assert!(matches!(error, Error::SamplePeriod(_)));
        }
    }
}
