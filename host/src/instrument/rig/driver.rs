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
