//! A recording of a simulated servo.

use crate::data::recording::{Header, RecordingWriter, ReservedFile};
use crate::data::rig_file::RigFile;
use crate::instrument::port;
use crate::instrument::rig::{Capture, CaptureEnd, RigClient, StopReason};
use crate::instrument::simulated_servo::{self, SimulatedServoError};
use anyhow::Result;
use servoid_protocol::Reference;
use std::path::Path;

/// The seed where none is given.
const USUAL_SEED: u64 = 1;

/// A simulated servo as `servoid simulate` takes it.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedServo<'a> {
    /// bench, aircraft or linear with options as in `--port sim:...`, or the file of a servo model.
    pub servo: &'a str,
    /// The controller that drives it, where the model has several.
    pub controller: Option<f64>,
    /// Seed of the noise; `None` for that of the options of the servo, or else 1.
    pub seed: Option<u64>,
}

impl SimulatedServo<'_> {
    /// The port of its rig.
    ///
    /// # Errors
    /// There is no such servo, or its seed is given twice.
    pub fn address(&self) -> Result<String, SimulatedServoError> {
        let Self {
            servo,
            controller,
            seed,
        } = self;
        let keys = servo.split_once('?').map(|(_, keys)| keys);
        let has_seed = keys.is_some_and(|keys| keys.split('&').any(|key| key.starts_with("seed=")));
        let servo = match (seed, has_seed) {
            (None, true) => (*servo).to_owned(),
            (Some(seed), true) => {
                return Err(SimulatedServoError::TwoSeeds {
                    servo: (*servo).to_owned(),
                    seed: *seed,
                });
            }
            (seed, false) => {
                let joint = if keys.is_some() { '&' } else { '?' };
                format!("{servo}{joint}seed={}", seed.unwrap_or(USUAL_SEED))
            }
        };
        let servo = simulated_servo::with_controller(&servo, *controller);
        simulated_servo::options(&servo)?;
        Ok(format!("sim:{servo}"))
    }

    /// The condition of its recordings: its name.
    #[must_use]
    pub fn condition(&self) -> String {
        let name = Path::new(self.servo.split('?').next().unwrap_or_default());
        let stem = name.file_stem().unwrap_or(name.as_os_str());
        stem.to_string_lossy().into_owned()
    }

    /// Records one run of `reference` into `file`, which is replaced only with `force`. `stop` is asked often whether to end.
    ///
    /// # Errors
    /// There is no such servo, the reference goes beyond the limits of the usual rig, or the file cannot be written.
    pub fn record(
        &self,
        reference: Reference,
        file: &Path,
        force: bool,
        stop: &dyn Fn() -> Option<StopReason>,
    ) -> Result<CaptureEnd> {
        let (rig, address) = (RigFile::default(), self.address()?);
        rig.require_within_limits(&reference)?;
        let reserved = ReservedFile::new(file, force)?;
        let mut client = RigClient::connect_beside(port::open(&address)?, &address)?;
        let capture = Capture::new(rig, reference);
        capture.arm(&mut client)?;
        let header = Header {
            condition: self.condition(),
            port: address,
            ..Header::of_run(client.hello(), &capture.rig, &capture.start)
        };
        let writer = RecordingWriter::begin(reserved, &header);
        Ok(capture.record(&mut client, writer, stop, &mut |_| {})?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_is_that_of_the_text_or_beside_it_and_not_both() {
        let address = |servo, seed| {
            let servo = SimulatedServo {
                servo,
                controller: None,
                seed,
            };
            servo.address().map_err(|error| error.to_string())
        };
        assert_eq!(address("bench", None).unwrap(), "sim:bench?seed=1");
        assert_eq!(
            address("bench?noise=none", Some(3)).unwrap(),
            "sim:bench?noise=none&seed=3"
        );
        assert_eq!(
            address("aircraft?seed=2", None).unwrap(),
            "sim:aircraft?seed=2"
        );
        assert_eq!(
            address("aircraft?seed=2", Some(3)).unwrap_err(),
            "the seed is given twice, in `aircraft?seed=2` and as 3 beside it: leave one of them out"
        );
    }
}
