//! What every port does, whatever is behind it.

use super::control_line::ControlLine;
use std::time::Duration;

/// A byte stream to a rig, and the clock that its time-outs run on.
pub trait Port {
    /// Waits up to `timeout` for bytes; returns how many were put into `buffer`, 0 for none.
    ///
    /// # Errors
    /// When the stream is gone: unplugged, closed by the other end.
    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> std::io::Result<usize>;

    /// Sends all of `bytes`.
    ///
    /// # Errors
    /// When the stream is gone, or takes nothing for a second.
    fn write_all(&mut self, bytes: &[u8]) -> std::io::Result<()>;

    /// Time since the port was opened. A simulated rig has simulated time, so that waiting for it
    /// costs no more than its computation.
    fn now(&self) -> Duration;

    /// Adds an even parity bit to each byte, or leaves it out. A stream that passes whole bytes on has none.
    ///
    /// # Errors
    /// When the stream is gone.
    fn set_even_parity(&mut self, _on: bool) -> std::io::Result<()> {
        Ok(())
    }

    /// Sets or clears a line beside the data.
    ///
    /// # Errors
    /// Where the port has no such line.
    fn set_control_line(&mut self, _line: ControlLine, _set: bool) -> std::io::Result<()> {
        Err(std::io::ErrorKind::Unsupported.into())
    }

    /// Whether the rig's time stands still while nobody reads, as that of a simulated rig may: then
    /// pausing between reads delays nothing and loses nothing.
    fn is_paced_by_reader(&self) -> bool {
        false
    }
}
