//! A board behind a network bridge, or the virtual board.

use super::byte_stream::Port;
use super::open_error::OpenError;
use super::timed_read::{SHORTEST_TIMEOUT, closed, none_if_timed_out};
use std::io::{Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

/// Long enough for a bridge on a slow wireless link, short enough to wait for.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(5);

pub(super) struct TcpPort {
    stream: TcpStream,
    opened: Instant,
}

impl TcpPort {
    pub(super) fn open(address: &str) -> Result<Self, OpenError> {
        let unreachable = |reason| OpenError::Unreachable(format!("tcp:{address}"), reason);
        let candidates: Vec<_> = address
            .to_socket_addrs()
            .map_err(|_| {
                OpenError::BadAddress(format!(
                    "'tcp:{address}' is no address: write tcp:HOST:PORT, as in tcp:127.0.0.1:5000"
                ))
            })?
            .collect();
        let mut reason = "the name has no address".to_owned();
        for candidate in candidates {
            match TcpStream::connect_timeout(&candidate, CONNECT_TIMEOUT) {
                Ok(stream) => {
                    // Requests are small and wait for an answer: do not hold them back.
                    stream
                        .set_nodelay(true)
                        .map_err(|e| unreachable(e.to_string()))?;
                    return Ok(Self {
                        stream,
                        opened: Instant::now(),
                    });
                }
                Err(error) => reason = error.to_string(),
            }
        }
        Err(unreachable(reason))
    }
}

impl Port for TcpPort {
    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> std::io::Result<usize> {
        self.stream
            .set_read_timeout(Some(timeout.max(SHORTEST_TIMEOUT)))?;
        match self.stream.read(buffer) {
            Ok(0) if !buffer.is_empty() => Err(closed()),
            read => none_if_timed_out(read),
        }
    }

    fn write_all(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.stream
            .set_write_timeout(Some(Duration::from_secs(1)))?;
        self.stream.write_all(bytes)
    }

    fn now(&self) -> Duration {
        self.opened.elapsed()
    }
}
