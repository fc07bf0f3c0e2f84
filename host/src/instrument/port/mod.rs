//! The byte stream to a rig, whatever is behind it.
//!
//! | address                     | what answers                                              |
//! |-----------------------------|-----------------------------------------------------------|
//! | `/dev/ttyUSB0`, `COM3`, …   | a board on a serial port, 115200 baud, 8N1                |
//! | `tcp:HOST:PORT`             | a board behind a serial-to-network bridge                 |
//! | `sim:bench`, `sim:aircraft`, `sim:linear` | the rig's own program in this process, on a simulated servo |
//!
//! Code that talks to a rig sees a [`Port`] and cannot tell which of them it has.

mod serial;
mod simulated;
mod tcp;

pub use serial::BAUD_RATE;

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

    /// Whether the rig's time stands still while nobody reads, as that of a simulated rig may: then
    /// pausing between reads delays nothing and loses nothing.
    fn is_paced_by_reader(&self) -> bool {
        false
    }
}

/// Why a port could not be opened. The text says what to do.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// No such port.
    #[error("there is no port {0:?}: 'servoid ports' lists those that are there")]
    NotFound(String),
    /// Somebody else has it, or the user may not open it.
    #[error(
        "port {0:?} is busy or not permitted: close the program that uses it, or join the group that owns it (on Linux usually 'dialout')"
    )]
    Busy(String),
    /// There is something of that name, and it is no serial port.
    #[error("{0:?} is no serial port: 'servoid ports' lists those that are there")]
    NoSerialPort(String),
    /// Nobody listens there.
    #[error("nobody answers at {address}: {reason}")]
    Unreachable {
        /// Where.
        address: String,
        /// What the network said.
        reason: String,
    },
    /// The text after `sim:` or `tcp:` makes no sense.
    #[error("{0}")]
    BadAddress(String),
    /// Anything else that the system said.
    #[error("port {port:?} cannot be opened: {reason}")]
    Other {
        /// Which.
        port: String,
        /// What the system said.
        reason: String,
    },
}

/// Opens the port at `address` (see the module's table).
///
/// # Errors
/// [`OpenError`] with a sentence that says what to do.
pub fn open(address: &str) -> Result<Box<dyn Port>, OpenError> {
    if let Some(simulation) = address.strip_prefix("sim:") {
        Ok(Box::new(simulated::open(simulation)?))
    } else if let Some(network) = address.strip_prefix("tcp:") {
        Ok(Box::new(tcp::TcpPort::open(network)?))
    } else {
        Ok(Box::new(serial::SerialPort::open(address)?))
    }
}

/// Whether the servo behind `address` is a simulated one, so that nobody can be hurt by it.
#[must_use]
pub fn is_simulated(address: &str) -> bool {
    simulated_servo(address).is_some()
}

/// The name of the simulated servo behind `address`; `None` for a port to a board.
///
/// ```
/// assert_eq!(servoid::port::simulated_servo("sim:aircraft?seed=7"), Some("aircraft"));
/// assert_eq!(servoid::port::simulated_servo("/dev/ttyUSB0"), None);
/// ```
#[must_use]
pub fn simulated_servo(address: &str) -> Option<&str> {
    let description = address.strip_prefix("sim:")?;
    description.split('?').next()
}

/// The shortest wait that all systems' ports understand; 0 would mean "for ever" to some.
const SHORTEST_TIMEOUT: Duration = Duration::from_millis(1);

/// A read that ended for want of bytes is not an error.
fn none_if_timed_out(read: std::io::Result<usize>) -> std::io::Result<usize> {
    use std::io::ErrorKind::{Interrupted, TimedOut, WouldBlock};
    match read {
        Err(e) if matches!(e.kind(), TimedOut | WouldBlock | Interrupted) => Ok(0),
        other => other,
    }
}

/// What a read of 0 bytes means on a stream that waits: the other end has gone.
fn closed() -> std::io::Error {
    std::io::Error::new(
        std::io::ErrorKind::UnexpectedEof,
        "the other end closed the connection",
    )
}
