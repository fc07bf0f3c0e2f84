//! What can be wrong with a record or a request, each as one sentence that says what to do.

/// Why no model could be made, or why a request does not fit the data.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The sample period is zero, negative or not finite.
    #[error("the sample period is {0} s: state a positive number of seconds between samples")]
    SamplePeriod(f64),
    /// Input and output of a run differ in length.
    #[error(
        "the input has {input} samples and the output {output}: give one input value for each \
         output value, and NaN where a sample is missing"
    )]
    LengthMismatch {
        /// Samples of the input.
        input: usize,
        /// Samples of the output.
        output: usize,
    },
    /// A value is infinite.
    #[error(
        "the {column} is infinite, or too large to compute with, at sample {sample} of run {run}: \
         repair that value, or mark it as missing"
    )]
    Infinite {
        /// `"input"` or `"output"`.
        column: &'static str,
        /// Run, counted from 1.
        run: usize,
        /// Sample within the run, counted from 0.
        sample: usize,
    },
    /// A column holds no value at all.
    #[error("the {column} has no value that is a number: check that the right column was chosen")]
    AllMissing {
        /// `"input"` or `"output"`.
        column: &'static str,
    },
    /// The input never changes.
    #[error(
        "the input never moves from {value}, so nothing shows the response to it: record a reference \
         with several steps"
    )]
    ConstantInput {
        /// The only value the input takes.
        value: f64,
    },
    /// The output never changes.
    #[error(
        "the output never moves from {value} while the input does: check the sensor and its column"
    )]
    ConstantOutput {
        /// The only value the output takes.
        value: f64,
    },
    /// A variance is not a number, so that nothing is known of the uncertainty.
    #[error(
        "how sure the response is cannot be computed from this recording, because a variance is not a number: please report it with the recording; '--noise-order 0' \
         or another settling time may avoid it"
    )]
    NoVariance,
    /// An output of two values under an input of many.
    #[error(
        "the output has only {levels} values, and the input has many: the two columns seem to be swapped; the input is the command, the \
         output the motion"
    )]
    Swapped {
        /// Values of the output.
        levels: usize,
    },
    /// Not enough complete rows for the model asked for.
    #[error(
        "{usable} samples have a full history of {history} (settling time and order of the noise), and a model of {parameters} parameters \
         needs at least {needed}: record longer, shorten the settling time, or state the input \
         before the record (at rest)"
    )]
    TooFewSamples {
        /// Rows whose history is complete.
        usable: usize,
        /// Samples of history that each row needs.
        history: usize,
        /// Parameters to be estimated.
        parameters: usize,
        /// Rows needed at least.
        needed: usize,
    },
    /// The caller has ended a search.
    #[error("the search was ended before it had found anything: let it go on to its end")]
    SearchEnded,
    /// The record is too short for an automatic choice of the structure.
    #[error(
        "an automatic choice of the settling time needs at least {needed} samples in one piece, and {}: {}{}",
        match samples < needed {
            true => format!("the record has {samples}"),
            false => format!("runs and gaps part the {samples} of the record into shorter ones"),
        },
        at_rest.map_or_else(String::new, |input| format!(
            "if the servo rests at the beginning, state the input there, which is {input} (at rest); otherwise "
        )),
        match (samples < needed, Error::settling_for(*samples)) {
            (true, Some(settling)) => {
                format!("record longer, or state a settling time within which the servo settles, such as {settling} samples")
            }
            (true, None) => "record longer".to_owned(),
            (false, _) => "record longer and without gaps, or state the settling time in samples".to_owned(),
        }
    )]
    TooShortForAuto {
        /// Samples in the record.
        samples: usize,
        /// Samples needed at least.
        needed: usize,
        /// The first input, where stating that the servo rests at it makes the record long enough.
        at_rest: Option<f64>,
    },
    /// Most rows have no output, and the noise is described by outputs one after the other.
    #[error(
        "one row in {every} has an output, and a linear model takes outputs one after the other: leave the other rows out, or state the settling time in samples, the input before the \
         record and a noise order of 0"
    )]
    OutputsFarApart {
        /// Rows for each output.
        every: usize,
    },
    /// The settling time is not a usable number of samples.
    #[error("a settling time of {settling} samples is not possible: state 3 to {longest} samples")]
    Settling {
        /// The number asked for.
        settling: usize,
        /// Largest number supported.
        longest: usize,
    },
    /// The number of frequencies is even, zero or larger than the settling time.
    #[error(
        "{frequencies} frequencies do not fit a settling time of {settling} samples: state an odd \
         number from 1 to {settling}"
    )]
    Frequencies {
        /// The number asked for.
        frequencies: usize,
        /// Settling time in samples.
        settling: usize,
    },
    /// The noise order is beyond what is supported.
    #[error("a noise order of {order} is too high: state a number from 0 to {max}")]
    NoiseOrder {
        /// The order asked for.
        order: usize,
        /// Largest order supported.
        max: usize,
    },
    /// The confidence level is not between 0.5 and 1.
    #[error(
        "a confidence level of {0} is not possible: state a number such as 0.99, between 0.5 and 0.99999"
    )]
    Level(f64),
    /// The input determines the gain at rest at the most.
    #[error(
        "the input moves too smoothly for a step response: like a single sine or a slow ramp it determines \
         the gain at one frequency at the most; record a reference with steps, such as a staircase or random \
         steps"
    )]
    NoDetail,
    /// Nothing of the output follows the input.
    #[error(
        "the output shows no response to the input above its noise: check that the sensor is connected, \
         that the servo moves and does not stand at a stop, and that input and output belong together; if they do, use larger steps, or a shorter settling time where one is stated"
    )]
    Unanswered,
    /// The output changes from run to run alone.
    #[error(
        "the output stands still in every run while the input moves: exchange the two columns if the output is the command, or check the \
         sensor and its column"
    )]
    StillInRuns,
    /// The output is a straight line in every run.
    #[error(
        "the output rises evenly with every sample, whatever the input does: it seems to be a column of time or of numbers; name the \
         column of the motion"
    )]
    CountsSamples,
    /// The input changes from run to run alone.
    #[error(
        "the input stands still in every run, so the step that each run answers came before its first sample: state the input before \
         the runs (at rest), or record from before the step on"
    )]
    StepsBeforeRuns,
    /// The input changes within the history of the first rows that are used alone.
    #[error(
        "the input stands still after the first {rows} samples of every run, which are history for the later ones, so the answer to its step \
         is left out: state the input before the runs (at rest), or record more steps"
    )]
    StepsInHistory {
        /// Samples of history.
        rows: usize,
    },
    /// The input does not excite as many frequencies as asked for, or as the settling time has.
    #[error(
        "the input excites {excited} of the {asked} frequencies that are to be determined (up to {highest_hz:.3} \
         Hz): record a reference with sharper and more steps, or ask for at most {excited} frequencies"
    )]
    NotExcited {
        /// Frequencies to be determined.
        asked: usize,
        /// Odd number of frequencies that the input does excite.
        excited: usize,
        /// The highest excited frequency \[Hz\].
        highest_hz: f64,
    },
    /// Two records, or a record and a model, differ in sample period.
    #[error(
        "the sample period is {found} s where {expected} s is needed: resample the record or \
         identify it on its own"
    )]
    PeriodMismatch {
        /// Period of the model or first record \[s\].
        expected: f64,
        /// Period of the record at hand \[s\].
        found: f64,
    },
    /// No sample of a record has the history that the model needs.
    #[error(
        "no sample has the {history} samples of input history that the model needs: give a longer \
         record, or state the input before it (at rest)"
    )]
    NoHistory {
        /// Samples of history needed.
        history: usize,
    },
    /// The sizes of the changes of the input add nothing to the input itself.
    #[error(
        "up and down strokes cannot be separated in this record: record a reference that moves \
         both ways several times, with holds of different lengths"
    )]
    OneDirection,
    /// There is no step response to describe.
    #[error(
        "the response does not rise clearly to a final value: no model of low order can be fitted, \
         so look at the step response first"
    )]
    NoResponse,
    /// Part of the response is not known, for this reason.
    #[error(
        "{0}: no model of low order can be fitted, so record a reference with steps that are held until the servo rests"
    )]
    ResponseOpen(&'static str),
    /// The record does not determine the final value of the response.
    #[error(
        "the linear model does not determine the gain, as where friction or a dead band holds much of each stroke: no model of low order can be fitted, so record larger \
         steps that are held until the servo rests, or take the servo model"
    )]
    Unexcited,
    /// The response is known in a band alone, and what it was estimated from is not at hand.
    #[error(
        "the recording determines the response in a band of frequencies alone, and a model of low order of that is fitted to the samples: identify the recording \
         again, which fits one or says why there is none"
    )]
    OfBandAlone,
    /// More controllers than a servo model can have.
    #[error(
        "the runs have {controllers} controllers, and a servo model takes {most}: fit the runs of fewer at a time"
    )]
    TooManyControllers {
        /// Controllers of the runs.
        controllers: usize,
        /// Controllers that a model takes.
        most: usize,
    },
    /// The samples are too far apart for a servo model.
    #[error(
        "its samples are {period_s} s apart, and the motion of a servo is over between two of them: a servo model needs samples \
         every {longest_s} s or closer; state the period in seconds if that is not what it is"
    )]
    PeriodTooLong {
        /// The sample period \[s\].
        period_s: f64,
        /// The longest that a servo model takes \[s\].
        longest_s: f64,
    },
    /// Moments lack lags for the settling time and noise order that are asked for.
    #[error(
        "the moments have {lags} lags of the input and need {needed}: collect them with more lags, or state a \
         shorter settling time"
    )]
    TooFewLags {
        /// Lags of the moments.
        lags: usize,
        /// Lags needed.
        needed: usize,
    },
}

impl Error {
    /// A settling time \[samples\] that a record of so many `samples` determines: about three of them for each parameter, where a model asks for
    /// two. `None` of a record that is too short for any.
    #[must_use]
    pub fn settling_for(samples: usize) -> Option<usize> {
        // With the history of the noise, fewer than these do not leave the two.
        (samples >= 40).then_some(samples / 5)
    }

    /// The input excites a gain at the most, where `asked` frequencies are needed.
    pub(crate) fn nothing_excited(asked: usize) -> Self {
        Self::NotExcited {
            asked,
            excited: 1,
            highest_hz: 0.0,
        }
    }
}
