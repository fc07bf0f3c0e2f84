//! The paper's staircase.

use super::amplitude::{amplitude, is_amplitude};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// A square wave whose holds get shorter in each cycle (paper §4).
///
/// Cycle `c` holds +amplitude, then -amplitude, for `longest - c·step` frames each, down to
/// `shortest`.
///
/// * Duration: 2 Σ holds · 20 ms.
/// * Crest factor: 1.
/// * Spectrum: power falls as 1/f², as that of single steps does; the changing holds leave no gap.
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
    /// Difference of the holds of two cycles (frames).
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
        let first = u32::from(self.longest_hold_frames);
        // A hold of 0 frames is no hold, however the fields are set.
        let last = u32::from(self.shortest_hold_frames).max(1);
        let step = u32::from(self.hold_step_frames).max(1);
        let count = first.checked_sub(last).map_or(0, |range| range / step + 1);
        (0..count).map(move |cycle| first - cycle * step)
    }

    /// Length (frames).
    pub fn frames(&self) -> u32 {
        // Closed form of 2·Σ hold; u64, because 65 535 holds of 65 535 frames do not fit 32 bits.
        let count = self.holds().size_hint().0 as u64;
        let first = u64::from(self.longest_hold_frames);
        let step = u64::from(self.hold_step_frames.max(1));
        let total = 2 * count * first - step * count * count.saturating_sub(1);
        u32::try_from(total).unwrap_or(u32::MAX)
    }

    /// Offset from neutral in frame `frame` (µs), or `None` past the end.
    pub fn offset_us(&self, frame: u32) -> Option<i16> {
        let amplitude = amplitude(self.amplitude_us);
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

    /// Whether something moves and it ends.
    pub fn is_well_formed(&self) -> bool {
        is_amplitude(self.amplitude_us)
            && self.hold_step_frames > 0
            && self.shortest_hold_frames > 0
            && self.shortest_hold_frames <= self.longest_hold_frames
    }
}
