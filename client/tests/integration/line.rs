//! One direction of a line that does to each message what chance wants.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use std::ops::Range;
use std::time::Duration;

/// How often what happens to a message: each a probability.
#[derive(Clone, Copy, Debug, Default)]
pub struct Faults {
    pub lost: f64,
    /// Up to eight bits of it.
    pub flipped: f64,
    /// By up to half a second; others overtake it.
    pub late: f64,
    pub twice: f64,
}

impl Faults {
    /// All of them alike.
    pub fn of_rate(rate: f64) -> Self {
        Self {
            lost: rate,
            flipped: rate,
            late: rate,
            twice: rate,
        }
    }
}

/// A message takes so long at least.
const DELAY: Duration = Duration::from_millis(2);

/// What late messages are late by at most.
const LATEST: Duration = Duration::from_millis(500);

pub struct Line {
    faults: Faults,
    rng: ChaCha8Rng,
    under_way: BTreeMap<(Duration, u64), Vec<u8>>,
    sent: u64,
    /// While this lasts, nothing is let in.
    pub cut: Range<Duration>,
}

impl Line {
    pub fn new(faults: Faults, seed: u64) -> Self {
        Self {
            faults,
            rng: ChaCha8Rng::seed_from_u64(seed),
            under_way: BTreeMap::new(),
            sent: 0,
            cut: Duration::ZERO..Duration::ZERO,
        }
    }

    pub fn send(&mut self, message: &[u8], now: Duration) {
        if self.cut.contains(&now) || self.rng.random_bool(self.faults.lost) {
            return;
        }
        let mut message = message.to_vec();
        if self.rng.random_bool(self.faults.flipped) {
            for _ in 0..self.rng.random_range(1..=8) {
                let place = self.rng.random_range(0..message.len());
                message[place] ^= 1 << self.rng.random_range(0..8);
            }
        }
        if self.rng.random_bool(self.faults.twice) {
            let at = self.late(now);
            self.put(message.clone(), at);
        }
        let at = match self.rng.random_bool(self.faults.late) {
            true => self.late(now),
            false => now + DELAY,
        };
        self.put(message, at);
    }

    fn late(&mut self, now: Duration) -> Duration {
        now + DELAY + LATEST.mul_f64(self.rng.random())
    }

    fn put(&mut self, message: Vec<u8>, at: Duration) {
        self.under_way.insert((at, self.sent), message);
        self.sent += 1;
    }

    /// When the next message arrives.
    pub fn next_at(&self) -> Option<Duration> {
        self.under_way.first_key_value().map(|((at, _), _)| *at)
    }

    /// The next message that has arrived by `now`.
    pub fn receive(&mut self, now: Duration) -> Option<Vec<u8>> {
        let first = self.under_way.first_entry()?;
        (first.key().0 <= now).then(|| first.remove())
    }
}
