//! Plans, and recordings of simulated servos.

use crate::compute::compute;
use pyo3::prelude::*;
use servoid::analysis::{SimulatedServo, to_json};
use servoid::data::rig_file::RigFile;
use servoid::instrument::reference::{FrequencyBand, ReferenceSpec};
use servoid::plan::{AssumedServo, Plan, PlanRequest, figure, is_servo_model, of_plan};
use servoid::presentation::plots;
use servoid_identification::Options;
use std::path::PathBuf;

/// The options of a reference.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct ReferenceOptions {
    reference: String,
    amplitude: Option<f64>,
    hold: Option<f64>,
    length: Option<f64>,
    levels: Option<u16>,
    prbs_seed: Option<u16>,
    frequencies: Option<(f64, f64)>,
}

impl ReferenceOptions {
    fn spec(self) -> anyhow::Result<ReferenceSpec> {
        let kind = self.reference.parse().map_err(anyhow::Error::msg)?;
        let band = |(first, last): (f64, f64)| format!("{first}:{last}").parse::<FrequencyBand>();
        let band = self.frequencies.map(band).transpose();
        Ok(ReferenceSpec {
            kind,
            amplitude_deg: self.amplitude,
            hold_s: self.hold,
            length_s: self.length,
            levels: self.levels,
            seed: self.prbs_seed,
            frequencies_hz: band.map_err(anyhow::Error::msg)?,
            train: RigFile::default().train(),
        })
    }
}

/// The options of `servoid plan`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct PlanOptions {
    model: Option<PathBuf>,
    servo: String,
    noise: Option<f64>,
    band: Option<f64>,
    repeat: usize,
    level: f64,
    servo_model: bool,
}

impl PlanOptions {
    fn assumed(&self) -> anyhow::Result<AssumedServo> {
        let rig = RigFile::default();
        let assumed = match &self.model {
            Some(path) => AssumedServo::of_file(path, rig.train(), rig.servo.us_per_degree)?,
            None => AssumedServo::named(&self.servo, rig.train())?,
        };
        Ok(match self.noise {
            Some(sigma) => assumed.with_white_noise(sigma),
            None => assumed,
        })
    }

    fn check(&self) -> anyhow::Result<()> {
        let options = Options {
            level: self.level,
            ..Options::default()
        };
        options.check()?;
        let positive = |number: &f64| *number > 0.0 && number.is_finite();
        if self.noise.iter().chain(&self.band).any(|n| !positive(n)) {
            anyhow::bail!("noise (degrees) and band (percent) must be above 0");
        }
        if !(1..=99).contains(&self.repeat) {
            anyhow::bail!("repeat must be 1 to 99 runs");
        }
        Ok(())
    }
}

/// The forecast of a run: its document, the text that the program prints, and its figure.
#[pyfunction]
pub(crate) fn plan(
    py: Python<'_>,
    reference: ReferenceOptions,
    options: PlanOptions,
) -> PyResult<(String, String, String)> {
    compute(py, move |_| {
        options.check()?;
        let us_per_degree = RigFile::default().servo.us_per_degree;
        let servo_model =
            options.servo_model || options.model.is_none() && is_servo_model(&options.servo);
        let request = PlanRequest {
            reference: reference.spec()?.resolve(us_per_degree)?.reference,
            us_per_degree,
            runs: options.repeat,
            assumed: options.assumed()?,
            level: options.level,
            wanted_percent: options.band,
            servo_model,
        };
        let plan = Plan::of(&request)?;
        let svg = plots::draw(&figure(&plan, "plan"));
        let svg = svg.map_err(|error| anyhow::anyhow!("{error}"))?;
        Ok((to_json(&plan)?, of_plan(&plan), svg))
    })
}

/// Records a simulated servo into a file; returns the number of samples.
#[pyfunction]
pub(crate) fn simulate(
    py: Python<'_>,
    servo: String,
    controller: Option<f64>,
    seed: u64,
    reference: ReferenceOptions,
    path: PathBuf,
    force: bool,
) -> PyResult<u64> {
    compute(py, move |interrupted| {
        let simulated = SimulatedServo {
            servo: &servo,
            controller,
            seed: Some(seed),
        };
        let us_per_degree = RigFile::default().servo.us_per_degree;
        let reference = reference.spec()?.resolve(us_per_degree)?.reference;
        let end = simulated.record(reference, &path, force, &|| interrupted.stop())?;
        Ok(end.rows)
    })
}
