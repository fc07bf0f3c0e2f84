use super::faults::{LATEST, LONGEST_BURST};
use super::*;
use servoid_protocol::timing::FRAME_US;
use servoid_protocol::{Counts, Frame, PulseWidth};
use servoid_protocol::{Decoder, RigMessage, framing};
use std::collections::BTreeSet;

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

/// A line of these faults in front of the 1000 frames.
fn line(seed: u64, faults: Faults) -> ChaosPort<Stream> {
    let stream = Stream {
        now: Duration::ZERO,
        sent: 0,
    };
    ChaosPort::new(stream, seed, Faults::default(), faults)
}

/// The bytes that arrive within 25 s, with their times.
fn bytes(port: &mut ChaosPort<Stream>) -> Vec<(Duration, u8)> {
    let (mut bytes, mut buffer) = (Vec::new(), [0; 50]);
    while port.now() < Duration::from_secs(25) {
        let count = port.read(&mut buffer, Duration::from_millis(50)).unwrap();
        bytes.extend(buffer[..count].iter().map(|&byte| (port.now(), byte)));
    }
    bytes
}

/// The indices that arrive, in order, and how many frames could not be read.
fn arrivals(faults: Faults) -> (Vec<u16>, u32) {
    let (timed, rejects) = timed_arrivals(faults);
    (timed.into_iter().map(|(_, index)| index).collect(), rejects)
}

/// The same, with when each of them arrives.
fn timed_arrivals(faults: Faults) -> (Vec<(Duration, u16)>, u32) {
    let mut decoder = Decoder::new();
    let mut indices = Vec::new();
    for (at, byte) in bytes(&mut line(7, faults)) {
        if let Some(RigMessage::Frame(frame)) = decoder.push(byte) {
            indices.push((at, frame.index));
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

#[test]
fn a_burst_is_many_frames_at_once_in_a_mixed_order_behind_later_ones() {
    let faults = Faults {
        burst: 0.02,
        ..Faults::default()
    };
    let (arrived, rejects) = timed_arrivals(faults);
    let indices: BTreeSet<u16> = arrived.iter().map(|(_, index)| *index).collect();
    assert!(arrived.len() == 1000 && indices.len() == 1000 && rejects == 0);
    // Late by a frame and more: those of bursts, and nothing else.
    let sent_at = |index: u16| Duration::from_micros(u64::from(FRAME_US)) * u32::from(index);
    let late = |(at, index): &(Duration, u16)| *at >= sent_at(*index + 1);
    assert!(
        arrived
            .iter()
            .all(|(at, index)| *at <= sent_at(*index) + LATEST)
    );
    let bursts: Vec<&[(Duration, u16)]> = arrived
        .chunk_by(|a, b| late(a) && late(b) && a.0 == b.0)
        .filter(|together| together.len() > 1)
        .collect();
    assert!(bursts.len() >= 5, "{}", bursts.len());
    let longest = bursts.iter().map(|burst| burst.len()).max();
    assert!(longest > Some(10) && longest <= Some(LONGEST_BURST as usize));
    let mixed = |burst: &&&[(Duration, u16)]| !burst.is_sorted();
    assert!(bursts.iter().filter(mixed).count() >= 5);
    let overtaken = |burst: &&&[(Duration, u16)]| {
        let newest = burst.iter().map(|frame| frame.1).max();
        arrived
            .iter()
            .take_while(|frame| frame.0 < burst[0].0)
            .any(|frame| Some(frame.1) > newest)
    };
    assert!(bursts.iter().filter(overtaken).count() >= 3);
}

#[test]
fn equal_seeds_give_equal_bytes_at_equal_times() {
    let faults = Faults::of_rate(0.05);
    let first = bytes(&mut line(1, faults));
    assert_eq!(first, bytes(&mut line(1, faults)));
    assert_ne!(first, bytes(&mut line(2, faults)));
}
