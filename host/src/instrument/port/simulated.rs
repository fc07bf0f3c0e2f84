//! The rig's own program in this process, on a simulated servo.

use super::byte_stream::Port;
use super::open_error::OpenError;
use crate::instrument::simulated_servo;
use servoid_simulator::InProcessRig;
use std::time::Duration;

/// `description` is what follows `sim:`.
pub(super) fn open(description: &str) -> Result<InProcessRig, OpenError> {
    let options =
        simulated_servo::options(description).map_err(|e| OpenError::BadAddress(format!("{e}")))?;
    InProcessRig::new(&options).map_err(|e| OpenError::BadAddress(format!("{e}")))
}

impl Port for InProcessRig {
    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> std::io::Result<usize> {
        Ok(InProcessRig::read(self, buffer, timeout))
    }

    fn write_all(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.write(bytes);
        Ok(())
    }

    fn now(&self) -> Duration {
        InProcessRig::now(self)
    }

    fn is_paced_by_reader(&self) -> bool {
        !self.is_realtime()
    }
}
