//! A model against recordings that it was not identified from.

use super::error_by_octave::{self, OctaveError, error_by_octave};
use super::larger_error::{ANOTHER_MOTION, Times, larger_error};
use super::misfit::Misfit;
use super::model_on_recording::ModelOnRecording;
use super::pulses::{self, StatedPulses};
use crate::analysis::one_servo::load_at_rest;
use crate::analysis::recording_advice::sample_period::unlikely_period;
use crate::data::PredictedRun;
use crate::data::dataset::Dataset;
use crate::data::fingerprint;
use crate::data::model_file::ModelFile;
use crate::data::model_metadata::{ModelMetadata, UnitsDiffer, unit_meant};
use crate::data::units::Units;
use crate::presentation::summary::{self, four_digits};
use anyhow::{Context, Result, anyhow};
use serde::Serialize;
use servoid_identification::results::{Advice, Check, Validation, six_digits};
use servoid_identification::servo_model::CommandRange;
use servoid_identification::{Error, Record, Run};

/// The validation as its document has it, with advice on the files.
#[derive(Debug, Serialize)]
pub struct Validated {
    /// That of the linear model; `None` where the servo model alone can be validated.
    #[serde(flatten)]
    pub validation: Option<Validation>,
    /// The same of the servo model, where the file has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub servo_model: Option<Validation>,
    /// The fit of the linear model to the recording that it comes from \[%\].
    pub own_fit_percent: f64,
    /// The same of the servo model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub servo_model_own_fit_percent: Option<f64>,
    /// The pulses that commands are taken to wait for, where their frame was stated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pulses: Option<StatedPulses>,
    /// Motion and errors by octaves of frequency, as far as the runs are long enough to show them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub error_by_octave: Vec<OctaveError>,
    /// What the models predict of each run, with commands at their pulses.
    #[serde(skip)]
    pub predicted: Vec<PredictedRun>,
    /// Whether the recording of the model has its commands at their pulses.
    #[serde(skip)]
    model_has_frame: bool,
    /// That the model comes from these very samples, and what the files ask for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub advice: Vec<Advice>,
}

impl Validated {
    /// Validates the model of `file`, which is called `model`, on the data, which are called `name`. With `frame_ms` commands wait for pulses that
    /// come every so many milliseconds, at the moments with which the model is closest.
    ///
    /// # Errors
    /// Different units, a controller that the model does not know, and data of another sample period or without the history that the
    /// model needs; the servo model needs neither. A frame that no servo has, and one of a recording whose commands stand at their pulses.
    pub fn of(
        file: &ModelFile,
        model: &str,
        data: &Dataset,
        name: &str,
        frame_ms: Option<f64>,
    ) -> Result<Self> {
        let servo = file.servo_model()?;
        let metadata = ModelMetadata::from(&data.about);
        let same_units = file.metadata.same_units(model, &metadata, name);
        same_units.map_err(|error| match is_of_pulses(file, data) {
            true => pulses_by_name(&error),
            false => error.into(),
        })?;
        let recorded_s = data.about.pulse_frame_s;
        let frame_s = frame_ms.map(|frame_ms| pulses::frame_s(frame_ms, recorded_s));
        let held = ModelOnRecording::of(file, servo.as_ref(), data)?;
        let of_model = servo
            .as_ref()
            .and_then(|servo| servo.model.fit.waits_for_pulses);
        let of_model = of_model.filter(|_| data.about.commands_may_wait());
        let held = match (frame_s.transpose()?, of_model) {
            (Some(frame_s), _) => held.at_pulses(frame_s)?,
            (None, Some(waits)) => held.servo_at_pulses(waits.nominal_frame_s())?,
            (None, None) => held,
        };
        // What follows from a wrong time is no finding on the model.
        let doubtful = unlikely_period(data.record.sample_period_s());
        let servo_model = held.of_servo()?;
        let (validation, only_servo) = match held.of_linear().map_err(of_its_own_period) {
            Ok(found) => (Some(found), None),
            Err(error) if servo_model.is_some() => (None, Some(only_servo_model(&error))),
            Err(error) => {
                let named = Err(error).with_context(|| name.to_owned());
                return match doubtful {
                    Some(doubt) => named.context(format!("{} {}", doubt.finding, doubt.remedy)),
                    None => named,
                };
            }
        };
        let of_models = match doubtful {
            Some(doubt) => vec![doubt],
            None => {
                let on_models = on_models(file, data, &held, [&validation, &servo_model]);
                on_models.into_iter().chain(only_servo).collect()
            }
        };
        let own = fingerprint::of(&data.record);
        let own = fingerprint::advice_on_validation(&file.fingerprints, &own);
        let of_load = held.servo.as_ref();
        let of_load = of_load.and_then(|servo| load_at_rest::remedy(servo.model, metadata.units()));
        let mut of_files = data.about.advice.clone();
        if let Some((by_load, remedy)) = of_load {
            Advice::name_load(&mut of_files, Some(by_load), &remedy);
        }
        let predicted = held.predictions(validation.is_some());
        Ok(Self {
            validation,
            servo_model,
            own_fit_percent: file.model.fit.simulation_percent,
            servo_model_own_fit_percent: (held.servo.as_ref())
                .map(|servo| servo.model.fit.simulation_percent),
            error_by_octave: error_by_octave(&predicted),
            pulses: held.pulses,
            model_has_frame: file.metadata.pulse_frame_s.is_some() || of_model.is_some(),
            predicted,
            advice: own.into_iter().chain(of_models).chain(of_files).collect(),
        })
    }

    /// As 'servoid validate' prints it; the position is in `unit`.
    #[must_use]
    pub fn as_text(&self, unit: Option<&str>) -> String {
        let pulses = self.pulses.as_ref().map(|found| {
            let sentence = found.in_words(unit, self.model_has_frame);
            format!("{}\n\n", summary::wrapped(&sentence, 0))
        });
        let own_fits = (self.own_fit_percent, self.servo_model_own_fit_percent);
        let models = (self.validation.as_ref(), self.servo_model.as_ref());
        let fits = summary::of_validation(models.0, models.1, own_fits, unit);
        let octaves = match self.error_by_octave.as_slice() {
            [] => String::new(),
            octaves => format!("\n{}", error_by_octave::as_table(octaves, unit)),
        };
        let findings = summary::findings(&self.advice);
        format!("{}{fits}{octaves}{findings}", pulses.unwrap_or_default())
    }
}

/// What the errors of the models say.
fn on_models(
    file: &ModelFile,
    data: &Dataset,
    held: &ModelOnRecording,
    [of_linear, of_servo]: [&Option<Validation>; 2],
) -> Vec<Advice> {
    let metadata = ModelMetadata::from(&data.about);
    let servo = held.servo.as_ref();
    let found = of_linear.iter().chain(of_servo);
    let best = found.map(|found| found.fit_percent);
    let predicts_nothing = (best.fold(f64::NEG_INFINITY, f64::max) < 0.0).then(|| {
        let commands = servo.and_then(|servo| servo.model.commands);
        predicts_nothing(
            (file.metadata.units(), commands),
            (metadata.units(), range_of_commands(&data.record)),
        )
    });
    let unit = metadata.units().output.unwrap_or_default();
    let times = Times {
        open_s: file.metadata.sensor_delay_uncertainty_s + data.about.sensor_delay_uncertainty_s,
        polled: data.about.polled,
        // That commands are exact may be what was said of the model's own recording.
        frame_is_stated: held.pulses.is_some() || !data.about.is_of_rows(),
        beside_pulses: (held.pulses.as_ref()).map_or(0.0, |pulses| pulses.rms_beside_pulses),
    };
    let is_linear = file.model.linear && servo.is_none_or(|servo| servo.model.is_linear());
    let of_linear = of_linear.as_ref().and_then(|found| {
        let misfit = || {
            let misfit = held.misfit_of_linear();
            Misfit {
                // What is slower in larger strokes is later there, and no delay.
                lag: misfit.lag.filter(|_| is_linear),
                ..misfit
            }
        };
        let errors = [found.rmse, file.model.fit.rmse];
        larger_error("linear", errors, misfit, (unit, times))
    });
    let of_servo = servo.zip(of_servo.as_ref()).and_then(|(servo, found)| {
        let errors = [found.rmse, servo.model.fit.rmse];
        larger_error(
            "servo",
            errors,
            || held.misfit_of_servo(servo),
            (unit, times),
        )
    });
    // Of a recording that may be in other units, nobody should hear that its motion is another one.
    let is_a_cause =
        |found: &Advice| predicts_nothing.is_none() || !found.remedy.contains(ANOTHER_MOTION);
    let causes = of_linear.into_iter().chain(of_servo).filter(is_a_cause);
    let causes: Vec<Advice> = causes.collect();
    predicts_nothing.into_iter().chain(causes).collect()
}

/// The least and the largest command of a record.
fn range_of_commands(record: &Record) -> Option<CommandRange> {
    let inputs = record.runs().iter().flat_map(Run::input).copied();
    let known = inputs.filter(|input| !input.is_nan());
    let range = |input: f64| CommandRange {
        least: input,
        largest: input,
    };
    known.map(range).reduce(|a, b| CommandRange {
        least: a.least.min(b.least),
        largest: a.largest.max(b.largest),
    })
}

/// That a model predicts worse than a mean does, with the commands of both: in other units they have another range.
fn predicts_nothing(
    (model, of_model): (Units<'_>, Option<CommandRange>),
    (here, of_record): (Units<'_>, Option<CommandRange>),
) -> Advice {
    let range = |commands: Option<CommandRange>, goes: &str| {
        commands.map_or_else(String::new, |CommandRange { least, largest }| {
            let [least, largest] = [least, largest].map(four_digits);
            format!(" and {goes} from {least} to {largest}")
        })
    };
    let unit = |unit: Option<&str>| match unit {
        Some(unit) => format!("is in {unit}"),
        None => "has no unit".to_owned(),
    };
    Advice::new(
        Check::Prediction,
        "The model predicts this recording worse than its mean does.",
        0.0,
        0.0,
        format!(
            "Check that the servo, the columns and their units are those of the model. The command of the model {}{}; that of this recording {}{}.",
            unit(model.input),
            range(of_model, "went"),
            unit(here.input),
            range(of_record, "goes"),
        ),
    )
}

/// Why the servo model alone is validated: it is continuous in time and begins with the first samples.
fn only_servo_model(error: &anyhow::Error) -> Advice {
    Advice::new(
        Check::History,
        format!("The servo model alone is validated, because for the linear one {error}."),
        0.0,
        0.0,
        "Nothing needs to be done where the servo model is used.",
    )
}

/// Whether the model's command is a pulse and the data are recordings of servoid, which keep pulses beside degrees.
fn is_of_pulses(file: &ModelFile, data: &Dataset) -> bool {
    let unit = file.metadata.units().input.and_then(unit_meant);
    unit.as_deref() == Some("us") && data.about.us_per_degree.is_some()
}

/// How such recordings are read in the units of such a model.
fn pulses_by_name(error: &UnitsDiffer) -> anyhow::Error {
    anyhow!(
        "{error}, or read its pulses, which a recording of servoid has: add --input pulse_us --output position_deg"
    )
}

/// The error of a validation: why a model is of one sample period.
fn of_its_own_period(error: Error) -> anyhow::Error {
    match error {
        Error::PeriodMismatch { expected, found } => anyhow!(
            "the model has samples every {} ms and the recording has them every {} ms: a response is known at its own samples alone, so \
             record or resample every {} ms, or identify this recording by itself; a servo model is continuous in time, and a model file with one \
             (identify --servo-model) is validated in any rows",
            six_digits(1e3 * expected),
            six_digits(1e3 * found),
            six_digits(1e3 * expected)
        ),
        other => other.into(),
    }
}
