//! The board behind a network socket.

use super::host_end::{HostEnd, none_if_it_would_wait};
use std::io::{self, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream, ToSocketAddrs};

/// Waits for hosts, one at a time.
#[derive(Debug)]
pub struct TcpServer {
    listener: TcpListener,
    host: Option<TcpStream>,
}

impl TcpServer {
    /// Listens at `address`.
    pub fn listen(address: impl ToSocketAddrs) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        Ok(Self {
            listener,
            host: None,
        })
    }

    /// Its address.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.listener.local_addr()
    }

    fn welcome(&mut self) -> io::Result<()> {
        match self.listener.accept() {
            Ok((stream, _)) => {
                stream.set_nonblocking(true)?;
                // Messages are small and wait for each other.
                stream.set_nodelay(true)?;
                self.host = Some(stream);
                Ok(())
            }
            Err(error) => none_if_it_would_wait(Err(error)).map(drop),
        }
    }
}

impl HostEnd for TcpServer {
    fn receive(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.host.is_none() {
            self.welcome()?;
        }
        let Some(host) = &mut self.host else {
            return Ok(0);
        };
        match host.read(buffer) {
            Ok(0) => self.host = None,
            read => match none_if_it_would_wait(read) {
                Ok(count) => return Ok(count),
                // A host that is gone without a word.
                Err(_) => self.host = None,
            },
        }
        Ok(0)
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let Some(host) = &mut self.host else {
            return Ok(bytes.len());
        };
        none_if_it_would_wait(host.write(bytes)).or_else(|_| {
            self.host = None;
            Ok(bytes.len())
        })
    }
}
