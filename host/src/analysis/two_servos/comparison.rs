//! The comparison of two sides, with what the commands add to that of the library: servo models, and advice on the files.

use super::delay_errors;
use super::scale_errors;
use super::servo_comparison::compared_servos;
use crate::analysis::one_servo::identified::{by_pulses, identified};
use crate::analysis::one_servo::servo_fit::{self, ServoModelSearch};
use crate::data::dataset::Dataset;
use crate::data::fingerprint;
use crate::data::mixed_units::advice_on_units;
use crate::data::model_file::{ModelFile, ServoModelDocument};
use crate::data::model_metadata::{ModelMetadata, UnitsDiffer};
use crate::presentation::summary;
use anyhow::{Context, Result, anyhow, bail};
use serde::Serialize;
use servoid_identification::comparison::{
    Comparison, ComparisonOptions, SCHEMA, SIDES, ServoModelComparison, Subject, Verdict, compare,
    compare_models,
};
use servoid_identification::results::{Advice, Model, Reason, six_digits};
use servoid_identification::servo_model::Watch;
use servoid_identification::{Error, Identification};

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
    let sides = [&metadata[0], &metadata[1]];
    let own = [a, b].map(|side| identified(side, "", &options.identification).ok());
    let options = ComparisonOptions {
        input_unit: a.about.input_unit_with(&b.about),
        output_unit: a.about.output_unit_with(&b.about),
        withheld: own.each_ref().map(|side| side.as_ref().and_then(fault)),
        ..allowed_for_sensors(sides, options)
    };
    let found = compare(&a.record, &b.record, &options);
    let mut found = found
        .map_err(without_options)
        .with_context(|| names.join(" against "))?;
    let [prints_a, prints_b] = [a, b].map(|side| fingerprint::of(&side.record));
    let same = fingerprint::advice_on_sides(&prints_a, &prints_b);
    let overlap = || fingerprint::advice_on_overlap(&a.record, &b.record);
    say_same_data(&mut found, same.or_else(overlap));
    found.advice.splice(0..0, times_of_commands(&own, names));
    if a.about.units().output.is_none() {
        let advice = advice_on_units(names, [a.record.runs(), b.record.runs()]);
        found.advice.splice(0..0, advice);
    }
    if let Some(conditions) = a.about.other_condition(&b.about) {
        if let Some(remedy) = b.about.load_of_condition() {
            Advice::name_load(&mut found.advice, None, &remedy);
        }
        found.advice.push(conditions);
    }
    found.advice.extend(a.about.other_calibration(&b.about));
    found.advice.extend(advice_on_sensors(sides, &options));
    say_waits(&mut found, sides);
    Ok(found)
}

/// That waits for pulses may be a part of a difference, or all of it.
fn say_waits(found: &mut Comparison, sides: [&ModelMetadata; 2]) {
    let is_of_runs = found.of == Subject::Runs && found.verdict == Verdict::Different;
    if is_of_runs || found.may_be_waits {
        (found.advice).splice(0..0, delay_errors::advice_on_waits(sides));
    }
}

/// That commands of a side waited for pulses, by its servo model, where the linear models do not say it.
fn say_pulses(advice: &mut Vec<Advice>, servos: &[ServoModelDocument; 2]) {
    if advice.iter().any(Advice::is_of_waits) {
        return;
    }
    let of_side = |(servo, side): (&ServoModelDocument, &str)| {
        let waits = servo.model.fit.waits_for_pulses?;
        Some(by_pulses(waits).said_of(side))
    };
    let found: Vec<Advice> = servos.iter().zip(SIDES).filter_map(of_side).collect();
    advice.splice(0..0, found);
}

/// That commands of a side change between the rows, or wait for pulses, by its model alone, which is linear beside that: the models of a comparison know no frames.
fn times_of_commands(own: &[Option<Identification>; 2], names: [&str; 2]) -> Vec<Advice> {
    let of_side = |(found, name): (&Option<Identification>, &str)| {
        let model = &found.as_ref()?.model;
        let is_of_commands = |item: &&Advice| {
            let is_of_waits = model.linear && item.is_of_waits();
            is_of_waits || item.is_of_commands_between_rows()
        };
        let mut found = model.advice.iter().find(is_of_commands)?.clone();
        let waits = match found.is_of_waits() {
            true => " Where a servo is said not to be linear here, that may be these waits.",
            false => "",
        };
        found.finding = format!("{name}: {}{waits}", found.finding);
        Some(found)
    };
    own.iter().zip(names).filter_map(of_side).collect()
}

/// What is wrong with the data of one side by itself, be it by what its files say: then a comparison has no bounds, either.
fn fault(found: &Identification) -> Option<Reason> {
    let reason = found.model.bounds.withdrawn();
    reason.filter(|reason| reason.is_of_the_record())
}

/// The options of a comparison that allows for what the sensors of the sides may be off from each other.
fn allowed_for_sensors(
    sides: [&ModelMetadata; 2],
    options: ComparisonOptions,
) -> ComparisonOptions {
    ComparisonOptions {
        scale_sd: scale_errors::ratio_sd(sides),
        ..delay_errors::allowed_for(sides, options)
    }
}

/// That they may be off.
fn advice_on_sensors(
    sides: [&ModelMetadata; 2],
    options: &ComparisonOptions,
) -> impl Iterator<Item = Advice> {
    let of_scales = scale_errors::advice(sides, options.identification.level);
    delay_errors::advice(sides).into_iter().chain(of_scales)
}

/// The error of a comparison, whose structure is always chosen from the data: nobody can state a settling time.
fn without_options(error: Error) -> anyhow::Error {
    match error {
        Error::TooShortForAuto {
            samples, needed, ..
        } => anyhow!(
            "a comparison needs at least {needed} samples of each side in one piece, and one side has {samples} in all: record longer and \
             without gaps"
        ),
        other => with_machines(other),
    }
}

/// Whether the positions of two sides have one unit.
fn are_comparable([a, b]: [&ModelMetadata; 2]) -> bool {
    a.same_units("", b, "").is_ok() || a.other_command(b).is_some()
}

/// Two sides with different times between samples.
#[derive(Debug, thiserror::Error)]
#[error(
    "{}, and step responses are compared sample by sample: record both at one rate of pulses ('servoid init --pulse-rate'), or both with \
     the same time between rows, which --period states where the columns of time are not that exact; or compare the servos as machines, whose models are continuous in time: recordings with \
     'servoid compare --servo-model', models as 'servoid identify --servo-model' writes them",
    self.in_words()
)]
struct PeriodsDiffer(f64, f64);

impl PeriodsDiffer {
    /// Whether clocks may make the difference: half a percent is what a ceramic resonator may be off, on either side.
    fn may_be_of_clocks(&self) -> bool {
        (self.0 / self.1).ln().abs() < 0.01
    }

    fn in_words(&self) -> String {
        let [a, b] = [self.0, self.1].map(|period_s| six_digits(1e3 * period_s));
        format!("one side has samples every {a} ms and the other every {b} ms")
    }
}

/// An error of a comparison of step responses, which says where a comparison of the servos as machines is left.
fn with_machines(error: Error) -> anyhow::Error {
    match error {
        Error::PeriodMismatch { expected, found } => PeriodsDiffer(expected, found).into(),
        other => other.into(),
    }
}

/// What is said of the step responses of two sides.
#[derive(Debug, Serialize)]
#[serde(untagged)]
pub enum StepResponses {
    /// They are compared.
    Compared(Box<Comparison>),
    /// They cannot be compared, and the servos as machines can.
    NotCompared(NotCompared),
}

/// What the document of a comparison has where step responses are not compared.
#[derive(Debug, Serialize)]
pub struct NotCompared {
    schema: u32,
    verdict: Verdict,
    of: Subject,
    margin_percent: f64,
    bounds: (),
    withdrawn: (),
    summary: String,
    advice: Vec<Advice>,
}

impl StepResponses {
    /// The comparison that was `found`. Sides with different times between samples, or commands in different units, are no error where the servos
    /// are compared as `machines`.
    fn of(found: Result<Comparison>, machines: bool, margin_percent: f64) -> Result<Self> {
        let error = match found {
            Ok(found) => return Ok(Self::Compared(Box::new(found))),
            Err(error) => error,
        };
        let periods = error.downcast_ref::<PeriodsDiffer>();
        let units = error.downcast_ref::<UnitsDiffer>();
        let because = (periods.map(PeriodsDiffer::in_words))
            .or_else(|| units.map(UnitsDiffer::in_words))
            .filter(|_| machines);
        let remedy = match periods {
            Some(periods) if periods.may_be_of_clocks() => {
                " Where rows were meant to be equally far apart in both, identify both sides with that as --period."
            }
            Some(_) => {
                " Rows as far apart on both sides make them comparable, such as every second one of the quicker side."
            }
            None => " With the command of one side converted to the unit of the other they are.",
        };
        let Some(because) = because else {
            return Err(error);
        };
        Ok(Self::NotCompared(NotCompared {
            schema: SCHEMA,
            verdict: Verdict::Undecided,
            of: Subject::Runs,
            margin_percent,
            bounds: (),
            withdrawn: (),
            summary: format!("The step responses are not compared, because {because}.{remedy}"),
            advice: Vec::new(),
        }))
    }

    fn compared(&self) -> Option<&Comparison> {
        match self {
            Self::Compared(found) => Some(found),
            Self::NotCompared(_) => None,
        }
    }

    fn advice(&mut self) -> &mut Vec<Advice> {
        match self {
            Self::Compared(found) => &mut found.advice,
            Self::NotCompared(found) => &mut found.advice,
        }
    }
}

/// Puts a finding that both sides have the same data, which makes all others worthless, before them and before the verdict.
fn say_same_data(found: &mut Comparison, finding: Option<Advice>) {
    if let Some(advice) = &finding {
        found.same_data = true;
        found.summary = format!("{} {}", advice.finding, found.summary);
    }
    found.advice.splice(0..0, finding);
}

/// Compares two models by their step responses, with what their files say of the recordings.
///
/// # Errors
/// Different units, or that of the comparison, behind the names.
pub fn compared_models(
    models: [&Model; 2],
    metadata: [&ModelMetadata; 2],
    names: [&str; 2],
    options: ComparisonOptions,
) -> Result<Comparison> {
    let [a, b] = metadata;
    a.same_units(names[0], b, names[1])?;
    let unit = a.units().input.filter(|unit| b.units().input == Some(unit));
    let options = ComparisonOptions {
        strokes_of_models: metadata.map(|side| side.only_stroke),
        input_unit: unit.unwrap_or_default().to_owned(),
        ..allowed_for_sensors(metadata, options)
    };
    let found = compare_models(models[0], models[1], &options).map_err(with_machines);
    let mut found = found.with_context(|| names.join(" against "))?;
    found.advice.extend(advice_on_sensors(metadata, &options));
    say_waits(&mut found, metadata);
    Ok(found)
}

/// The comparison as its document has it.
#[derive(Debug, Serialize)]
pub struct Compared {
    /// The step responses and what follows from them.
    #[serde(flatten)]
    pub found: StepResponses,
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
    /// Compares recordings, and servo models as `search` says; `watch` begins the search for them. Where it asks for them always, the sides may have different
    /// times between samples.
    ///
    /// # Errors
    /// As [`compared`].
    pub fn recordings<W: Watch>(
        [a, b]: [&Dataset; 2],
        names: [&str; 2],
        options: ComparisonOptions,
        search: ServoModelSearch,
        watch: impl FnOnce() -> W,
    ) -> Result<Self> {
        let identification = options.identification;
        let margin_percent = options.margin_percent;
        let found = compared([a, b], names, options);
        let metadata = [a, b].map(|side| ModelMetadata::from(&side.about));
        let sides = [&metadata[0], &metadata[1]];
        let machines = search == ServoModelSearch::Always && are_comparable(sides);
        let mut found = StepResponses::of(found, machines, margin_percent)?;
        let wanted = |found| servo_fit::are_compared(search, found);
        let servos = (found.compared().map_or(machines, wanted))
            .then(|| servo_fit::find_both([a, b], names, &identification, &watch()));
        if let Some(Ok(servos)) = &servos {
            say_pulses(found.advice(), servos);
        }
        let is_of_runs = (found.compared())
            .is_some_and(|found| found.of == Subject::Runs && found.verdict == Verdict::Different);
        if is_of_runs && !found.advice().iter().any(Advice::is_of_waits) {
            (found.advice()).extend(delay_errors::advice_on_chance(sides));
        }
        let (servo_model, no_servo_model) = match servos {
            Some(Ok([a, b])) => (Some(compared_servos([&a.model, &b.model], sides)), None),
            Some(Err(reason)) => (None, Some(reason)),
            None => (None, None),
        };
        for (side, data) in SIDES.into_iter().zip([a, b]) {
            let of_files = data.about.advice.iter();
            (found.advice()).extend(of_files.map(|found| found.said_of(side)));
        }
        Ok(Self {
            found,
            servo_model,
            no_servo_model,
            metadata: ModelMetadata::from(&a.about),
        })
    }

    /// Compares models; a search for servo models always demands that both have one, and one that is never leaves them out.
    ///
    /// # Errors
    /// Different units, linear models alone that are not of one sample period, and a servo model that is missing.
    pub fn models(
        [a, b]: [&ModelFile; 2],
        names: [&str; 2],
        options: &ComparisonOptions,
        search: ServoModelSearch,
    ) -> Result<Self> {
        let metadata = [&a.metadata, &b.metadata];
        let found = compared_models([&a.model, &b.model], metadata, names, options.clone());
        let servos = [a.servo_model()?, b.servo_model()?];
        for (name, servo) in names.iter().zip(&servos) {
            if search == ServoModelSearch::Always && servo.is_none() {
                bail!("{name} has no servo model: identify its recording with --servo-model");
            }
        }
        let [of_a, of_b] = servos;
        let both = of_a.zip(of_b).filter(|_| search != ServoModelSearch::Never);
        let machines = both.is_some() && are_comparable(metadata);
        let mut found = StepResponses::of(found, machines, options.margin_percent)?;
        if let StepResponses::Compared(found) = &mut found {
            let same = fingerprint::advice_on_sides(&a.fingerprints, &b.fingerprints);
            say_same_data(found, same);
        }
        Ok(Self {
            found,
            servo_model: both.map(|(a, b)| compared_servos([&a.model, &b.model], metadata)),
            no_servo_model: None,
            metadata: a.metadata.clone(),
        })
    }

    /// Whether the servos as machines would say more, and were not looked for.
    #[must_use]
    pub fn leaves_machines_open(&self) -> bool {
        let is_open = self.servo_model.is_none() && self.no_servo_model.is_none();
        self.found.compared().is_some_and(|found| {
            let motions = found.motions.iter().flat_map(|both| [both.a, both.b]);
            let are_determined = !motions.into_iter().any(|of| of.is_between_two_levels());
            is_open && are_determined && found.advice.iter().any(Advice::is_of_linearity)
        })
    }

    /// The comparison as text.
    #[must_use]
    pub fn as_text(&self, names: [&str; 2]) -> String {
        let units = self.metadata.units();
        let letters = format!("A  {}\nB  {}\n\n", names[0], names[1]);
        let mut text = match &self.found {
            StepResponses::Compared(found) => {
                summary::of_comparison(found, self.servo_model.as_ref(), units)
            }
            StepResponses::NotCompared(found) => summary::wrapped(&found.summary, 0) + "\n",
        };
        if let Some(servos) = &self.servo_model {
            let responses = self.found.compared();
            let sentence = summary::sentence_on_servo_models("A", "B", servos, responses, units);
            let sentence = summary::wrapped(&sentence, 0);
            let table = summary::of_servo_models(names, servos, units);
            text = match servos.answer_before(self.found.compared()) {
                true => format!("{sentence}\n\n{text}{table}"),
                false => format!("{text}\n{sentence}\n{table}"),
            };
        }
        text.extend(
            self.no_servo_model
                .iter()
                .map(|reason| format!("\nno servo models: {reason}\n")),
        );
        letters + &text
    }
}
