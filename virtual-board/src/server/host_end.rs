//! A port that a host can open.

use std::io;

/// A port that a host can open. Neither direction ever waits; an error means that the port is gone for good.
pub trait HostEnd {
    /// Reads bytes from the host; returns how many, 0 for none.
    fn receive(&mut self, buffer: &mut [u8]) -> io::Result<usize>;

    /// Sends bytes to the host; returns how many it took. Without a host it takes all.
    fn send(&mut self, bytes: &[u8]) -> io::Result<usize>;
}

/// A call that would block did nothing.
pub(super) fn none_if_it_would_wait(result: io::Result<usize>) -> io::Result<usize> {
    match result {
        Err(e)
            if matches!(
                e.kind(),
                io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted
            ) =>
        {
            Ok(0)
        }
        other => other,
    }
}
