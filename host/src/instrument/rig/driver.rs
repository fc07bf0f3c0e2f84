//! Connects the conversation to a port and its clock.

use super::talk_error::TalkError;
use crate::instrument::port::Port;
use servoid_client::{Client, Event};
use std::time::Duration;

/// So long after its time a read has ended because the program, and not the line, stood still.
const OVERSLEPT: Duration = Duration::from_millis(100);

/// A conversation over a port.
pub(super) struct Driver {
    pub(super) port: Box<dyn Port>,
    pub(super) client: Client,
}

impl Driver {
    /// Lets `time` pass; what comes meanwhile is heard.
    pub(super) fn pause(&mut self, time: Duration) -> Result<(), TalkError> {
        let until = self.port.now().saturating_add(time);
        let mut buffer = [0; 512];
        loop {
            let now = self.port.now();
            if now >= until {
                return Ok(());
            }
            let count = self.port.read(&mut buffer, until - now)?;
            let bytes = buffer.get(..count).unwrap_or_default();
            self.client.handle(bytes, self.port.now());
        }
    }

    /// What happens next, waiting up to `timeout` for it; `None` as well where the client has nothing to
    /// do.
    pub(super) fn next_event(&mut self, timeout: Duration) -> Result<Option<Event>, TalkError> {
        let until = self.port.now().saturating_add(timeout);
        let mut buffer = [0; 512];
        loop {
            while let Some(bytes) = self.client.poll_transmit() {
                self.port.write_all(&bytes)?;
            }
            let event = self.client.poll_event();
            let now = self.port.now();
            if event.is_some() || self.client.is_idle() || now >= until {
                return Ok(event);
            }
            let wake = self
                .client
                .next_deadline()
                .map_or(until, |at| at.min(until));
            let mut count = self.port.read(&mut buffer, wake.saturating_sub(now))?;
            if count == 0 && self.port.now() > wake + OVERSLEPT {
                // The program was stopped, and what came meanwhile is waiting: it is taken before time goes on.
                count = self.port.read(&mut buffer, Duration::ZERO)?;
            }
            let bytes = buffer.get(..count).unwrap_or_default();
            self.client.handle(bytes, self.port.now());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_client::Connect;
    use servoid_protocol::hello::{ClockSource, Hello};
    use servoid_protocol::{RigMessage, framing};
    use servoid_test_support::hello::hello;
    use std::io::Result as IoResult;

    /// A port whose program is stopped for 15 s in its first read. What came meanwhile is there afterwards.
    struct Stopped {
        now: Duration,
        waiting: Vec<u8>,
    }

    impl Port for Stopped {
        fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> IoResult<usize> {
            if self.now == Duration::ZERO {
                self.now = Duration::from_secs(15);
                return Ok(0);
            }
            self.now += if self.waiting.is_empty() {
                timeout
            } else {
                Duration::ZERO
            };
            let count = self.waiting.len().min(buffer.len());
            for (place, byte) in buffer.iter_mut().zip(self.waiting.drain(..count)) {
                *place = byte;
            }
            Ok(count)
        }

        fn write_all(&mut self, _bytes: &[u8]) -> IoResult<()> {
            Ok(())
        }

        fn now(&self) -> Duration {
            self.now
        }
    }

    #[test]
    fn what_came_while_the_program_was_stopped_is_taken_before_it_gives_up() {
        let hello = Hello {
            // Another protocol's: a hello alone opens the session.
            schema_hash: 1,
            protocol_version: 1,
            clock: ClockSource::Simulated,
            ..hello()
        };
        let mut wire = [0; framing::MAX_WIRE];
        let waiting = framing::encode(&RigMessage::Hello(hello), &mut wire);
        let port = Stopped {
            now: Duration::ZERO,
            waiting: waiting.unwrap().to_vec(),
        };
        let connect = Connect {
            session: 1,
            attempts: 1,
            listens_first: false,
        };
        let client = Client::connect(&connect, Duration::ZERO);
        let port = Box::new(port);
        let event = Driver { port, client }.next_event(Duration::MAX).unwrap();
        assert!(matches!(event, Some(Event::Connected(_))), "{event:?}");
    }
}
