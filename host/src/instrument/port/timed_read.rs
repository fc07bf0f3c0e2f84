//! How a read with a time-out may end.

use std::time::Duration;

/// The shortest wait that all systems' ports understand; 0 would mean "for ever" to some.
pub(super) const SHORTEST_TIMEOUT: Duration = Duration::from_millis(1);

/// A read that ended for want of bytes is not an error.
pub(super) fn none_if_timed_out(read: std::io::Result<usize>) -> std::io::Result<usize> {
    use std::io::ErrorKind::{Interrupted, TimedOut, WouldBlock};
    match read {
        Err(e) if matches!(e.kind(), TimedOut | WouldBlock | Interrupted) => Ok(0),
        other => other,
    }
}

/// What a read of 0 bytes means on a stream that waits: the other end has gone.
pub(super) fn closed() -> std::io::Error {
    std::io::Error::new(
        std::io::ErrorKind::UnexpectedEof,
        "the other end closed the connection",
    )
}
