//! `servoid plan`

use super::reference_args::ReferenceArgs;
use super::{Talk, listed, wrong_usage};
use crate::commands::output_files;
use crate::data::model_file::ModelFile;
use crate::instrument::reference;
use crate::instrument::rig::RigFile;
use crate::plan::{Assumed, Plan, Question, figure, of_plan};
use anyhow::{Context, Result, bail};
use clap::Args;
use servoid_protocol::timing::SAMPLE_US;
use servoid_simulator::SimulationOptions;
use std::path::PathBuf;

/// Say before a run what it will tell: how wide the band will be, and what it cannot answer
///
/// Nothing is moved. Runs of a simulated servo, of the bench one unless --servo says another, are identified as
/// the real ones will be, so that its speed limit, dead band and friction count. With --model the servo is
/// known only as far as it is linear: the band comes from the covariance that identification will have at the
/// model's noise, and a servo that is not linear gives wider ones, most of all with references that change
/// before it rests.
#[derive(Debug, Args)]
#[command(after_help = "Examples:
  servoid plan                                      the paper's staircase, and the others beside it
  servoid plan --reference prbs --band 0.5          how many runs for +-0.5 %
  servoid plan --model bench.json --reference stairs --plots plots
  servoid plan --servo linear --noise 0.05 --json")]
pub(super) struct PlanArgs {
    /// Servo and noise are those of this model, as 'servoid identify' has written it
    #[arg(long, value_name = "MODEL.json", conflicts_with = "servo")]
    model: Option<PathBuf>,
    /// Servo and noise are those of a simulated one: bench, aircraft or linear, with the options of
    /// --port sim:... behind it
    #[arg(long, default_value = "bench")]
    servo: SimulationOptions,
    /// White noise of this standard deviation instead (degrees)
    #[arg(long, value_name = "DEGREES")]
    noise: Option<f64>,
    /// Half width of the whole curve's band that is wanted, where it is widest (percent of the step):
    /// says how many runs and seconds it takes
    #[arg(long, value_name = "PERCENT")]
    band: Option<f64>,
    /// So many runs
    #[arg(long, default_value_t = 1, value_name = "COUNT", value_parser = clap::value_parser!(u16).range(1..=99))]
    repeat: u16,
    /// Confidence level of every bound
    #[arg(long, default_value_t = 0.99)]
    level: f64,
    /// What is known of servo and sensor; of it, the microseconds per degree are used
    #[arg(long, value_name = "RIG.toml")]
    rig: Option<PathBuf>,
    /// The plan to write, as JSON
    #[arg(long, short, value_name = "PLAN.json")]
    out: Option<PathBuf>,
    /// Folder for a plot of the spectrum and of the step response with the expected band
    #[arg(long, value_name = "DIR")]
    plots: Option<PathBuf>,
    /// Replace files that exist
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    talk: Talk,
    #[command(flatten)]
    reference: ReferenceArgs,
}

impl PlanArgs {
    pub(super) fn run(self) -> Result<String> {
        let positive = |number: &f64| *number > 0.0 && number.is_finite();
        if self.noise.iter().chain(&self.band).any(|n| !positive(n)) {
            wrong_usage("--noise and --band have to be above 0");
        }
        if !(0.5..=0.99999).contains(&self.level) {
            wrong_usage("--level has to be from 0.5 to 0.99999");
        }
        if let Some(out) = &self.out {
            output_files::check_free(out, self.force)?;
        }
        let assumed = self.assumed()?;
        let us_per_degree = match &self.rig {
            Some(path) => RigFile::read(path)?,
            None => RigFile::default(),
        }
        .servo
        .us_per_degree;
        let question = Question {
            reference: self.reference.grant(us_per_degree, self.talk)?,
            us_per_degree,
            runs: self.repeat.into(),
            assumed,
            level: self.level,
            wanted_percent: self.band,
        };
        let plan = Plan::of(&question).with_context(|| {
            let words = reference::in_words(&question.reference, us_per_degree);
            format!("a run of {words} could not be identified")
        })?;
        if let Some(out) = &self.out {
            output_files::write_file(out, self.force, &output_files::to_json(&plan)?)?;
            self.talk.say(format_args!("plan: {}", out.display()));
        }
        if let Some(folder) = &self.plots {
            let figure = figure(&plan, &format!("plan-{}", question.reference.name()));
            let files = output_files::write_figures(folder, self.force, &[figure])?;
            self.talk.say(format_args!("plots: {}", listed(&files)));
        }
        self.talk.result(of_plan(&plan), &plan)
    }

    fn assumed(&self) -> Result<Assumed> {
        let assumed = match &self.model {
            Some(path) => {
                let ModelFile { model, .. } = ModelFile::read(path)?;
                let period_us = model.sample_period_s * 1e6;
                // Written with as many digits as there are: only another period is another one.
                if (period_us - f64::from(SAMPLE_US)).abs() > 1e-3 {
                    bail!(
                        "{path:?} was sampled every {period_us} µs and a rig samples every {SAMPLE_US} µs: capture the servo once ('servoid capture -o rec.csv'), identify that ('servoid identify rec.csv -o model.json') and plan with --model model.json; or leave --model out, and a simulated servo is assumed"
                    );
                }
                Assumed::of_model(format!("the servo of {}", path.display()), model)
            }
            None => Assumed::simulated(&self.servo)?,
        };
        Ok(match self.noise {
            Some(sigma) => assumed.with_white_noise(sigma),
            None => assumed,
        })
    }
}
