//! The reference signals.
//!
//! A reference is a short description that fits one message; both ends expand it with the same
//! code, [`Reference::offset_us`], to one pulse offset per PWM frame. Offsets are whole
//! microseconds from neutral, holds are whole frames: so the edge of every step lies on a frame
//! edge, and what the host puts into its regressor is what the servo was told.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// A reference signal, in frames and microseconds from neutral.
///
/// New kinds are added at the end; the order of the variants is the wire format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Reference {
    /// The paper's signal.
    Staircase(Staircase),
}

impl Reference {
    /// Length (frames).
    #[must_use]
    pub fn frames(&self) -> u32 {
        match self {
            Self::Staircase(staircase) => staircase.frames(),
        }
    }

    /// Offset from neutral in frame `frame` (µs), or `None` past the end.
    #[must_use]
    pub fn offset_us(&self, frame: u32) -> Option<i16> {
        match self {
            Self::Staircase(staircase) => staircase.offset_us(frame),
        }
    }

    /// The smallest and the largest offset from neutral (µs): what travel limits are checked against.
    #[must_use]
    pub fn extremes_us(&self) -> (i16, i16) {
        match self {
            Self::Staircase(s) => {
                let amplitude = s.amplitude_us.min(i16::MAX as u16) as i16;
                (-amplitude, amplitude)
            }
        }
    }

    /// Whether the description makes sense: something moves, and it ends.
    #[must_use]
    pub fn is_well_formed(&self) -> bool {
        match self {
            Self::Staircase(s) => {
                (1..=i16::MAX as u16).contains(&s.amplitude_us)
                    && s.hold_step_frames > 0
                    && s.shortest_hold_frames > 0
                    && s.shortest_hold_frames <= s.longest_hold_frames
            }
        }
    }
}

/// A square wave between +amplitude and -amplitude whose holds get shorter each cycle (paper §4).
///
/// Cycle `c` holds +amplitude, then -amplitude, for `longest - c·step` frames each, down to
/// `shortest`.
///
/// ```
/// use servoid_protocol::reference::Staircase;
/// let paper = Staircase::PAPER;
/// assert_eq!(paper.frames(), 360); // 7.2 s
/// assert_eq!(paper.offset_us(0), Some(50)); // +5 degrees at 10 µs per degree
/// assert_eq!(paper.offset_us(40), Some(-50)); // 800 ms later
/// assert_eq!(paper.offset_us(360), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Staircase {
    /// Offset of both levels from neutral (µs); the first level is `+amplitude_us`.
    pub amplitude_us: u16,
    /// Hold of the first cycle (frames).
    pub longest_hold_frames: u16,
    /// Hold below which no further cycle follows (frames).
    pub shortest_hold_frames: u16,
    /// What each cycle is shorter by (frames).
    pub hold_step_frames: u16,
}

impl Staircase {
    /// Paper §4: ±5 degrees (at 10 µs per degree), 800 ms down to 100 ms by 100 ms.
    pub const PAPER: Self = Self {
        amplitude_us: 50,
        longest_hold_frames: 40,
        shortest_hold_frames: 5,
        hold_step_frames: 5,
    };

    /// The holds (frames), longest first; each is held once at + and once at -.
    pub fn holds(&self) -> impl Iterator<Item = u32> + use<> {
        let (first, last) = (
            u32::from(self.longest_hold_frames),
            self.shortest_hold_frames,
        );
        let step = u32::from(self.hold_step_frames).max(1);
        // A hold of 0 frames is no hold, however the fields are set.
        let last = u32::from(last).max(1);
        let count = if first < last {
            0
        } else {
            (first - last) / step + 1
        };
        (0..count).map(move |cycle| first - cycle * step)
    }

    /// Length (frames).
    #[must_use]
    pub fn frames(&self) -> u32 {
        // Closed form of 2·Σ hold; u64, because 65 535 holds of 65 535 frames do not fit 32 bits.
        let count = self.holds().size_hint().0 as u64;
        let first = u64::from(self.longest_hold_frames);
        let step = u64::from(self.hold_step_frames.max(1));
        let total = 2 * count * first - step * count * count.saturating_sub(1);
        u32::try_from(total).unwrap_or(u32::MAX)
    }

    /// Offset from neutral in frame `frame` (µs), or `None` past the end.
    #[must_use]
    pub fn offset_us(&self, frame: u32) -> Option<i16> {
        let amplitude = i16::try_from(self.amplitude_us).unwrap_or(i16::MAX);
        let mut start = 0;
        for hold in self.holds() {
            let since = frame - start;
            if since < hold {
                return Some(amplitude);
            }
            if since < 2 * hold {
                return Some(-amplitude);
            }
            start += 2 * hold;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The paper's sentence, spelled out frame by frame.
    fn paper_by_hand() -> Vec<i16> {
        let mut offsets = Vec::new();
        for hold_ms in [800, 700, 600, 500, 400, 300, 200, 100] {
            for sign in [1, -1] {
                offsets.extend(std::iter::repeat_n(sign * 50, hold_ms / 20));
            }
        }
        offsets
    }

    #[test]
    fn the_paper_staircase_is_the_papers() {
        let reference = Reference::Staircase(Staircase::PAPER);
        let expanded: Vec<i16> = (0..).map_while(|f| reference.offset_us(f)).collect();
        assert_eq!(expanded, paper_by_hand());
        assert_eq!(reference.frames(), 360);
        assert_eq!(reference.extremes_us(), (-50, 50));
    }

    proptest! {
        #[test]
        fn length_and_expansion_agree(
            amplitude_us in 1u16..500,
            longest_hold_frames in 0u16..60,
            shortest_hold_frames in 0u16..60,
            hold_step_frames in 0u16..9,
        ) {
            let reference = Reference::Staircase(Staircase {
                amplitude_us, longest_hold_frames, shortest_hold_frames, hold_step_frames,
            });
            let expanded: Vec<i16> = (0..).map_while(|f| reference.offset_us(f)).collect();
            prop_assert_eq!(expanded.len() as u32, reference.frames());
            let (low, high) = reference.extremes_us();
            prop_assert!(expanded.iter().all(|o| (low..=high).contains(o)));
            prop_assert_eq!(expanded.is_empty(), reference.frames() == 0);
        }
    }
}
