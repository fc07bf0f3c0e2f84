//! The comparison of two sides, with what the commands add to that of the library: servo models, and advice on the files.

use super::servo_fit;
use crate::data::dataset::Dataset;
use crate::data::fingerprint;
use crate::data::mixed_units::advice_on_units;
use crate::data::model_file::ModelFile;
use crate::data::model_metadata::ModelMetadata;
use crate::presentation::summary;
use anyhow::{Context, Result, anyhow, bail};
use serde::Serialize;
use servoid_identification::Error;
use servoid_identification::comparison::{
    Comparison, ComparisonOptions, ServoModelComparison, Verdict, compare, compare_models,
    compare_servo_models,
};
use servoid_identification::results::Advice;
use servoid_identification::servo_model::Watch;

/// Compares the data of two sides. The most important advice comes first: that both have the same samples.
///
/// # Errors
/// Different units, or that of the comparison, behind the names.
pub fn compared(
    [a, b]: [&Dataset; 2],
    names: [&str; 2],
    options: ComparisonOptions,
) -> Result<Comparison> {
    let metadata = [a, b].map(|side| ModelMetadata::from(&side.about));
    metadata[0].same_units(names[0], &metadata[1], names[1])?;
    let options = ComparisonOptions {
        input_unit: a.about.input_unit_with(&b.about),
        output_unit: a.about.output_unit_with(&b.about),
        ..options
    };
    let found = compare(&a.record, &b.record, &options);
    let mut found = found
        .map_err(without_options)
        .with_context(|| names.join(" against "))?;
    let [prints_a, prints_b] = [a, b].map(|side| fingerprint::of(&side.record));
    let same = fingerprint::advice_on_sides(&prints_a, &prints_b);
    let overlap = || fingerprint::advice_on_overlap(&a.record, &b.record);
    say_first(&mut found, same.or_else(overlap));
    if a.about.units().output.is_none() {
        let advice = advice_on_units(names, [a.record.runs(), b.record.runs()]);
        found.advice.splice(0..0, advice);
    }
    found.advice.extend(a.about.other_calibration(&b.about));
    found.advice.extend(a.about.other_sensor_delay(&b.about));
    Ok(found)
}

/// The error of a comparison, whose structure is always chosen from the data: nobody can state a settling time.
fn without_options(error: Error) -> anyhow::Error {
    match error {
        Error::TooShortForAuto { samples, needed } => anyhow!(
            "a comparison needs at least {needed} samples of each side in one piece, and one side has {samples} in all: record longer and \
             without gaps"
        ),
        Error::PeriodMismatch { expected, found } => anyhow!(
            "one side was recorded every {} ms and the other every {} ms, and only what was recorded alike can be compared: record both at one \
             rate of pulses ('servoid init --pulse-rate'), or both with the same time between rows",
            1e3 * expected,
            1e3 * found
        ),
        other => other.into(),
    }
}

/// Puts a finding that makes all others worthless before them, and before the verdict.
fn say_first(found: &mut Comparison, finding: Option<Advice>) {
    if let Some(advice) = &finding {
        found.summary = format!("{} {}", advice.finding, found.summary);
    }
    found.advice.splice(0..0, finding);
}

/// The comparison as its document has it.
#[derive(Debug, Serialize)]
pub struct Compared {
    /// The step responses and what follows from them.
    #[serde(flatten)]
    pub found: Comparison,
    /// The servos as machines, where they are compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub servo_model: Option<ServoModelComparison>,
    /// The reason why servo models are not compared though that was looked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub no_servo_model: Option<String>,
    /// Units of both sides.
    #[serde(skip)]
    metadata: ModelMetadata,
}

impl Compared {
    /// Compares recordings. Servo models are compared if `servo_model` asks for it, and where the step responses have no
    /// bounds; `watch` begins the search for them.
    ///
    /// # Errors
    /// As [`compared`].
    pub fn recordings<W: Watch>(
        [a, b]: [&Dataset; 2],
        names: [&str; 2],
        options: ComparisonOptions,
        servo_model: bool,
        watch: impl FnOnce() -> W,
    ) -> Result<Self> {
        let level = options.identification.level;
        let mut found = compared([a, b], names, options)?;
        let servos = servo_fit::are_compared(servo_model, &found)
            .then(|| servo_fit::find_both([a, b], level, &watch()));
        let (servo_model, no_servo_model) = match servos {
            Some(Ok([a, b])) => (Some(compare_servo_models(&a.model, &b.model)), None),
            Some(Err(reason)) => (None, Some(reason)),
            None => (None, None),
        };
        found.advice.extend(a.about.advice.iter().cloned());
        found.advice.extend(b.about.advice.iter().cloned());
        Ok(Self {
            found,
            servo_model,
            no_servo_model,
            metadata: ModelMetadata::from(&a.about),
        })
    }

    /// Compares models; `servo_model` demands that both have one.
    ///
    /// # Errors
    /// Different units, models that are not of one sample period, and a servo model that is missing.
    pub fn models(
        [a, b]: [&ModelFile; 2],
        names: [&str; 2],
        options: &ComparisonOptions,
        servo_model: bool,
    ) -> Result<Self> {
        a.metadata.same_units(names[0], &b.metadata, names[1])?;
        let found = compare_models(&a.model, &b.model, options);
        let mut found = found.with_context(|| names.join(" against "))?;
        let same = fingerprint::advice_on_sides(&a.fingerprints, &b.fingerprints);
        say_first(&mut found, same);
        let servos = [a.servo_model()?, b.servo_model()?];
        for (name, servo) in names.iter().zip(&servos) {
            if servo_model && servo.is_none() {
                bail!("{name} has no servo model: identify its recording with --servo-model");
            }
        }
        let [of_a, of_b] = servos;
        let both = of_a.zip(of_b);
        Ok(Self {
            found,
            servo_model: both.map(|(a, b)| compare_servo_models(&a.model, &b.model)),
            no_servo_model: None,
            metadata: a.metadata.clone(),
        })
    }

    /// The comparison as text.
    #[must_use]
    pub fn as_text(&self, names: [&str; 2]) -> String {
        let mut text = summary::of_comparison(names[0], names[1], &self.found);
        let units = self.metadata.units();
        if let Some(servos) = &self.servo_model {
            let sentence = summary::sentence_on_servo_models("A", "B", servos, units);
            let sentence = summary::wrapped(&sentence, 0);
            let table = summary::of_servo_models("A", "B", servos, units);
            let decided = self.found.verdict != Verdict::Undecided;
            text = match decided || servos.bounds.valid().is_none() {
                true => format!("{text}\n{sentence}\n{table}"),
                // The answer comes first.
                false => format!("{sentence}\n\n{text}{table}"),
            };
        }
        text.extend(
            self.no_servo_model
                .iter()
                .map(|reason| format!("\nno servo models: {reason}\n")),
        );
        text
    }
}
