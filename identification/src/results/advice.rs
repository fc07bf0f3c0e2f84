//! Findings with their numbers, and what to do about each, as plain data.

use crate::thresholds::{LONGEST_SETTLING, MARGIN};
use serde::{Deserialize, Serialize};

/// What was checked. Documents have these names, which are stable between versions. Nothing outside this file asks for them: what
/// follows from a finding is its [`Precedence`], its [`Setting`], and whether it [bears on a comparison](Advice::bears_on_comparison).
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Check {
    /// Whether the errors are noise.
    ModelError,
    /// Whether the servo is linear.
    Linearity,
    /// Whether the input excites all of the response.
    Excitation,
    /// Whether frequencies that the caller left out have an effect without bound.
    LeftOut,
    /// Whether the input is smooth.
    SmoothReference,
    /// Whether two estimators agree on the metrics.
    Metrics,
    /// Whether the metrics rest on frequencies that the input excites.
    #[serde(alias = "untold")]
    UnexcitedMetrics,
    /// Whether the servo goes as far as it is commanded.
    Travel,
    /// Whether the gain is known to differ from zero.
    GainMayBeZero,
    /// Whether the response is over within the settling time.
    Settled,
    /// Whether the input repeats itself.
    Repeats,
    /// How much of the end of the response the noise hides.
    HiddenTail,
    /// Whether there is a response at all.
    Response,
    /// What frequencies that were left out may hide.
    Truncation,
    /// What the steps of the sensor may hide.
    Resolution,
    /// Whether the steps of the sensor have a bound.
    Rounding,
    /// Whether there are rows enough for the parameters.
    Parameters,
    /// Whether the noise drifts.
    SlowNoise,
    /// Whether the one-step errors are white.
    Whiteness,
    /// Whether the order of the noise is the largest considered.
    NoiseOrder,
    /// Whether the residuals are independent of the input.
    InputIndependence,
    /// Whether moments were accurate enough.
    Conditioning,
    /// Whether the iterations came to rest.
    Converged,
    /// Whether samples were outlying and taken out.
    Outliers,
    /// Whether a periodic disturbance was taken out.
    Hum,
    /// Whether the column of the command has noise within its holds.
    CommandNoise,
    /// Whether errors of the column of the command may be all that excites some of the response.
    CommandErrors,
    /// Whether the input follows the output.
    Feedback,
    /// Whether the output moves before the input.
    OutputLeads,
    /// Whether the servo moves before its command changes.
    EarlyMotion,
    /// Whether the output is refreshed with every sample.
    HeldOutput,
    /// Whether the lag of the output is the same all along the record.
    LagDrift,
    /// Whether the gain is the same all along the record.
    GainDrift,
    /// Whether the servo is slower than the record can show, or its output the integral of the input.
    SlowServo,
    /// Whether any model predicts the record.
    Prediction,
    /// Whether the response goes on beyond the longest time that can be judged, or the settling time that was given.
    SlowEnd,
    /// Whether runs differ by more than their noise.
    RunScatter,
    /// Whether runs that are put together are of one kind.
    UnlikeRuns,
    /// Whether one run stands out.
    DeviatingRun,
    /// How many samples only serve as history.
    History,
    /// Whether runs begin at the rest that was stated.
    AtRest,
    /// Whether runs begin where the servo comes to rest later.
    Start,
    /// Whether both sides had the same reference.
    References,
    /// What models, without their recordings, cannot show.
    OneResponse,
    /// Whether there are runs enough for a test of their scatter.
    Runs,
    /// Whether there are levels enough for limits.
    Levels,
    /// Whether both sides rest at the same angles.
    Zeros,
    /// Whether both sides turn the same way.
    Direction,
    /// Whether both sides were recorded under the same condition.
    Conditions,
    /// Whether both sides were measured by the same calibration.
    Calibration,
    /// Whether the sample period can be that of a recording of a servo.
    Period,
    /// Whether the response takes as long as that of a servo.
    Duration,
    /// Whether a column of time agrees with the period that was stated.
    TimeColumn,
    /// Whether the output has a trend of its own.
    Drift,
    /// Whether the response ends within the record.
    StillRising,
    /// Whether several runs were written as one.
    Seams,
    /// Whether samples are there twice.
    SameData,
    /// Whether all recordings, and both columns of each, seem to be in the same units.
    UnitMix,
    /// Whether commands change between their rows.
    CommandsBetweenRows,
    /// Whether commands wait for frames of their own.
    CommandEdges,
    /// Whether some values are sentinels of missing ones.
    #[serde(alias = "stand_in")]
    SentinelValues,
    /// Whether data are used otherwise than they were written: an angle put together, a row left out.
    ChangedData,
    /// Whether a recording came to its end.
    Partial,
    /// Whether the header of a recording is proved by its checksum.
    Unproved,
    /// The recording's clock was inexact, so all its times are.
    InexactClock,
    /// The sensor's own delay, which was taken out.
    SensorDelay,
    /// Stretches in which the sensor's reading stood still though the command changed.
    FrozenSensor,
    /// Whether the output stops at an angle within the range of the commands.
    TravelEnd,
    /// Whether the output stops following the input within a run.
    Stopped,
    /// One that this version does not know.
    #[serde(untagged)]
    Other(String),
}

impl std::fmt::Display for Check {
    /// The name that documents have.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.serialize(f)
    }
}

/// Where a finding stands beside the results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precedence {
    /// In place of the sentence on the servo: nothing of the results is to be said before it.
    InPlaceOfTheAnswer,
    /// Before that sentence.
    BeforeTheAnswer,
    /// Below the results.
    BelowTheResults,
}

/// What a remedy sets, where a program has an option for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Setting {
    /// The limits of a linear model are to be found.
    Limits,
    /// The input at which the servo rested before the record.
    InputAtRest,
    /// The explanation of the model.
    Explanation,
    /// A trend is to stay in the output.
    KeptTrend,
    /// A settling time is to be stated.
    SettlingTime,
    /// Input and output are to be exchanged.
    ExchangedColumns,
    /// The command is what the servo was sent, to its last digit.
    ExactCommand,
}

/// One finding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Advice {
    /// What was checked.
    pub check: Check,
    /// What was found, as one sentence.
    pub finding: String,
    /// The number that was found.
    pub value: f64,
    /// The number it was held against.
    pub threshold: f64,
    /// What to do, as one sentence.
    #[serde(rename = "do")]
    pub remedy: String,
}

impl Advice {
    /// A finding; numbers that are not finite are replaced by finite ones, because JSON has no infinity.
    #[must_use]
    pub fn new(
        check: Check,
        finding: impl Into<String>,
        value: f64,
        threshold: f64,
        remedy: impl Into<String>,
    ) -> Self {
        let finite = |x: f64| match x.is_nan() {
            true => 0.0,
            false => x.clamp(f64::MIN, f64::MAX),
        };
        Self {
            check,
            finding: finding.into(),
            value: finite(value),
            threshold: finite(threshold),
            remedy: remedy.into(),
        }
    }

    /// The same of one of several servos, which is called `which`.
    ///
    /// ```
    /// use servoid_identification::results::{Advice, Check};
    /// let found = Advice::new(Check::Settled, "The servo is slow.", 1.0, 0.0, "Record longer.");
    /// assert_eq!(found.said_of("The second").finding, "The second: The servo is slow.");
    /// ```
    #[must_use]
    pub fn said_of(&self, which: &str) -> Self {
        Self {
            finding: format!("{which}: {}", self.finding),
            ..self.clone()
        }
    }

    /// Where it stands beside the results.
    #[must_use]
    pub fn precedence(&self) -> Precedence {
        match self.check {
            Check::Period | Check::Prediction => Precedence::InPlaceOfTheAnswer,
            _ if self.is_of_the_record() => Precedence::InPlaceOfTheAnswer,
            Check::Duration | Check::Travel | Check::UnlikeRuns => Precedence::BeforeTheAnswer,
            _ => Precedence::BelowTheResults,
        }
    }

    /// What its remedy sets, where that is an option.
    #[must_use]
    pub fn setting(&self) -> Option<Setting> {
        Some(match self.check {
            Check::Linearity => Setting::Limits,
            Check::AtRest => Setting::InputAtRest,
            Check::Outliers => Setting::Explanation,
            Check::Drift => Setting::KeptTrend,
            Check::OutputLeads => Setting::ExchangedColumns,
            Check::CommandNoise | Check::CommandErrors => Setting::ExactCommand,
            // A longer recording would not change that the longest time that is tried by itself is too short.
            Check::Settled if self.threshold * MARGIN > LONGEST_SETTLING as f64 - 1.0 => {
                Setting::SettlingTime
            }
            _ => return None,
        })
    }

    /// Whether a finding on one model is worth repeating where it is compared with another.
    #[must_use]
    pub fn bears_on_comparison(&self) -> bool {
        let is_of_the_response = matches!(
            self.check,
            Check::ModelError
                | Check::Linearity
                | Check::Excitation
                | Check::LeftOut
                | Check::Repeats
                | Check::Settled
                | Check::Drift
                | Check::CommandNoise
                | Check::CommandErrors
        );
        is_of_the_response || self.is_of_the_record()
    }

    /// Whether it says that the record is not that of a servo which follows its command all along, at the times that the record states.
    fn is_of_the_record(&self) -> bool {
        matches!(
            self.check,
            Check::OutputLeads
                | Check::EarlyMotion
                | Check::HeldOutput
                | Check::LagDrift
                | Check::GainDrift
                | Check::SlowServo
                | Check::CommandsBetweenRows
                | Check::TravelEnd
                | Check::Feedback
                | Check::Stopped
        )
    }

    /// Whether others may follow from it, which are then to be read after it: that runs are of different kinds, or one behind the other.
    #[must_use]
    pub fn explains_others(&self) -> bool {
        matches!(self.check, Check::Seams | Check::UnlikeRuns)
    }

    /// Whether it only says how a result came about: nothing is wrong, and nothing is to be done.
    #[must_use]
    pub fn asks_nothing(&self) -> bool {
        self.check == Check::Conditioning
    }

    /// Whether the finding is that the input follows the output.
    #[must_use]
    pub fn is_of_feedback(&self) -> bool {
        self.check == Check::Feedback
    }

    /// Whether it says that times and frequencies are not those of a servo.
    #[must_use]
    pub fn doubts_times(&self) -> bool {
        matches!(self.check, Check::Period | Check::Duration)
    }

    /// Whether it says that two servos rest apart under the same commands.
    #[must_use]
    pub fn is_of_zeros(&self) -> bool {
        self.check == Check::Zeros
    }

    /// Whether it says that the columns of input and output are exchanged.
    #[must_use]
    pub fn is_of_exchange(&self) -> bool {
        self.check == Check::OutputLeads
    }

    /// Whether it follows from columns that are exchanged: then the input is the motion, and what is asked of a command is not.
    #[must_use]
    pub fn follows_from_exchange(&self) -> bool {
        matches!(
            self.check,
            Check::Feedback
                | Check::SmoothReference
                | Check::Excitation
                | Check::CommandErrors
                | Check::ModelError
                | Check::Metrics
        )
    }

    /// Whether the finding is of the scale of the sensor.
    #[must_use]
    pub fn is_of_sensor_scale(&self) -> bool {
        self.check == Check::Calibration
    }

    /// Whether it says that errors follow the motion.
    #[must_use]
    pub fn is_of_errors_in_motion(&self) -> bool {
        matches!(self.check, Check::Linearity | Check::ModelError)
    }

    /// Whether it says that commands change between the rows.
    #[must_use]
    pub fn is_of_commands_between_rows(&self) -> bool {
        self.check == Check::CommandsBetweenRows
    }

    /// Whether it says that commands wait for moments of their own.
    #[must_use]
    pub fn is_of_waits(&self) -> bool {
        self.check == Check::CommandEdges
    }

    /// Whether it says that runs differ by more than their noise.
    #[must_use]
    pub fn is_of_scatter(&self) -> bool {
        matches!(self.check, Check::RunScatter | Check::DeviatingRun)
    }

    /// Whether it says that a straight line of each run was taken out.
    #[must_use]
    pub fn is_of_drift(&self) -> bool {
        self.check == Check::Drift
    }

    /// Whether it is of noise in the column of the command.
    #[must_use]
    pub fn is_of_command_noise(&self) -> bool {
        self.check == Check::CommandNoise
    }

    /// Whether it says that the output stops at an angle, or falls short.
    #[must_use]
    pub fn is_of_travel_end(&self) -> bool {
        self.check == Check::TravelEnd
    }

    /// Whether it says that the servo is not linear.
    #[must_use]
    pub fn is_of_linearity(&self) -> bool {
        self.check == Check::Linearity
    }

    /// Where runs are not of one kind, that is why they scatter, and nothing else need be looked for.
    pub fn name_unlike_runs(all: &mut [Self]) {
        if !all.iter().any(|item| item.check == Check::UnlikeRuns) {
            return;
        }
        for item in all {
            if item.is_of_scatter() {
                "Runs of different kinds differ by more than noise: identify each kind alone."
                    .clone_into(&mut item.remedy);
            }
        }
    }

    /// Where commands wait for pulses, or a logger saw them late, runs differ by that, and the servo need not be other than linear.
    pub fn name_waits_of_runs(all: &mut [Self]) {
        for item in all.iter_mut().filter(|item| item.is_of_scatter()) {
            "Commands that act later than they are written by other times in each run make runs differ, too: write each with the pulse with which it begins."
                .clone_into(&mut item.remedy);
        }
    }

    /// Where a load is known to hold the servo off its command to the side to which it rests, `remedy` says so, and the zero need not be
    /// looked at. `by_load` is what the load does \[output\], where that is known.
    pub fn name_load(all: &mut [Self], by_load: Option<f64>, remedy: &str) {
        let is_explained = |item: &&mut Self| {
            item.check == Check::Zeros && by_load.is_none_or(|load| item.value * load > 0.0)
        };
        for item in all.iter_mut().filter(is_explained) {
            remedy.clone_into(&mut item.remedy);
        }
    }

    /// Of errors that are not noise: that a servo model met parts of the recording that it had not seen to this `percent`, which the linear model did not.
    pub fn name_servo_model(all: &mut [Self], percent: f64) {
        for item in all
            .iter_mut()
            .filter(|item| item.check == Check::ModelError)
        {
            item.remedy += &format!(
                " The servo model met parts not seen to {percent:.1} %: predict with that."
            );
        }
    }

    /// Whether both are findings of one check.
    #[must_use]
    pub fn is_of_same_check(&self, other: &Self) -> bool {
        self.check == other.check
    }

    /// Findings, each with its side, by what was checked, in the order in which the checks come first.
    pub fn by_check<'a, S>(
        findings: impl IntoIterator<Item = (S, &'a Self)>,
    ) -> Vec<Vec<(S, &'a Self)>> {
        let mut checks: Vec<Vec<(S, &Self)>> = Vec::new();
        for (side, item) in findings {
            let own = |found: &&mut Vec<(S, &Self)>| found[0].1.is_of_same_check(item);
            match checks.iter_mut().find(own) {
                Some(found) => found.push((side, item)),
                None => checks.push(vec![(side, item)]),
            }
        }
        checks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_settling_time_is_stated_where_the_longest_by_itself_is_too_short() {
        let settled = |longest: usize| {
            Advice::new(Check::Settled, "", 400.0, longest as f64 / MARGIN, "").setting()
        };
        assert_eq!(settled(LONGEST_SETTLING), Some(Setting::SettlingTime));
        assert_eq!(settled(LONGEST_SETTLING - 2), None);
    }
}
