//! The byte stream to a rig, whatever is behind it.
//!
//! | address                     | what answers                                              |
//! |-----------------------------|-----------------------------------------------------------|
//! | `/dev/ttyUSB0`, `COM3`, …   | a board on a serial port, 115200 baud, 8N1                |
//! | `tcp:HOST:PORT`             | a board behind a serial-to-network bridge                 |
//! | `sim:bench`, `sim:aircraft`, `sim:linear` | the rig's own program in this process, on a simulated servo |
//! | `sim:MODEL.json`            | the same, on the servo model of a file                    |
//!
//! Code that talks to a rig sees a [`Port`], whichever of them it is.

mod byte_stream;
mod control_line;
mod open_error;
mod serial;
mod simulated;
mod tcp;
mod timed_read;

pub use byte_stream::Port;
pub use control_line::ControlLine;
pub use open_error::OpenError;
pub use serial::BAUD_RATE;

use super::simulated_servo;
use servoid_protocol::pulse_train::PulseType;

/// Opens the port at `address` (see the module's table).
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
pub fn is_simulated(address: &str) -> bool {
    simulated_servo(address).is_some()
}

/// Whether the servo behind `address` is a simulated one that takes narrow pulses.
pub fn simulates_narrow_pulses(address: &str) -> bool {
    let simulation = address.strip_prefix("sim:");
    let options = simulation.and_then(|text| simulated_servo::options(text).ok());
    options.is_some_and(|options| options.pulses == PulseType::Narrow)
}

/// The name of the simulated servo behind `address`; `None` for a port to a board.
///
/// ```
/// assert_eq!(servoid::instrument::port::simulated_servo("sim:aircraft?seed=7"), Some("aircraft"));
/// assert_eq!(servoid::instrument::port::simulated_servo("/dev/ttyUSB0"), None);
/// ```
pub fn simulated_servo(address: &str) -> Option<&str> {
    let description = address.strip_prefix("sim:")?;
    description.split('?').next()
}
