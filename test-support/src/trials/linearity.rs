//! Identification of servos under references of every kind and size: whether it reports those that are
//! not linear, and the accuracy of the metrics whose bounds hold.

use super::recordings::{US_PER_DEGREE, recording};
use servoid::instrument::reference::{FrequencyBand, Kind, ReferenceSpec};
use servoid_identification::{Error, Options, identify_explained};
use servoid_protocol::reference::Reference;

/// A reference and its name.
pub struct Motion {
    /// Its name in the table.
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
        let frequencies_hz = Some(FrequencyBand { first: 0.2, last });
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

/// The findings of identification in one recording.
#[derive(Clone, Copy, Debug)]
pub struct Findings {
    /// Whether functions of the motion, and the noise at rest, show that errors are not noise.
    pub found: [bool; 2],
    /// Whether the servo is reported as not linear, or the bounds are withdrawn.
    pub reported: bool,
    /// Whether bounds have a level.
    pub level: bool,
    /// Residual of the simulation \[% of the motion, rms\].
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
pub fn findings(servo: &str, reference: Reference, seed: u64) -> Result<Findings, Error> {
    let record = recording(servo, reference, seed);
    let found = identify_explained(&record, &Options::default())?;
    let (model, linearity) = (&found.model, found.explanation.linearity);
    let level = model.bounds.valid().is_some();
    Ok(Findings {
        found: [
            linearity.is_some_and(|linearity| linearity.by_functions()),
            linearity.is_some_and(|linearity| linearity.against_rest().is_some()),
        ],
        reported: !level || !model.linear,
        level,
        leaves_percent: 100.0 - model.fit.simulation_percent,
        gain: model.metrics.dc_gain.value,
        delay_ms: model.metrics.delay_s.value.map(|delay| 1e3 * delay),
    })
}
