//! A bad line on purpose, to test what depends on it.
//!
//! ```text
//!  host <--> [ChaosPort: by chance, frame by frame] <--> any Port
//! ```
//!
//! Everything is drawn from one seed, and happens in the time of the port behind it: equal seeds in
//! front of equal simulated rigs give equal bytes. It acts on frames, not bytes: a *frame* is all
//! between two zero bytes.
//!
//! | fate        | effect on the frame                                                             |
//! |-------------|---------------------------------------------------------------------------------|
//! | lost        | nothing of it arrives                                                           |
//! | corrupted   | bits flip, or its end is missing, or strange bytes are in it; its zeros may be hit |
//! | duplicated  | it arrives once more, up to half a second later                                 |
//! | reordered   | it arrives late by up to half a second, behind those that set out meanwhile     |
//! | burst       | it and up to 24 that follow it arrive up to half a second later, all at once, mixed up |
//! | stalled     | it and everything behind it arrive late                                         |
//!
//! A frame that is sent after the last one of a burst may overtake all of it. Whatever arrives is
//! handed over in pieces of any size.

mod faults;
mod lane;

use lane::Lane;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use servoid::instrument::port::Port;
use std::time::Duration;

pub use faults::Faults;

/// A port in front of another one. The fate of each frame is random.
pub struct ChaosPort<P> {
    inner: P,
    to_rig: Lane,
    to_host: Lane,
    rng: ChaCha8Rng,
}

impl<P: Port> ChaosPort<P> {
    /// A bad line in front of `inner`.
    pub fn new(inner: P, seed: u64, to_rig: Faults, to_host: Faults) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        Self {
            inner,
            to_rig: Lane::new(to_rig, &mut rng),
            to_host: Lane::new(to_host, &mut rng),
            rng,
        }
    }

    /// The port behind it.
    pub fn inner(&mut self) -> &mut P {
        &mut self.inner
    }

    fn deliver_to_rig(&mut self) -> std::io::Result<()> {
        let due = self.to_rig.take(self.inner.now(), usize::MAX);
        if due.is_empty() {
            return Ok(());
        }
        self.inner.write_all(&due)
    }
}

impl<P: Port> Port for ChaosPort<P> {
    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> std::io::Result<usize> {
        let deadline = self.inner.now() + timeout;
        loop {
            self.deliver_to_rig()?;
            let now = self.inner.now();
            let piece = self.rng.random_range(1..=buffer.len().max(1));
            let due = self.to_host.take(now, piece.min(buffer.len()));
            if !due.is_empty() || now >= deadline {
                buffer
                    .iter_mut()
                    .zip(&due)
                    .for_each(|(slot, byte)| *slot = *byte);
                return Ok(due.len());
            }
            let next = [self.to_rig.next_at(), self.to_host.next_at()];
            let wake = next.into_iter().flatten().fold(deadline, Duration::min);
            let mut received = [0; 64];
            let count = self.inner.read(&mut received, wake.saturating_sub(now))?;
            let now = self.inner.now();
            for &byte in received.iter().take(count) {
                self.to_host.push(byte, now);
            }
        }
    }

    fn write_all(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        let now = self.inner.now();
        for &byte in bytes {
            self.to_rig.push(byte, now);
        }
        self.deliver_to_rig()
    }

    fn now(&self) -> Duration {
        self.inner.now()
    }
}

#[cfg(test)]
mod tests;
