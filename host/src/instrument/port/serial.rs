//! A board on a serial port.

use super::byte_stream::Port;
use super::control_line::ControlLine;
use super::open_error::OpenError;
use super::timed_read::{SHORTEST_TIMEOUT, none_if_timed_out};
use serialport::{ErrorKind, Parity};
use std::io::{Read, Write};
use std::time::{Duration, Instant};

/// Speed of the rig's USART1, 8 data bits, no parity, 1 stop bit.
pub const BAUD_RATE: u32 = 115_200;

pub(super) struct SerialPort {
    port: Box<dyn serialport::SerialPort>,
    opened: Instant,
}

impl SerialPort {
    pub(super) fn open(name: &str) -> Result<Self, OpenError> {
        // The library locks the device itself (flock and TIOCEXCL on Unix), which holds against a privileged user
        // too, and leaves nothing behind.
        let mut port = serialport::new(name, BAUD_RATE)
            .timeout(Duration::from_secs(1))
            .open()
            .map_err(|error| refusal(name, &error))?;
        // Systems set RTS and DTR when a port is opened. Where DTR is at the board's reset, that would hold the board;
        // BOOT0 at RTS is right so. A port without such lines needs nothing.
        let _no_such_line = port.write_data_terminal_ready(false);
        Ok(Self {
            port,
            opened: Instant::now(),
        })
    }
}

fn refusal(name: &str, error: &serialport::Error) -> OpenError {
    use std::io::ErrorKind as Io;
    let text = error.to_string().to_lowercase();
    match error.kind() {
        ErrorKind::NoDevice if text.contains("busy") || text.contains("lock") => {
            OpenError::Busy(name.to_owned())
        }
        ErrorKind::Io(Io::PermissionDenied | Io::ResourceBusy) => OpenError::Busy(name.to_owned()),
        ErrorKind::NoDevice | ErrorKind::Io(Io::NotFound) => OpenError::NotFound(name.to_owned()),
        // ENOTTY, which the system reports as "Not a typewriter": a file or a device without a line.
        _ if text.contains("typewriter") || text.contains("inappropriate ioctl") => {
            OpenError::NoSerialPort(name.to_owned())
        }
        _ => OpenError::Other(name.to_owned(), error.to_string()),
    }
}

impl Port for SerialPort {
    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> std::io::Result<usize> {
        self.port.set_timeout(timeout.max(SHORTEST_TIMEOUT))?;
        none_if_timed_out(self.port.read(buffer))
    }

    fn write_all(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.port.set_timeout(Duration::from_secs(1))?;
        self.port.write_all(bytes)
    }

    fn set_even_parity(&mut self, on: bool) -> std::io::Result<()> {
        let parity = if on { Parity::Even } else { Parity::None };
        Ok(self.port.set_parity(parity)?)
    }

    fn set_control_line(&mut self, line: ControlLine, set: bool) -> std::io::Result<()> {
        match line {
            ControlLine::Rts => self.port.write_request_to_send(set)?,
            ControlLine::Dtr => self.port.write_data_terminal_ready(set)?,
        }
        Ok(())
    }

    fn now(&self) -> Duration {
        self.opened.elapsed()
    }
}
