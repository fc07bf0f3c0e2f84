//! One direction of a bad line: the fate of each frame, and its time of arrival.

use super::faults::{Faults, LATEST, LONGEST_BURST, LONGEST_STALL};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

/// One direction.
pub(super) struct Lane {
    faults: Faults,
    rng: ChaCha8Rng,
    /// The frame that is coming in, without its zeros.
    coming: Vec<u8>,
    on_the_way: BTreeMap<Arrival, Vec<u8>>,
    set_out: u64,
    /// Nothing arrives before this.
    stands_until: Duration,
    /// The burst that the next frame is part of.
    burst: Option<Burst>,
    arrived: VecDeque<u8>,
}

/// When a frame arrives; earlier ones are smaller.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Arrival {
    at: Duration,
    /// Its place among the frames of a burst, by chance; 0 for all others.
    shuffle: u32,
    /// Its place among all frames.
    set_out: u64,
}

/// Frames that arrive all at once, in a mixed order.
struct Burst {
    arrives: Duration,
    /// Frames that are still to come into it.
    left: u32,
}

impl Lane {
    pub(super) fn new(faults: Faults, rng: &mut impl Rng) -> Self {
        Self {
            faults,
            rng: ChaCha8Rng::seed_from_u64(rng.next_u64()),
            coming: Vec::new(),
            on_the_way: BTreeMap::new(),
            set_out: 0,
            stands_until: Duration::ZERO,
            burst: None,
            arrived: VecDeque::new(),
        }
    }

    /// Takes a byte in that sets out at `now`.
    pub(super) fn push(&mut self, byte: u8, now: Duration) {
        if byte != 0 {
            self.coming.push(byte);
        } else if !self.coming.is_empty() {
            let mut frame = vec![0];
            frame.append(&mut self.coming);
            frame.push(0);
            self.decide(frame, now);
        }
    }

    fn happens(&mut self, probability: f64) -> bool {
        self.rng.random_bool(probability)
    }

    fn late(&mut self) -> Duration {
        LATEST.mul_f64(self.rng.random())
    }

    fn decide(&mut self, mut frame: Vec<u8>, now: Duration) {
        let faults = self.faults;
        if self.happens(faults.stalled) {
            let until = now + LONGEST_STALL.mul_f64(self.rng.random());
            self.stands_until = self.stands_until.max(until);
        }
        let on_time = now.max(self.stands_until);
        if self.burst.is_none() && self.happens(faults.burst) {
            self.burst = Some(Burst {
                arrives: on_time + self.late(),
                left: self.rng.random_range(2..=LONGEST_BURST),
            });
        }
        let burst = self.next_of_burst(on_time);
        if self.happens(faults.lost) {
            return;
        }
        if self.happens(faults.corrupted) {
            self.corrupt(&mut frame);
        }
        if self.happens(faults.duplicated) {
            let late = on_time + self.late();
            self.send(frame.clone(), late, 0);
        }
        if let Some(arrives) = burst {
            let shuffle = self.rng.random();
            self.send(frame, arrives, shuffle);
        } else if self.happens(faults.reordered) {
            let late = on_time + self.late();
            self.send(frame, late, 0);
        } else {
            self.send(frame, on_time, 0);
        }
    }

    /// When the burst arrives that a frame is part of which would arrive at `on_time`. A frame that
    /// would come later than the burst ends it.
    fn next_of_burst(&mut self, on_time: Duration) -> Option<Duration> {
        let burst = self.burst.as_mut().filter(|b| on_time <= b.arrives);
        let Some(burst) = burst else {
            self.burst = None;
            return None;
        };
        let arrives = burst.arrives;
        burst.left -= 1;
        if burst.left == 0 {
            self.burst = None;
        }
        Some(arrives)
    }

    fn send(&mut self, frame: Vec<u8>, at: Duration, shuffle: u32) {
        let set_out = self.set_out;
        let arrival = Arrival {
            at,
            shuffle,
            set_out,
        };
        self.on_the_way.insert(arrival, frame);
        self.set_out += 1;
    }

    fn corrupt(&mut self, frame: &mut Vec<u8>) {
        let place = self.rng.random_range(0..frame.len());
        match self.rng.random_range(0..4) {
            0 => frame.truncate(place),
            1 => {
                let strange: Vec<u8> = (0..self.rng.random_range(1..200))
                    .map(|_| self.rng.random())
                    .collect();
                frame.splice(place..place, strange);
            }
            _ => {
                for _ in 0..self.rng.random_range(1..=8) {
                    let place = self.rng.random_range(0..frame.len());
                    if let Some(byte) = frame.get_mut(place) {
                        *byte ^= 1 << self.rng.random_range(0..8);
                    }
                }
            }
        }
    }

    /// The bytes that have arrived by `now`, at most `most`.
    pub(super) fn take(&mut self, now: Duration, most: usize) -> Vec<u8> {
        while let Some(first) = self.on_the_way.first_entry()
            && first.key().at <= now
        {
            self.arrived.extend(first.remove());
        }
        let count = most.min(self.arrived.len());
        self.arrived.drain(..count).collect()
    }

    /// When something more arrives.
    pub(super) fn next_at(&self) -> Option<Duration> {
        self.on_the_way.first_key_value().map(|(first, _)| first.at)
    }
}
