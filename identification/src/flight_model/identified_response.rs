//! What was identified of a response, to hold a model of low order against it.

use faer::Mat;

use crate::numerics::times;
use crate::results::Model;

/// An identified response.
pub(super) enum IdentifiedResponse {
    /// That to a step.
    Step(IdentifiedStep),
    /// That to the frequencies of a band.
    Band(IdentifiedBand),
}

/// An identified step response.
pub(super) struct IdentifiedStep {
    /// Its values.
    pub(super) curve: Vec<f64>,
    /// Their standard deviations, by the covariance of the whitening.
    pub(super) sd: Vec<f64>,
    /// From an impulse response to the step response as the estimator would find it.
    pub(super) map: Mat<f64>,
}

/// The frequency response in a band.
pub(super) struct IdentifiedBand {
    /// Frequencies \[rad/sample\].
    omegas: Vec<f64>,
    /// Re G and Im G.
    values: Vec<(f64, f64)>,
}

impl IdentifiedResponse {
    /// Largest difference from that of a servo with the response `impulse`: as a share of the step, or of the response at the lowest frequency of the band.
    pub(super) fn largest_difference(&self, impulse: &[f64]) -> f64 {
        match self {
            Self::Step(step) => {
                let projected = times(&step.map, impulse);
                let pairs = step.curve.iter().zip(projected);
                let differences = pairs.map(|(a, b)| (a - b).abs());
                differences.fold(0.0, f64::max) / step.curve[step.curve.len() - 1].abs()
            }
            Self::Band(band) => band.largest_difference(impulse),
        }
    }
}

impl IdentifiedBand {
    /// That of `model`, which has one.
    pub(super) fn new(model: &Model) -> Self {
        let found = &model.frequency;
        let period = model.sample_period_s;
        Self {
            omegas: found.omega_rad_s.iter().map(|w| w * period).collect(),
            values: (found.re.iter().copied())
                .zip(found.im.iter().copied())
                .collect(),
        }
    }

    /// Its ends \[rad/sample\]; `None` of one without frequencies.
    pub(super) fn ends(&self) -> Option<[f64; 2]> {
        Some([*self.omegas.first()?, *self.omegas.last()?])
    }

    fn largest_difference(&self, impulse: &[f64]) -> f64 {
        let difference = |(omega, (re, im)): (&f64, &(f64, f64))| {
            let (mut of_re, mut of_im) = (*re, *im);
            for (i, h) in impulse.iter().enumerate() {
                let (sin, cos) = (omega * i as f64).sin_cos();
                of_re -= h * cos;
                of_im += h * sin;
            }
            of_re.hypot(of_im)
        };
        let differences = self.omegas.iter().zip(&self.values).map(difference);
        let scale = self.values.first().map_or(1.0, |(re, im)| re.hypot(*im));
        differences.fold(0.0, f64::max) / scale
    }
}
