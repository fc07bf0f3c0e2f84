//! The servo and the noise that a plan assumes.

use crate::data::model_file::{ModelFile, ModelFileError, is_model};
use crate::data::model_metadata::{ModelMetadata, unit_meant};
use crate::data::pulse_widths::is_pulse;
use crate::instrument::simulated_servo::{self, SimulatedServoError, degrees};
use servoid_identification::results::{Model, Noise};
use servoid_identification::{Error, Options, Record, Run, identify};
use servoid_protocol::reference::Staircase;
use servoid_protocol::{PulseTrain, PulseWidth};
use servoid_simulator::{OptionsError, SimulationOptions, simulate_train};
use std::path::{Path, PathBuf};

/// A servo and its noise, as a model.
#[derive(Clone, Debug)]
pub struct AssumedServo {
    /// Its name.
    pub name: String,
    /// Its response and its noise.
    pub model: Model,
    /// The pulses that it gets.
    pub train: PulseTrain,
    /// The options of its simulation, which is not linear; `None` where only its linear model is known.
    pub simulation: Option<SimulationOptions>,
    /// Noise that replaces the simulation's own (deg).
    pub noise: Option<Noise>,
}

/// Why no servo can be assumed.
#[derive(Debug, thiserror::Error)]
pub enum AssumedServoError {
    /// The options of the simulated servo are wrong.
    #[error(transparent)]
    Options(#[from] OptionsError),
    /// The simulated servo cannot be identified, as with a broken sensor.
    #[error("the simulated servo cannot be identified: {0}")]
    Data(#[from] Error),
    /// There is no such simulated servo.
    #[error(transparent)]
    NoServo(#[from] SimulatedServoError),
    /// The model cannot be read.
    #[error(transparent)]
    Model(#[from] ModelFileError),
    /// Its units are not those of a rig.
    #[error(
        "{path:?} cannot be planned with: its {what} is in {unit}, and a rig commands and reads angles; identify a recording with the {what} in degrees"
    )]
    NotAnAngle {
        /// The model.
        path: PathBuf,
        /// Command or position.
        what: &'static str,
        /// Its unit.
        unit: String,
    },
    /// A model of samples that no rig takes.
    #[error(
        "{0:?} cannot be planned with: it was sampled every {1} µs, and the rig of this servo samples every {2} µs; capture the servo once ('servoid capture -o rec.csv'), identify it ('servoid identify rec.csv -o model.json') and plan with --model model.json, or leave out --model to assume a simulated servo"
    )]
    Period(PathBuf, f64, u16),
}

impl AssumedServo {
    /// The simulated servo `options` (at 10 µs per degree), as identified from one staircase of the
    /// paper.
    ///
    /// # Errors
    /// [`AssumedServoError`].
    pub fn simulated(
        options: &SimulationOptions,
        train: PulseTrain,
    ) -> Result<Self, AssumedServoError> {
        let neutral = PulseWidth::NEUTRAL;
        let degrees = |offset: i16| f64::from(offset) / 10.0;
        let offsets: Vec<i16> = (0..).map_while(|k| Staircase::PAPER.offset_us(k)).collect();
        let pulses = offsets.iter().map(|&offset| neutral.offset_by(offset));
        let name = options.servo.name();
        let frames = simulate_train(options, train, pulses)?;
        let (mut input, mut output) = (Vec::new(), Vec::new());
        for (frame, &offset) in frames.zip(&offsets) {
            let angles = frame.degrees();
            input.extend(angles.iter().map(|_| degrees(offset)));
            output.extend(angles);
        }
        let run = Run::new(input, output)?.with_exact_input();
        let record = Record::new(train.sample_s(), vec![run])?
            .with_sample_phase(options.sample_phase_s(train));
        Ok(Self {
            name: format!("the simulated servo '{name}'"),
            model: identify(&record, &Options::default())?,
            train,
            simulation: Some(options.clone()),
            noise: None,
        })
    }

    /// The simulated servo of this name; or that of a servo model in a file, with the noise of its recording.
    ///
    /// # Errors
    /// [`AssumedServoError`].
    pub fn named(servo: &str, train: PulseTrain) -> Result<Self, AssumedServoError> {
        let options = simulated_servo::options(servo)?;
        let assumed = Self::simulated(&options, train)?;
        Ok(
            match simulated_servo::noise_of_model(servo, &options, train) {
                Some(noise) => Self {
                    name: match simulated_servo::left_open(servo).join(", ") {
                        open if open.is_empty() => format!("the servo model of {servo}"),
                        open => format!(
                            "the servo model of {servo}, with one value among many of what its recording leaves open ({open})"
                        ),
                    },
                    ..assumed.with_noise(noise)
                },
                None => assumed,
            },
        )
    }

    /// The servo of a model file, of which the linear part is known, on a rig that commands so many us per degree.
    ///
    /// # Errors
    /// [`AssumedServoError`].
    pub fn of_file(
        path: &Path,
        train: PulseTrain,
        us_per_degree: f64,
    ) -> Result<Self, AssumedServoError> {
        let ModelFile {
            model, metadata, ..
        } = ModelFile::read(path)?;
        let period_us = model.sample_period_s * 1e6;
        // The file has the period as rounded digits, so equality is to a nanosecond.
        let rig_us = train.sample_us();
        if (period_us - f64::from(rig_us)).abs() > 1e-3 {
            return Err(AssumedServoError::Period(
                path.to_owned(),
                period_us,
                rig_us,
            ));
        }
        let units = OneDegree::of(path, &metadata, us_per_degree)?;
        let shown = path.display();
        let name = match units.is_pulse {
            true => format!("the servo of {shown} at {us_per_degree} us per degree"),
            false => format!("the servo of {shown}"),
        };
        Ok(Self::of_model(name, units.of_model(model), train))
    }

    /// A servo that is known by its model alone.
    #[must_use]
    pub fn of_model(name: String, model: Model, train: PulseTrain) -> Self {
        let (simulation, noise) = (None, None);
        Self {
            name,
            model,
            train,
            simulation,
            noise,
        }
    }

    /// From the edge of a pulse to the first sample after it, as the header of a recording states it (s).
    pub(super) fn sample_phase_s(&self) -> f64 {
        match &self.simulation {
            Some(options) => options.sample_phase_s(self.train),
            None => self.model.sample_phase_s,
        }
    }

    /// The same servo with white noise of this standard deviation (deg).
    #[must_use]
    pub fn with_white_noise(self, sigma: f64) -> Self {
        self.with_noise(Noise {
            ar: Vec::new(),
            sigma,
        })
    }

    fn with_noise(mut self, noise: Noise) -> Self {
        self.model.noise = noise.clone();
        self.noise = Some(noise);
        self
    }
}

/// A degree in the units of a model.
struct OneDegree {
    /// Whether the command is the pulse itself.
    is_pulse: bool,
    command: f64,
    output: f64,
}

impl OneDegree {
    fn of(
        path: &Path,
        metadata: &ModelMetadata,
        us_per_degree: f64,
    ) -> Result<Self, AssumedServoError> {
        let units = metadata.units();
        let of_angle = |what, unit: Option<String>| match unit {
            None => Ok(1.0),
            Some(unit) => degrees(&unit).map(f64::recip).ok_or_else(|| {
                let path = path.to_owned();
                AssumedServoError::NotAnAngle { path, what, unit }
            }),
        };
        let is_pulse = is_pulse(units, metadata.recorded.map(|motion| motion.commands));
        Ok(Self {
            is_pulse,
            command: match is_pulse {
                true => us_per_degree,
                false => of_angle("command", units.input.and_then(unit_meant))?,
            },
            output: of_angle("position", units.output.and_then(unit_meant))?,
        })
    }

    /// What a plan takes of `model`: its response and its noise. The offset is that at the command 0, which a rig's degrees count from the neutral pulse.
    fn of_model(&self, mut model: Model) -> Model {
        let gain = self.command / self.output;
        for value in model.theta.iter_mut().chain(&mut model.step.value) {
            *value *= gain;
        }
        model.noise.sigma /= self.output;
        model.offset = 0.0;
        model
    }
}

/// Whether a simulated servo is a model file.
#[must_use]
pub fn is_servo_model(servo: &str) -> bool {
    is_model(Path::new(servo.split('?').next().unwrap_or_default()))
}

/// Longest memory of the noise that is followed (samples): ten seconds.
const LONGEST_MEMORY: usize = 5_000;

/// The standard deviation of noise 1/D(z) driven by σ (deg): σ sqrt(Σ f_k²), f the impulse response of
/// 1/D; infinite where that grows.
pub(super) fn noise_rms(noise: &Noise) -> f64 {
    if noise.largest_root() >= 1.0 {
        return f64::INFINITY;
    }
    let mut response = vec![1.0];
    let mut power = 1.0;
    for k in 1..LONGEST_MEMORY {
        let past = noise.ar.iter().zip(response.iter().rev());
        let next: f64 = -past.map(|(d, f)| d * f).sum::<f64>();
        response.push(next);
        power += next * next;
        // The recursion has died out once as many terms as its order are negligible.
        let recent = response.iter().rev().take(noise.ar.len().max(1));
        if k > noise.ar.len() && recent.map(|f| f * f).sum::<f64>() < 1e-12 * power {
            break;
        }
    }
    noise.sigma * power.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_of_pulses_is_planned_with_in_degrees() {
        let options = "linear".parse().unwrap();
        let AssumedServo { model, .. } =
            AssumedServo::simulated(&options, PulseTrain::USUAL).unwrap();
        let gain = |model: &Model| *model.step.value.last().unwrap();
        let planned = |input: &str, output: &str| {
            let metadata = ModelMetadata::new(Some(input.into()), Some(output.into()), None);
            let units = OneDegree::of(Path::new("servo.json"), &metadata, 8.0)?;
            Ok::<Model, AssumedServoError>(units.of_model(model.clone()))
        };
        let of_pulses = planned("us", "deg").unwrap();
        assert!((gain(&of_pulses) / gain(&model) - 8.0).abs() < 1e-12);
        let run = of_pulses.simulate_input(&[1.0; 2000], Some(0.0));
        assert!((run[1999] - gain(&of_pulses)).abs() < 1e-9, "{}", run[1999]);
        let of_radians = planned("rad", "rad").unwrap();
        assert!((gain(&of_radians) / gain(&model) - 1.0).abs() < 1e-12);
        assert!(((of_radians.noise.sigma / model.noise.sigma).to_radians() - 1.0).abs() < 1e-12);
        let error = planned("V", "deg").unwrap_err().to_string();
        assert!(error.contains("its command is in v"), "{error}");
    }
}
