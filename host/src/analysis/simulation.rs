//! A recording of a simulated servo.

use crate::data::recording::{Header, RecordingWriter, ReservedFile};
use crate::data::rig_file::RigFile;
use crate::instrument::port;
use crate::instrument::rig::{Capture, CaptureEnd, RigClient, StopReason};
use crate::instrument::simulated_servo::{self, SimulatedServoError};
use anyhow::Result;
use servoid_protocol::Reference;
use std::path::Path;

/// A simulated servo as `servoid simulate` takes it.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedServo<'a> {
    /// bench, aircraft or linear with options as in `--port sim:...`, or the file of a servo model.
    pub servo: &'a str,
    /// The controller that drives it, where the model has several.
    pub controller: Option<f64>,
    /// Seed of the noise.
    pub seed: u64,
}

impl SimulatedServo<'_> {
    /// The port of its rig.
    ///
    /// # Errors
    /// There is no such servo.
    pub fn address(&self) -> Result<String, SimulatedServoError> {
        let Self {
            servo,
            controller,
            seed,
        } = self;
        let keys = if servo.contains('?') { '&' } else { '?' };
        let servo =
            simulated_servo::with_controller(&format!("{servo}{keys}seed={seed}"), *controller);
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
