//! `servoid plan`

use super::input::no_servo;
use super::output::{Output, typed_path, wrong_usage};
use super::reference_args::ReferenceArgs;
use super::rig_args::{RigFileArgs, RigSource};
use crate::instrument::reference;
use crate::instrument::simulated_servo::{caution, taken_for, with_controller};
use crate::plan::{
    AssumedServo, AssumedServoError, Plan, PlanRequest, figure, is_servo_model, of_plan,
};
use anyhow::{Context, Result};
use clap::Args;
use serde::Serialize;
use servoid_protocol::PulseTrain;
use std::path::{Path, PathBuf};

/// Forecast a run: the width of its band, and the questions that it cannot answer
///
/// Nothing moves. Runs of a simulated servo (--servo, the bench servo by default) are identified as real ones
/// will be, so its speed limit, dead band and friction count. With --model only the linear part of the servo is
/// known: the band then comes from the covariance at the model's noise. A servo that is not linear gives a wider
/// band, most of all with references that change before it has come to rest.
///
/// A servo model needs other runs than the band: more than two levels, strokes large enough to reach the top speed beside small
/// ones, rests at each level, and approaches to it from both sides. Stairs have them all; --servo-model tries it.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  servoid plan                                      the paper's staircase beside the other kinds
  servoid plan --reference prbs --band 0.5          the number of runs for ±0.5 %
  servoid plan --model bench.json --reference stairs --plots plots
  servoid plan --servo mine.json --reference stairs --amplitude 20
  servoid plan --servo linear --noise 0.05 --json")]
pub(super) struct PlanArgs {
    /// Take servo and noise from this model of 'servoid identify'
    #[arg(long, value_name = "MODEL.json", conflicts_with = "servo")]
    model: Option<PathBuf>,
    /// Take servo and noise from a simulated one: bench, aircraft or linear, with options as in --port sim:..., or
    /// a model of 'servoid identify --servo-model'
    #[arg(long, default_value = "bench", value_name = "SERVO|MODEL.json")]
    servo: String,
    /// The controller that drives the servo of --servo, where its model has several
    #[arg(long, value_name = "NAME", conflicts_with = "model", value_parser = super::value_parsers::finite)]
    controller: Option<f64>,
    /// Take white noise of this standard deviation instead (degrees)
    #[arg(long, value_name = "DEGREES", value_parser = super::value_parsers::finite)]
    noise: Option<f64>,
    /// The half width wanted for the whole curve's band, where it is widest (percent of the step): adds the
    /// number of runs and seconds that reach it
    #[arg(long, value_name = "PERCENT", value_parser = super::value_parsers::finite)]
    band: Option<f64>,
    /// Number of runs
    #[arg(long, default_value_t = 1, value_name = "COUNT", value_parser = clap::value_parser!(u16).range(1..=99))]
    repeat: u16,
    /// Confidence level of every bound, as a fraction (0.99) or in percent (99)
    #[arg(long, default_value_t = 0.99, value_parser = super::value_parsers::level)]
    level: f64,
    /// Also identify a simulated run as a machine, which takes some seconds: which quantities of the servo model come out
    /// determined, and what to record for the others. A model as --servo does that by itself
    #[arg(long, conflicts_with = "model")]
    servo_model: bool,
    /// Not an option of this command: it names the one that is meant
    #[arg(long, value_name = "PORT", hide = true)]
    port: Option<String>,
    #[command(flatten)]
    rig: RigFileArgs,
    /// The plan to write, as JSON
    #[arg(long, short, value_name = "PLAN.json")]
    out: Option<PathBuf>,
    /// Folder for a plot of the spectrum and of the step response with the expected band
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    reference: ReferenceArgs,
}

/// A plan, as its document has it.
#[derive(Serialize)]
struct PlanDocument<'a> {
    #[serde(flatten)]
    plan: &'a Plan,
    /// Why the rig will not run this, where its limits do not allow it.
    #[serde(skip_serializing_if = "Option::is_none")]
    beyond_limits: Option<&'a str>,
}

impl PlanArgs {
    pub(super) fn run(self) -> Result<String> {
        if let Some(port) = &self.port {
            let servo = match port.strip_prefix("sim:") {
                Some(servo) => format!("take --servo {}", typed_path(Path::new(servo))),
                None => "leave --port out, and take --model MODEL.json for your servo".to_owned(),
            };
            wrong_usage(format_args!(
                "plan moves no servo and has no port: {servo}; the limits are those of the rig file (--rig)"
            ));
        }
        let positive = |number: &f64| *number > 0.0 && number.is_finite();
        if self.noise.iter().chain(&self.band).any(|n| !positive(n)) {
            wrong_usage("--noise (degrees) and --band (percent) must be above 0");
        }
        let (output, talk) = (self.output, self.output.talk);
        let RigSource { file: rig, path } = self.rig.read(None, talk)?;
        let servo = PathBuf::from(self.servo.split('?').next().unwrap_or_default());
        let table = self.reference.table();
        let read = self.model.iter().chain(&path).chain([&servo]).chain(table);
        output.check_beside(&self.out, read)?;
        let train = rig.train();
        let us_per_degree = rig.servo.us_per_degree;
        let assumed = self.assumed(train, us_per_degree)?;
        let remarks = [caution(&self.servo), taken_for(&self.servo)].into_iter();
        for remark in remarks.flatten().filter(|_| self.model.is_none()) {
            talk.say(remark);
        }
        let servo_model = self.servo_model || self.model.is_none() && is_servo_model(&self.servo);
        let request = PlanRequest {
            reference: self.reference.resolve(&rig, talk)?,
            us_per_degree,
            runs: self.repeat.into(),
            assumed,
            level: self.level,
            wanted_percent: self.band,
            servo_model,
        };
        let plan = Plan::of(&request).with_context(|| {
            let words = reference::describe(&request.reference, us_per_degree, train);
            format!("a run of {words} could not be identified")
        })?;
        let beyond = rig.require_within_limits(&request.reference).err();
        let beyond = beyond.map(|beyond| beyond.to_string());
        let document = PlanDocument {
            plan: &plan,
            beyond_limits: beyond.as_deref(),
        };
        if let Some(out) = &self.out {
            output.write_json(Some(out), &document)?;
            talk.say(format_args!("plan: {}", out.display()));
        }
        if let Some(folder) = &self.plots {
            let name = format!("plan-{}", request.reference.name());
            output.draw(folder, &[figure(&plan, &name)])?;
        }
        let said = beyond
            .as_ref()
            .map(|beyond| format!("  ! 'servoid capture' will not run this: {beyond}\n\n"));
        talk.result(said.unwrap_or_default() + &of_plan(&plan), &document)
    }

    fn assumed(&self, train: PulseTrain, us_per_degree: f64) -> Result<AssumedServo> {
        let assumed = match &self.model {
            Some(path) => AssumedServo::of_file(path, train, us_per_degree)?,
            None => {
                match AssumedServo::named(&with_controller(&self.servo, self.controller), train) {
                    Err(AssumedServoError::NoServo(error)) => return Err(no_servo(error)),
                    named => named?,
                }
            }
        };
        Ok(match self.noise {
            Some(sigma) => assumed.with_white_noise(sigma),
            None => assumed,
        })
    }
}
