//! A board on a serial port.

use super::byte_stream::Port;
use super::open_error::OpenError;
use super::timed_read::{SHORTEST_TIMEOUT, none_if_timed_out};
use serialport::ErrorKind;
use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::time::{Duration, Instant};

/// Speed of the rig's USART1, 8 data bits, no parity, 1 stop bit.
pub const BAUD_RATE: u32 = 115_200;

pub(super) struct SerialPort {
    port: Box<dyn serialport::SerialPort>,
    opened: Instant,
    /// Held as long as the port is open.
    _lock: Option<File>,
}

impl SerialPort {
    pub(super) fn open(name: &str) -> Result<Self, OpenError> {
        let lock = lock(name)?;
        let port = serialport::new(name, BAUD_RATE)
            .timeout(Duration::from_secs(1))
            .open()
            .map_err(|error| refusal(name, &error))?;
        Ok(Self {
            port,
            opened: Instant::now(),
            _lock: lock,
        })
    }
}

/// Keeps a second servoid off the port. The system's own exclusive mode does not hold against a
/// privileged user, and two programs on one line would each get half of the frames.
///
/// `None` where no lock can be made: that must not keep anybody from their own port.
fn lock(name: &str) -> Result<Option<File>, OpenError> {
    let device = std::fs::canonicalize(name).unwrap_or_else(|_| name.into());
    let file_name: String = device
        .to_string_lossy()
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '-' })
        .collect();
    let path = std::env::temp_dir().join(format!("servoid{file_name}.lock"));
    let made = OpenOptions::new()
        .create(true)
        .truncate(false)
        .write(true)
        .open(&path);
    // Another user's lock file may be read-only to us; a lock can be had on it all the same.
    let Ok(file) = made.or_else(|_| File::open(&path)) else {
        return Ok(None);
    };
    match file.try_lock() {
        Ok(()) => Ok(Some(file)),
        Err(std::fs::TryLockError::WouldBlock) => Err(OpenError::Busy(name.to_owned())),
        Err(std::fs::TryLockError::Error(_)) => Ok(None),
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

    fn now(&self) -> Duration {
        self.opened.elapsed()
    }
}
