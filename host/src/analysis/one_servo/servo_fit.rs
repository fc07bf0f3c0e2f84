//! The servo model beside the linear one: when it is wanted, its fit, and its prediction of a stretch that it has not seen.

use super::identified::{explained_by_pulses, identified};
use super::waits;
use crate::analysis::command_times::commands_at_pulses::{is_linear_in_force, reason_in_force};
use crate::data::dataset::Dataset;
use crate::data::held_out::{HeldOut, HeldOutPrediction};
use crate::data::model_file::ServoModelDocument;
use crate::data::pulse_end::pulses;
use crate::data::units::radians_of;
use crate::presentation::summary::sixty_degrees;
use servoid_identification::comparison::{Comparison, Verdict};
use servoid_identification::diagnostics::TakenOut;
use servoid_identification::nonlinear::{Hysteresis, missed_rests};
use servoid_identification::results::{Model, Precedence, Reason, Validation};
use servoid_identification::servo_model::{
    self, ServoModel, ServoModelOptions, Watch, no_prediction,
};
use servoid_identification::thresholds::RESIDUAL_SIGNIFICANCE;
use servoid_identification::{Error, Identification, Options, Record, Run, identify};

/// When a servo is looked for as a machine, which may take minutes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ServoModelSearch {
    /// In each recording.
    Always,
    /// Where a linear model does not suffice.
    #[default]
    WhereNeeded,
    /// In none.
    Never,
}

impl ServoModelSearch {
    /// `Some` of what was asked for.
    #[must_use]
    pub fn asked(asked: Option<bool>) -> Self {
        match asked {
            Some(true) => Self::Always,
            Some(false) => Self::Never,
            None => Self::WhereNeeded,
        }
    }
}

/// Whether a servo model is looked for: on request, and where the servo is not linear, may not be, or the result has no bounds,
/// which leaves its user with little. Answers to commands that scatter, beside errors that no noise of the highest order is like, are those of commands that wait, or of a servo that is not linear. Where the input follows the output the motion is that of a loop, and where the output leads times count from nothing:
/// a model of such a recording would be none of the servo.
pub fn is_wanted(asked: ServoModelSearch, found: &Identification) -> bool {
    let withdrawn = found.model.level().withdrawn();
    let whiteness = found.model.residuals.whiteness_p;
    let is_doubtful =
        found.explanation.answers_scatter() && whiteness.is_some_and(|p| p < RESIDUAL_SIGNIFICANCE);
    let suffices = found.model.linear && withdrawn.is_none() && !is_doubtful;
    help(asked, suffices, withdrawn)
}

/// Whether servo models of both sides are compared: on request, where the step responses decide nothing, and where rests differ, which does not show what is worn.
pub fn are_compared(asked: ServoModelSearch, found: &Comparison) -> bool {
    let rests_differ = found.rests_apart.is_some_and(|rests| rests.differ());
    let decided = found.verdict != Verdict::Undecided && !rests_differ;
    help(asked, decided, found.bounds.withdrawn())
}

/// Whether servo models help: on request, and where a linear model does not suffice, but not where the command is not what moved the servo.
fn help(asked: ServoModelSearch, suffices: bool, withdrawn: Option<Reason>) -> bool {
    match asked {
        ServoModelSearch::Always => true,
        ServoModelSearch::WhereNeeded => !suffices && withdrawn.is_none_or(Reason::leaves_a_servo),
        ServoModelSearch::Never => false,
    }
}

/// What was found of the servo as a machine.
#[derive(Debug)]
pub struct FoundServo {
    /// The model, or the reason why there is none.
    pub model: Result<ServoModelDocument, String>,
    /// How it and the linear model predict a stretch, both identified without it.
    pub held_out: Option<HeldOutPrediction>,
}

/// Finds the servo behind `data`, and puts the `linear` model of the same data beside it; with `held_out`, also its prediction of a
/// stretch, at the same time. Glitches that were taken out of the data for the linear model are left out here, too. Where neither model
/// predicts the data, that becomes the first advice of the linear one.
pub fn find(
    data: &Dataset,
    linear: &mut Identification,
    options: &Options,
    held_out: bool,
    search: &dyn Watch,
) -> FoundServo {
    let data = &without_spikes(data, linear);
    let linear = &mut linear.model;
    let (found, at_pulses) = std::thread::scope(|threads| {
        let predicting =
            held_out.then(|| threads.spawn(|| predict(&HeldOut::of(data)?, options, search)));
        let fitted = fit(data, Linear::Beside(linear), options.level, search);
        let predicted = predicting.and_then(|thread| thread.join().ok().flatten());
        let (model, at_pulses) = match fitted {
            Ok(fitted) => (Ok(fitted.servo), fitted.at_pulses),
            Err(reason) => (Err(reason), None),
        };
        let found = FoundServo {
            held_out: predicted.filter(|_| model.is_ok()),
            model,
        };
        (found, at_pulses)
    });
    let servo = found.model.as_ref().ok();
    let doubt = servo.and_then(|servo| no_prediction(&data.record, linear, &servo.model));
    // Exchanged columns and loops are its causes: they come before it.
    let causes = linear
        .advice
        .iter()
        .take_while(|item| item.precedence() == Precedence::InPlaceOfTheAnswer);
    let at = causes.count();
    linear.advice.splice(at..at, doubt);
    if let Some((servo, at_pulses)) = servo.zip(at_pulses) {
        let is_linear = is_linear_in_force(&at_pulses, options);
        explained_by_pulses(linear, &servo.model, is_linear);
    }
    found
}

/// Data without the glitches that were taken out of them for the linear model.
fn without_spikes<'a>(data: &Dataset<'a>, linear: &Identification) -> Dataset<'a> {
    Dataset {
        record: TakenOut::without_spikes(&linear.explanation.taken_out, &data.record),
        controllers: data.controllers.clone(),
        about: data.about.clone(),
    }
}

/// Finds the servos of two sides at the same time, each as [`find`] does for one, or the reason why one of them is not found.
pub fn find_both(
    [a, b]: [&Dataset; 2],
    [name_a, name_b]: [&str; 2],
    options: &Options,
    search: &dyn Watch,
) -> Result<[ServoModelDocument; 2], String> {
    let of = |data: &Dataset, name: &str| {
        let linear = identified(data, name, options).map_err(|error| format!("{error:#}"))?;
        let data = without_spikes(data, &linear);
        let linear = Linear::OfRecord(&linear.model);
        Ok(fit(&data, linear, options.level, search)?.servo)
    };
    std::thread::scope(|threads| {
        let first = threads.spawn(|| of(a, name_a));
        let second = of(b, name_b);
        let stopped = |_| Err("the search was stopped".to_owned());
        Ok([first.join().unwrap_or_else(stopped)?, second?])
    })
}

/// What a linear model of the same data is for.
#[derive(Clone, Copy)]
enum Linear<'a> {
    /// It says where the servo stops, and what speaks against the record.
    OfRecord(&'a Model),
    /// It stands beside the servo model, too.
    Beside(&'a Model),
}

impl<'a> Linear<'a> {
    fn model(self) -> &'a Model {
        match self {
            Self::OfRecord(model) | Self::Beside(model) => model,
        }
    }
}

/// A servo model that was found.
struct Fitted<'r> {
    servo: ServoModelDocument,
    /// The record with its commands at their pulses, where they waited for them.
    at_pulses: Option<Record<'r>>,
}

/// The servo model, or the reason why there is none.
fn fit<'r>(
    data: &Dataset<'r>,
    linear: Linear<'_>,
    level: f64,
    search: &dyn Watch,
) -> Result<Fitted<'r>, String> {
    let names = data.controllers.names();
    let units = data.about.units();
    let options = ServoModelOptions {
        controllers: data
            .controllers
            .among(&names)
            .map_err(|error| error.to_string())?,
        level,
        radians_per_command: radians_of(units.input),
        radians_per_output: radians_of(units.output),
        against: (linear.model().level().withdrawn()).filter(|reason| reason.is_of_the_record()),
        pulses: pulses(
            data.about.units(),
            data.about.recorded.map(|found| found.commands),
            data.about.us_per_degree,
        ),
        stops_at: linear.model().stops.clone(),
    };
    let found = |record: &Record, against: Option<Reason>| {
        let options = ServoModelOptions {
            against,
            ..options.clone()
        };
        match linear {
            Linear::Beside(linear) => servo_model::fit_beside(record, linear, &options, search),
            Linear::OfRecord(_) => servo_model::fit_watched(record, &options, search),
        }
    };
    let model = found(&data.record, options.against).map_err(|error| error.to_string())?;
    let (model, record) = behind_pulses(data, model, &options, found);
    let model = model.with_delay_error(data.about.sensor_delay_uncertainty_s);
    let (hysteresis, apart) = Hysteresis::with_rests_apart(&data.record, linear.model(), level);
    let simulated = model.simulate(&record, &options.controllers);
    let most_apart = apart.and_then(|apart| apart.value).unwrap_or_default();
    let model = ServoModel {
        missed_rests: missed_rests(&record, &simulated, linear.model(), most_apart),
        ..model
    };
    let model = model.with_rests(
        (hysteresis.found == Some(true)).then_some(hysteresis.size),
        apart.filter(|_| options.against.is_none_or(Reason::leaves_rests)),
    );
    let stroke = sixty_degrees(data.about.units());
    let at_pulses = model.fit.waits_for_pulses.is_some();
    let servo = ServoModelDocument {
        stroke_of_60_degrees_s: stroke.and_then(|size| model.stroke_times_s(size)),
        is_of_rows: data.about.commands_may_wait() && !at_pulses,
        model,
        controller_names: names,
        polled: data.about.polled,
        // A delay behind pulses has no wait in it.
        common_wait_s: match at_pulses {
            true => 0.0,
            false => data.about.common_wait_s,
        },
    };
    Ok(Fitted {
        servo,
        at_pulses: at_pulses.then_some(record),
    })
}

/// Times that pulses are looked for anew with the servo behind them, until one leaves more than this share of the errors of the one before.
const ROUNDS: usize = 3;
const LESS: f64 = 0.99;

/// The servo behind the pulses that the commands of `data` waited for, with its record, where the errors of the servo of the rows show that they did; else that `of_rows`. `found` finds the servo of a
/// record, and what speaks against it.
fn behind_pulses<'r>(
    data: &Dataset<'r>,
    of_rows: ServoModel,
    options: &ServoModelOptions,
    found: impl Fn(&Record, Option<Reason>) -> Result<ServoModel, Error>,
) -> (ServoModel, Record<'r>) {
    let controllers = &options.controllers;
    let servo_at = |pulses: waits::AtPulses<'r>| {
        // A smooth command that waits looks as if it followed the output.
        let against = match options.against {
            Some(Reason::InputFollowsOutput) => {
                reason_in_force(&pulses.record).filter(|reason| reason.is_of_the_record())
            }
            against => against,
        };
        let model = found(&pulses.record, against).ok()?;
        Some((model.behind_pulses(pulses.waits), pulses.record))
    };
    let better = || {
        let mut best = servo_at(waits::at_pulses(data, &of_rows, controllers)?)?;
        for _ in 0..ROUNDS {
            // The pulses were found with a servo that had waits in its errors.
            let frame_s = best.0.fit.waits_for_pulses?.frame_s;
            let again = waits::closest(&data.record, &best.0, controllers, frame_s);
            match again.and_then(servo_at) {
                Some(next) if next.0.fit.rmse < best.0.fit.rmse => {
                    let is_last = next.0.fit.rmse > LESS * best.0.fit.rmse;
                    best = next;
                    if is_last {
                        break;
                    }
                }
                _ => break,
            }
        }
        Some(best)
    };
    // Of a command that moves on with every row, any clock takes some errors away: pulses leave noise.
    let is_sure =
        |model: &ServoModel| !data.about.moving_command || model.covariance.valid().is_some();
    let better = better().filter(|(model, _)| waits::were_waits(model, &of_rows) && is_sure(model));
    better.unwrap_or_else(|| (of_rows, data.record.clone()))
}

/// The run, with the command before it that would have held the linear servo at the first output, where nothing else is
/// stated: the servo model begins there too, and a linear model that waits for its history would know nothing of a short run.
fn from_rest<'a>(run: &Run<'a>, linear: &Model) -> Run<'a> {
    let held_by = |output: f64, gain: f64| (output - linear.offset) / gain;
    let before = run.output().first().zip(linear.step.value.last());
    match before.map(|(output, gain)| held_by(*output, *gain)) {
        Some(before) if run.input_at_rest().is_none() && before.is_finite() => {
            run.clone().with_input_at_rest(before)
        }
        _ => run.clone(),
    }
}

/// Both models of the rest, on the stretch. They are simulated over the whole run from its input, so the stretch begins as
/// they arrive there.
fn predict(held_out: &HeldOut, options: &Options, search: &dyn Watch) -> Option<HeldOutPrediction> {
    let linear = identify(&held_out.rest.record, options).ok()?;
    let of_record = Linear::OfRecord(&linear);
    let fitted = fit(&held_out.rest, of_record, options.level, search);
    let servo = fitted.ok()?.servo;
    let record = &held_out.rest.record;
    let whole = record.try_with_runs(vec![held_out.run.clone()]).ok()?;
    let names = &servo.controller_names;
    let controller = held_out
        .controller
        .and_then(|name| names.iter().position(|known| *known == name));
    let controllers: Vec<usize> = controller.into_iter().collect();
    let waits = servo.model.fit.waits_for_pulses;
    let at_pulses =
        waits.and_then(|waits| waits::closest(&whole, &servo.model, &controllers, waits.frame_s));
    let behind_pulses = at_pulses.map_or_else(|| whole.clone(), |found| found.record);
    let by_servo = servo.model.simulate(&behind_pulses, &controllers).pop()?;
    let by_linear = linear.simulate(&from_rest(&held_out.run, &linear));
    let stretch = |values: &[f64]| Some(values.get(held_out.samples.clone())?.to_vec());
    let measured = stretch(held_out.run.output())?;
    let (by_servo, by_linear) = (stretch(&by_servo)?, stretch(&by_linear)?);
    // Both are judged on the same samples: where an input is missing, each knows nothing for a time of its own.
    let fit_percent = |of: &[f64], other: &[f64]| {
        let both = of.iter().zip(other);
        let both = both.map(|(of, other)| if other.is_nan() { f64::NAN } else { *of });
        Validation::of_pairs(measured.iter().copied().zip(both)).map(|found| found.fit_percent)
    };
    Some(HeldOutPrediction {
        stretch: held_out.words,
        period_s: record.sample_period_s(),
        fits_percent: [
            fit_percent(&by_linear, &by_servo)?,
            fit_percent(&by_servo, &by_linear)?,
        ],
        measured,
        by_linear,
        by_servo,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::dataset::{ArrayRun, Arrays, of_arrays};
    use servoid_test_support::plants::{normal, random};

    #[test]
    fn a_servo_is_looked_for_where_it_helps_and_not_behind_a_closed_loop() {
        let help = |suffices, withdrawn| {
            [None, Some(true), Some(false)]
                .map(|asked| help(ServoModelSearch::asked(asked), suffices, withdrawn))
        };
        assert_eq!(help(true, None), [false, true, false]);
        assert_eq!(help(false, None), [true, true, false]);
        let open = Some(Reason::ErrorsNotNoise);
        assert_eq!(help(false, open), [true, true, false]);
        for loop_or_lead in [Reason::InputFollowsOutput, Reason::EarlyMotion] {
            assert_eq!(help(false, Some(loop_or_lead)), [false, true, false]);
        }
    }

    /// Strokes to and fro of a springy servo that reaches the limit of its drive, some of which end while it still swings: linear by each test of its errors.
    fn springy() -> Dataset<'static> {
        const ROW_S: f64 = 0.002;
        const FINE: usize = 20;
        let mut random = random(1);
        let (mut input, mut output) = (Vec::new(), Vec::new());
        let (mut x, mut v) = (0.0f64, 0.0f64);
        let mut level = 13.0;
        while input.len() < 13_500 {
            let rows = (100.0 + 150.0 * normal(&mut random).abs().min(1.0)) as usize;
            for _ in 0..rows {
                input.push(level);
                output.push(x + 0.047 * normal(&mut random));
                for _ in 0..FINE {
                    let drive = (3536.0 * (level - x)).clamp(-15_300.0, 15_300.0);
                    v += (drive - 29.4 * v) * ROW_S / FINE as f64;
                    x += v * ROW_S / FINE as f64;
                }
            }
            level = -level;
        }
        let arrays = Arrays {
            period_s: ROW_S,
            runs: vec![ArrayRun {
                input: input.into(),
                output: output.into(),
                at_rest: None,
            }],
            ..Arrays::default()
        };
        of_arrays(arrays).unwrap()
    }

    #[test]
    fn a_servo_whose_answers_scatter_in_errors_that_are_no_noise_is_looked_for() {
        let data = springy();
        let found = identified(&data, "springy", &Options::default()).unwrap();
        let model = &found.model;
        assert!(model.linear && model.level().valid().is_some());
        assert!(is_wanted(ServoModelSearch::WhereNeeded, &found));
        assert!(!is_wanted(ServoModelSearch::Never, &found));
    }
}
