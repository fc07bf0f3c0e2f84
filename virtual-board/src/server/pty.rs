//! The board behind a pseudo-terminal: to the host, a serial port like any other.

use super::host_end::{HostEnd, none_if_it_would_wait};
use rustix::fs::{Mode, OFlags, fcntl_getfl, fcntl_setfl, open};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// Both ends of a pseudo-terminal.
#[derive(Debug)]
pub struct PseudoTerminal {
    ours: File,
    /// Held open, so that the terminal keeps its settings and hosts may come and go.
    _theirs: File,
    path: PathBuf,
}

impl PseudoTerminal {
    /// A new pseudo-terminal that passes bytes on as they are.
    pub fn open() -> io::Result<Self> {
        let ours = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY)?;
        grantpt(&ours)?;
        unlockpt(&ours)?;
        let name = ptsname(&ours, Vec::new())?;
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
        let theirs = open(name.as_c_str(), flags, Mode::empty())?;
        let mut settings = tcgetattr(&theirs)?;
        settings.make_raw();
        tcsetattr(&theirs, OptionalActions::Now, &settings)?;
        fcntl_setfl(&ours, fcntl_getfl(&ours)? | OFlags::NONBLOCK)?;
        Ok(Self {
            ours: ours.into(),
            _theirs: theirs.into(),
            path: name.to_string_lossy().into_owned().into(),
        })
    }

    /// The name that the host opens.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl HostEnd for PseudoTerminal {
    fn receive(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        none_if_it_would_wait(self.ours.read(buffer))
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<usize> {
        none_if_it_would_wait(self.ours.write(bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_pass_as_they_are() {
        let mut terminal = PseudoTerminal::open().unwrap();
        let mut host = File::options()
            .read(true)
            .write(true)
            .open(terminal.path())
            .unwrap();
        let all: Vec<u8> = (0..=255).collect();
        let mut buffer = [0; 512];
        assert_eq!(terminal.receive(&mut buffer).unwrap(), 0);
        host.write_all(&all).unwrap();
        let mut received = Vec::new();
        while received.len() < all.len() {
            let count = terminal.receive(&mut buffer).unwrap();
            received.extend_from_slice(&buffer[..count]);
        }
        assert_eq!(received, all);
        assert_eq!(terminal.send(&all).unwrap(), all.len());
        let mut back = vec![0; all.len()];
        host.read_exact(&mut back).unwrap();
        assert_eq!(back, all);
    }
}
