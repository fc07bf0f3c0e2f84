//! What identification says of servos under references of every kind and size: whether it tells those
//! that are not linear, and what the figures are worth that keep their level.

use super::recordings::{US_PER_DEGREE, recording};
use servoid::instrument::reference::{Band, Kind, ReferenceSpec};
use servoid_identification::{Error, Options, identify_explained};
use servoid_protocol::reference::Reference;

/// A reference and what it is called.
pub struct Motion {
    /// As the table calls it.
    pub name: String,
    spec: ReferenceSpec,
}

impl Motion {
    fn new(name: &str, spec: ReferenceSpec) -> Self {
        let name = name.to_owned();
        Self { name, spec }
    }

    /// With steps or sines of so many degrees to each side.
    pub fn of_size(&self, degrees: f64) -> Reference {
        let spec = ReferenceSpec {
            amplitude_deg: Some(degrees),
            ..self.spec.clone()
        };
        spec.resolve(US_PER_DEGREE)
            .expect("a valid specification")
            .reference
    }
}

/// References of every kind.
pub fn motions() -> Vec<Motion> {
    let of = |kind| ReferenceSpec {
        kind,
        ..ReferenceSpec::default()
    };
    let hold = |kind, hold_s| ReferenceSpec {
        hold_s: Some(hold_s),
        ..of(kind)
    };
    let mut motions = vec![
        Motion::new("staircase", of(Kind::Staircase)),
        Motion::new("stairs, 1.2 s", of(Kind::Stairs)),
        Motion::new("stairs, 0.3 s", hold(Kind::Stairs, 0.3)),
    ];
    for hold_s in [0.2, 0.16, 0.1, 0.06, 0.04, 0.02] {
        let name = format!("random steps, {hold_s} s");
        motions.push(Motion::new(&name, hold(Kind::Prbs, hold_s)));
    }
    for last in [5.0, 15.0] {
        let frequencies_hz = Some(Band { first: 0.2, last });
        for (kind, name) in [(Kind::Sweep, "sweep"), (Kind::Multisine, "sum of sines")] {
            let spec = ReferenceSpec {
                frequencies_hz,
                ..of(kind)
            };
            motions.push(Motion::new(&format!("{name}, to {last} Hz"), spec));
        }
    }
    motions
}

/// What identification says of one recording.
#[derive(Clone, Copy, Debug)]
pub struct Said {
    /// Whether functions of the motion, and the noise at rest, show that errors are not noise.
    pub found: [bool; 2],
    /// Whether it is said that the servo is not linear, or bounds have no level.
    pub told: bool,
    /// Whether bounds have a level.
    pub level: bool,
    /// What the simulation leaves \[% of the motion, rms\].
    pub leaves_percent: f64,
    /// Gain.
    pub gain: Option<f64>,
    /// Delay (ms).
    pub delay_ms: Option<f64>,
}

/// Identifies one recording.
///
/// # Errors
/// That of the identification.
pub fn said(servo: &str, reference: Reference, seed: u64) -> Result<Said, Error> {
    let record = recording(servo, reference, seed);
    let found = identify_explained(&record, &Options::default())?;
    let (model, linearity) = (&found.model, found.explanation.linearity);
    let level = model.bounds.valid().is_some();
    Ok(Said {
        found: [
            linearity.is_some_and(|linearity| linearity.by_functions()),
            linearity.is_some_and(|linearity| linearity.against_rest().is_some()),
        ],
        told: !level || !model.linear,
        level,
        leaves_percent: 100.0 - model.fit.simulation_percent,
        gain: model.metrics.dc_gain.value,
        delay_ms: model.metrics.delay_s.value.map(|delay| 1e3 * delay),
    })
}
