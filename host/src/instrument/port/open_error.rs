//! Why a port could not be opened, and what to do about it.

/// Why a port could not be opened. The text names the remedy.
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
    /// Nobody listens at this address, for this reason.
    #[error("nobody answers at {0}: {1}")]
    Unreachable(String, String),
    /// The text after `sim:` or `tcp:` makes no sense.
    #[error("{0}")]
    BadAddress(String),
    /// Anything else that the system reports of this port.
    #[error("port {0:?} cannot be opened: {1}")]
    Other(String, String),
}
