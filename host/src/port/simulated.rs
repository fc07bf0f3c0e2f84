//! The rig's own program in this process, on a simulated servo.

use super::{OpenError, Port};
use servoid_simulator::{InProcessRig, SimulationOptions};
use std::time::Duration;

pub(super) struct SimulatedPort {
    rig: InProcessRig,
}

impl SimulatedPort {
    /// `description` is what follows `sim:`.
    pub(super) fn open(description: &str) -> Result<Self, OpenError> {
        let options: SimulationOptions = description
            .parse()
            .map_err(|e| OpenError::BadAddress(format!("{e}")))?;
        let rig = InProcessRig::new(&options).map_err(|e| OpenError::BadAddress(format!("{e}")))?;
        Ok(Self { rig })
    }
}

impl Port for SimulatedPort {
    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> std::io::Result<usize> {
        Ok(self.rig.read(buffer, timeout))
    }

    fn write_all(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.rig.write(bytes);
        Ok(())
    }

    fn now(&self) -> Duration {
        self.rig.now()
    }
}
