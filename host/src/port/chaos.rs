//! A bad line, on purpose: to prove what survives it.
//!
//! ```text
//!  host <--> [ChaosPort: by chance, frame by frame] <--> any Port
//! ```
//!
//! Everything is drawn from one seed, and happens in the time of the port behind it: equal seeds in
//! front of equal simulated rigs give equal bytes. What counts is frames, not bytes: a *frame* is
//! what lies between two zero bytes.
//!
//! | fate        | what becomes of the frame                                                       |
//! |-------------|---------------------------------------------------------------------------------|
//! | lost        | nothing of it arrives                                                           |
//! | corrupted   | bits flip, or its end is missing, or strange bytes are in it; its zeros may be hit |
//! | duplicated  | it arrives once more, up to half a second later                                 |
//! | reordered   | it arrives late by up to half a second, behind those that set out meanwhile     |
//! | stalled     | it and everything behind it arrive late                                         |
//!
//! Whatever arrives is handed over in pieces of any size.

use super::Port;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use std::time::Duration;

/// How often what happens to a frame in one direction: each a probability.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Faults {
    /// It is lost.
    pub lost: f64,
    /// It is corrupted.
    pub corrupted: f64,
    /// It comes twice.
    pub duplicated: f64,
    /// It is late by up to [`LATEST`]; those after it are not, unless chance wants it of each: frames
    /// are reordered one by one.
    pub reordered: f64,
    /// The line stands still for up to [`LONGEST_STALL`].
    pub stalled: f64,
}

/// The latest that a reordered frame or a duplicate comes.
pub const LATEST: Duration = Duration::from_millis(500);

/// The longest that the line stands still.
pub const LONGEST_STALL: Duration = Duration::from_millis(700);

impl Faults {
    /// A line that loses this share of the frames and corrupts the same share, with every other
    /// kind of trouble thrown in.
    #[must_use]
    pub fn of_rate(rate: f64) -> Self {
        Self {
            lost: rate,
            corrupted: rate,
            duplicated: rate,
            reordered: rate,
            stalled: rate / 10.0,
        }
    }
}

/// A port in front of another one, that does to every frame what chance wants.
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

/// One direction.
struct Lane {
    faults: Faults,
    rng: ChaCha8Rng,
    /// The frame that is coming in, without its zeros.
    coming: Vec<u8>,
    /// On the way, by the time at which they arrive and the order in which they set out.
    on_the_way: BTreeMap<(Duration, u64), Vec<u8>>,
    set_out: u64,
    /// Nothing arrives before this.
    stands_until: Duration,
    arrived: std::collections::VecDeque<u8>,
}

impl Lane {
    fn new(faults: Faults, rng: &mut impl Rng) -> Self {
        Self {
            faults,
            rng: ChaCha8Rng::seed_from_u64(rng.next_u64()),
            coming: Vec::new(),
            on_the_way: BTreeMap::new(),
            set_out: 0,
            stands_until: Duration::ZERO,
            arrived: std::collections::VecDeque::new(),
        }
    }

    fn push(&mut self, byte: u8, now: Duration) {
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

    fn decide(&mut self, mut frame: Vec<u8>, now: Duration) {
        let faults = self.faults;
        if self.happens(faults.stalled) {
            let until = now + LONGEST_STALL.mul_f64(self.rng.random());
            self.stands_until = self.stands_until.max(until);
        }
        if self.happens(faults.lost) {
            return;
        }
        if self.happens(faults.corrupted) {
            self.corrupt(&mut frame);
        }
        let on_time = now.max(self.stands_until);
        if self.happens(faults.duplicated) {
            let late = on_time + LATEST.mul_f64(self.rng.random());
            self.send(frame.clone(), late);
        }
        let mut at = on_time;
        if self.happens(faults.reordered) {
            at += LATEST.mul_f64(self.rng.random());
        }
        self.send(frame, at);
    }

    fn send(&mut self, frame: Vec<u8>, at: Duration) {
        self.on_the_way.insert((at, self.set_out), frame);
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

    /// What has arrived by `now`, at most `most` bytes of it.
    fn take(&mut self, now: Duration, most: usize) -> Vec<u8> {
        while let Some(first) = self.on_the_way.first_entry()
            && first.key().0 <= now
        {
            self.arrived.extend(first.remove());
        }
        let count = most.min(self.arrived.len());
        self.arrived.drain(..count).collect()
    }

    /// When something more arrives.
    fn next_at(&self) -> Option<Duration> {
        self.on_the_way.first_key_value().map(|((at, _), _)| *at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use servoid_protocol::{Counts, Frame, PulseWidth};
    use servoid_protocol::{Decoder, RigMessage, framing};

    /// Time that passes by reading, and 1000 frames that come at 20 ms each.
    struct Stream {
        now: Duration,
        sent: u16,
    }

    impl Port for Stream {
        fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> std::io::Result<usize> {
            let next = Duration::from_millis(20) * u32::from(self.sent);
            if self.sent == 1000 || self.now + timeout < next {
                self.now += timeout;
                return Ok(0);
            }
            self.now = self.now.max(next);
            let mut wire = [0; framing::MAX_WIRE];
            let wire = framing::encode(&frame(self.sent), &mut wire).unwrap();
            buffer[..wire.len()].copy_from_slice(wire);
            self.sent += 1;
            Ok(wire.len())
        }

        fn write_all(&mut self, _bytes: &[u8]) -> std::io::Result<()> {
            Ok(())
        }

        fn now(&self) -> Duration {
            self.now
        }
    }

    fn frame(index: u16) -> RigMessage {
        RigMessage::Frame(Frame {
            run: 1,
            index,
            pulse: PulseWidth(1500),
            samples: [Counts(index.wrapping_mul(31) % 16_000); 10],
        })
    }

    /// The indices that arrive, in order, and how many frames could not be read.
    fn arrivals(faults: Faults) -> (Vec<u16>, u32) {
        let stream = Stream {
            now: Duration::ZERO,
            sent: 0,
        };
        let mut port = ChaosPort::new(stream, 7, Faults::default(), faults);
        let (mut decoder, mut indices) = (Decoder::new(), Vec::new());
        let mut buffer = [0; 50];
        while port.now() < Duration::from_secs(25) {
            let count = port.read(&mut buffer, Duration::from_millis(50)).unwrap();
            for &byte in &buffer[..count] {
                if let Some(RigMessage::Frame(frame)) = decoder.push(byte) {
                    indices.push(frame.index);
                }
            }
        }
        (indices, decoder.rejects().total())
    }

    #[test]
    fn a_line_without_faults_changes_nothing() {
        let (indices, rejects) = arrivals(Faults::default());
        assert!(indices.into_iter().eq(0..1000));
        assert_eq!(rejects, 0);
    }

    #[test]
    fn each_fault_does_what_it_says_as_often_as_it_says() {
        let none = Faults::default();
        // 1000 draws at 10 %: a standard deviation of 9.5; five of them on both sides.
        let about_a_tenth = 52..=148;
        let (lost, rejects) = arrivals(Faults { lost: 0.1, ..none });
        assert!(about_a_tenth.contains(&(1000 - lost.len())) && rejects == 0);
        let (hit, rejects) = arrivals(Faults {
            corrupted: 0.1,
            ..none
        });
        assert!(about_a_tenth.contains(&(1000 - hit.len())), "{}", hit.len());
        assert!(rejects > 0);
        let (twice, _) = arrivals(Faults {
            duplicated: 0.1,
            ..none
        });
        assert!(about_a_tenth.contains(&(twice.len() - 1000)));
        let (late, _) = arrivals(Faults {
            reordered: 0.1,
            ..none
        });
        let out_of_order = late.windows(2).filter(|w| w[1] < w[0]).count();
        assert!(
            late.len() == 1000 && about_a_tenth.contains(&out_of_order),
            "{out_of_order}"
        );
        let (held_up, _) = arrivals(Faults {
            stalled: 0.1,
            ..none
        });
        assert!(held_up.into_iter().eq(0..1000), "late, and in order");
    }
}
