//! The last frames of the run, for sending and for sending again.

use core::num::NonZeroU16;
use core::ops::Range;
use servoid_protocol::timing::{FRAMES_PER_SECOND, SAMPLES_PER_FRAME};
use servoid_protocol::{Counts, Frame, PulseWidth};

/// Longest break of the link without a loss, with the usual train of pulses (s): enough to plug a cable in again. With
/// the shortest frames, of 15 ms, it is 3.8 s.
const SECONDS: u32 = 5;

/// Frames that stay in memory: a power of two, so the place of a frame is cheap to compute.
pub const CAPACITY: usize = (SECONDS * FRAMES_PER_SECOND).next_power_of_two() as usize;

/// A stored frame: 22 bytes, and as many for a lost one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Record {
    pulse: NonZeroU16,
    samples: [Counts; SAMPLES_PER_FRAME],
}

const _: () = assert!(size_of::<Option<Record>>() == 2 * (1 + SAMPLES_PER_FRAME));

/// The last [`CAPACITY`] frames of one run.
#[derive(Debug)]
#[cfg_attr(test, derive(Clone))]
pub struct History {
    run: Option<u16>,
    /// Index of the next frame: all below were captured or lost.
    next: u16,
    /// Frame `index` lies at `index % CAPACITY`; `None` for one that the board lost.
    records: [Option<Record>; CAPACITY],
}

impl Default for History {
    /// An empty history.
    fn default() -> Self {
        Self {
            run: None,
            next: 0,
            records: [None; CAPACITY],
        }
    }
}

impl History {
    /// Clears the history and begins that of `run`.
    pub fn begin(&mut self, run: u16) {
        self.run = Some(run);
        self.next = 0;
    }

    /// The run that the frames belong to.
    pub fn run(&self) -> Option<u16> {
        self.run
    }

    /// Indices of the frames in memory, lost ones included.
    pub fn indices(&self) -> Range<u16> {
        self.next.saturating_sub(CAPACITY as u16)..self.next
    }

    /// Adds the next frame; `None` for one that the board lost. A frame without a pulse, or with one of zero width,
    /// counts as lost.
    pub fn push(&mut self, caught: Option<(PulseWidth, [Counts; SAMPLES_PER_FRAME])>) {
        let record = caught.and_then(|(pulse, samples)| {
            let pulse = NonZeroU16::new(pulse.0)?;
            Some(Record { pulse, samples })
        });
        if let Some(place) = self.records.get_mut(usize::from(self.next) % CAPACITY) {
            *place = record;
        }
        self.next = self.next.saturating_add(1);
    }

    /// The first frame of `wanted` that is in memory.
    pub fn first_of(&self, wanted: &Range<u16>) -> Option<Frame> {
        let here = self.indices();
        (wanted.start.max(here.start)..wanted.end.min(here.end)).find_map(|index| self.get(index))
    }

    fn get(&self, index: u16) -> Option<Frame> {
        let record = (*self.records.get(usize::from(index) % CAPACITY)?)?;
        Some(Frame {
            run: self.run?,
            index,
            pulse: PulseWidth(record.pulse.get()),
            samples: record.samples,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_history_is_long_enough_and_as_small_as_promised() {
        assert!(CAPACITY as u32 >= 5 * FRAMES_PER_SECOND);
        assert!(size_of::<History>() <= CAPACITY * 22 + 8);
    }

    #[test]
    fn a_new_run_sees_nothing_of_the_one_before() {
        let mut history = History::default();
        history.begin(1);
        history.push(Some((PulseWidth(1_500), [Counts(1); 10])));
        history.begin(2);
        assert_eq!(history.first_of(&(0..u16::MAX)), None);
        history.push(Some((PulseWidth(1_500), [Counts(2); 10])));
        let frame = history.first_of(&(0..1)).unwrap();
        assert_eq!(
            (frame.run, frame.index, frame.samples[0]),
            (2, 0, Counts(2))
        );
    }

    /// Every pattern of eight caught and lost frames on both sides of the place where the memory begins anew, and every
    /// stretch around it that may be asked for.
    #[test]
    fn every_pattern_of_losses_around_the_end_of_the_memory() {
        let before = CAPACITY as u16 - 4;
        for pattern in 0..=u8::MAX {
            let caught = |index: u16| index < before || pattern >> (index - before) & 1 == 1;
            let mut history = History::default();
            history.begin(7);
            for index in 0..before + 8 {
                let frame = (PulseWidth(1_500), [Counts(index); SAMPLES_PER_FRAME]);
                history.push(caught(index).then_some(frame));
            }
            let here = history.indices();
            assert_eq!(here, 4..before + 8);
            let places = (0..8).chain(before - 2..before + 10);
            for start in places.clone() {
                for end in places.clone() {
                    let here = start.max(here.start)..end.min(here.end);
                    let expected = here.clone().find(|&index| caught(index));
                    let found = history.first_of(&(start..end));
                    let found = found.map(|frame| (frame.index, frame.samples[0]));
                    assert_eq!(found, expected.map(|index| (index, Counts(index))));
                }
            }
        }
    }

    proptest! {
        /// Against the obvious: a list of everything that ever came.
        #[test]
        fn what_is_here_is_what_came_last(
            came in proptest::collection::vec(proptest::option::weighted(0.9, (1u16..3_000, any::<u16>())), 0..700),
            wanted in (0u16..700, 0u16..700),
        ) {
            let mut history = History::default();
            history.begin(7);
            let frames: Vec<Option<Frame>> = came.iter().enumerate().map(|(index, caught)| {
                history.push(caught.map(|(pulse, counts)| (PulseWidth(pulse), [Counts(counts); 10])));
                caught.map(|(pulse, counts)| Frame {
                    run: 7, index: index as u16, pulse: PulseWidth(pulse), samples: [Counts(counts); 10],
                })
            }).collect();
            let here = frames.len().saturating_sub(CAPACITY)..frames.len();
            prop_assert_eq!(history.indices(), here.start as u16..here.end as u16);
            let expected = frames[here].iter().flatten()
                .find(|frame| (wanted.0..wanted.1).contains(&frame.index)).copied();
            prop_assert_eq!(history.first_of(&(wanted.0..wanted.1)), expected);
        }
    }
}
