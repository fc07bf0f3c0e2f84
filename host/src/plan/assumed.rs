//! The servo and the noise that a plan assumes.

use servoid_identification::noise_model::Noise;
use servoid_identification::{Error, Model, Options, Record, identify};
use servoid_protocol::PulseWidth;
use servoid_protocol::reference::Staircase;
use servoid_protocol::timing::SAMPLE_US;
use servoid_simulator::{OptionsError, SimulationOptions, simulate};

/// A servo and its noise, as a model.
#[derive(Clone, Debug)]
pub struct Assumed {
    /// What it is called.
    pub name: String,
    /// Its response, and its noise.
    pub model: Model,
    /// How it is simulated with all that is not linear in it; `None` where only its model is known, which
    /// is linear.
    pub simulation: Option<SimulationOptions>,
    /// White noise of this standard deviation in the place of the simulation's own (deg).
    pub white_noise: Option<f64>,
}

/// Why there is nothing to assume. The text says what is wrong.
#[derive(Debug, thiserror::Error)]
pub enum AssumedError {
    /// Options of the simulated servo.
    #[error(transparent)]
    Options(#[from] OptionsError),
    /// What they leave cannot be identified, as with a sensor that is broken.
    #[error("the simulated servo cannot be identified: {0}")]
    Data(#[from] Error),
}

impl Assumed {
    /// The simulated servo `options` (at 10 µs per degree), as identified from one staircase of the
    /// paper.
    ///
    /// # Errors
    /// [`AssumedError`].
    pub fn simulated(options: &SimulationOptions) -> Result<Self, AssumedError> {
        let neutral = PulseWidth::NEUTRAL;
        let degrees = |offset: i16| f64::from(offset) / 10.0;
        let offsets: Vec<i16> = (0..).map_while(|k| Staircase::PAPER.offset_us(k)).collect();
        let pulses = offsets.iter().map(|&offset| neutral.offset_by(offset));
        let name = options.servo.name();
        let frames = simulate(options, pulses)?;
        let (mut input, mut output) = (Vec::new(), Vec::new());
        for (frame, &offset) in frames.zip(&offsets) {
            let angles = frame.degrees();
            input.extend(angles.iter().map(|_| degrees(offset)));
            output.extend(angles);
        }
        let record = Record::from_slices(f64::from(SAMPLE_US) * 1e-6, &input, &output)?;
        Ok(Self {
            name: format!("the simulated servo '{name}'"),
            model: identify(&record, &Options::default())?,
            simulation: Some(options.clone()),
            white_noise: None,
        })
    }

    /// A servo of which a model is known.
    #[must_use]
    pub fn of_model(name: String, model: Model) -> Self {
        Self {
            name,
            model,
            simulation: None,
            white_noise: None,
        }
    }

    /// The same servo with white noise of this standard deviation (deg).
    #[must_use]
    pub fn with_white_noise(mut self, sigma: f64) -> Self {
        self.model.noise = Noise {
            ar: Vec::new(),
            sigma,
        };
        self.white_noise = Some(sigma);
        self
    }
}

/// Samples after which the memory of noise is taken for over, at the latest: ten seconds.
const LONGEST_MEMORY: usize = 5_000;

/// The standard deviation of noise 1/D(z) driven by σ (deg): σ sqrt(Σ f_k²), f the impulse response of
/// 1/D.
#[must_use]
pub fn noise_rms(noise: &Noise) -> f64 {
    let mut response = vec![1.0];
    let mut power = 1.0;
    for k in 1..LONGEST_MEMORY {
        let past = noise.ar.iter().zip(response.iter().rev());
        let next: f64 = -past.map(|(d, f)| d * f).sum::<f64>();
        response.push(next);
        power += next * next;
        // For as long as the order nothing has come that counts.
        let recent = response.iter().rev().take(noise.ar.len().max(1));
        if k > noise.ar.len() && recent.map(|f| f * f).sum::<f64>() < 1e-12 * power {
            break;
        }
    }
    noise.sigma * power.sqrt()
}
