//! Many levels, each reached from all others.

use super::amplitude::{amplitude, is_amplitude};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Most levels of [`Stairs`]: 16 make 240 strokes a cycle, more than a minute of holds.
pub const MAX_LEVELS: u16 = 16;

/// Strokes between evenly spaced levels: each cycle makes every stroke from one level to another
/// exactly once, upwards and downwards, short and long.
///
/// Every level but the outermost is reached from both sides, which shows hysteresis and the ends of
/// the travel. The strokes of each direction have sizes from 1 to `levels - 1` spacings, which shows
/// rate limits and differences of the two directions.
///
/// Level 0 is `+amplitude_us`, the last one `-amplitude_us`. A cycle goes 0 1 0 2 ... 0 m | 1 2 1 3 ... 1 m | ... and from m back to 0: an Euler circuit of the
/// complete directed graph of the levels.
///
/// * Duration: levels · (levels - 1) · hold · cycles · 20 ms.
/// * Crest factor: sqrt(3 (levels - 1)/(levels + 1)), 1.41 for five levels; all are held equally long.
/// * Spectrum: power falls as 1/f² with gaps at multiples of 1/hold.
///
/// ```
/// use servoid_protocol::reference::Stairs;
/// let stairs = Stairs { amplitude_us: 50, levels: 3, hold_frames: 15, cycles: 1 };
/// assert_eq!(stairs.frames(), 90); // 1.8 s
/// let holds: Vec<_> = (0..6).filter_map(|hold| stairs.offset_us(15 * hold)).collect();
/// assert_eq!(holds, [50, 0, 50, -50, 0, -50]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Stairs {
    /// Offset of the outermost levels from neutral (µs).
    pub amplitude_us: u16,
    /// Number of levels, 2 to [`MAX_LEVELS`].
    pub levels: u16,
    /// Hold of each level (frames).
    pub hold_frames: u16,
    /// Number of cycles.
    pub cycles: u16,
}

impl Stairs {
    /// Strokes of one cycle.
    pub fn strokes(&self) -> u32 {
        let levels = u32::from(self.levels.min(MAX_LEVELS));
        levels * levels.saturating_sub(1)
    }

    /// Length (frames).
    pub fn frames(&self) -> u32 {
        self.strokes()
            .saturating_mul(self.hold_frames.into())
            .saturating_mul(self.cycles.into())
    }

    /// Offset from neutral in frame `frame` (µs), or `None` past the end.
    pub fn offset_us(&self, frame: u32) -> Option<i16> {
        if frame >= self.frames() {
            return None;
        }
        // Neither is zero, or there would be no frame.
        let hold = frame.checked_div(self.hold_frames.into())?;
        Some(self.level_us(self.level_of(hold.checked_rem(self.strokes())?)))
    }

    /// The level of hold `hold` of a cycle.
    fn level_of(&self, hold: u32) -> u16 {
        let last = self.levels.min(MAX_LEVELS).saturating_sub(1);
        let mut within = hold;
        for low in 0..last {
            let block = 2 * u32::from(last - low);
            if within < block {
                let partner = low + 1 + (within / 2) as u16;
                let is_low = within.is_multiple_of(2);
                return if is_low { low } else { partner };
            }
            within -= block;
        }
        0
    }

    /// Offset of level `level` (µs): rounded to the nearest microsecond, the same on both sides.
    fn level_us(&self, level: u16) -> i16 {
        let spacings = i32::from(self.levels.min(MAX_LEVELS)).max(2) - 1;
        let product = i32::from(amplitude(self.amplitude_us)) * (spacings - 2 * i32::from(level));
        let rounded = (product.abs() + spacings / 2) / spacings;
        (product.signum() * rounded) as i16
    }

    /// Whether something moves, it ends, and no two levels are one.
    pub fn is_well_formed(&self) -> bool {
        is_amplitude(self.amplitude_us)
            && (2..=MAX_LEVELS).contains(&self.levels)
            && u32::from(self.levels - 1) <= 2 * u32::from(self.amplitude_us)
            && self.hold_frames > 0
            && self.cycles > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn a_cycle_makes_every_stroke_once_and_closes() {
        for levels in 2..=MAX_LEVELS {
            let stairs = Stairs {
                amplitude_us: 300,
                levels,
                hold_frames: 2,
                cycles: 2,
            };
            let holds: Vec<i16> = (0..stairs.frames())
                .step_by(2)
                .map(|frame| stairs.offset_us(frame).unwrap())
                .collect();
            let cycle = stairs.strokes() as usize;
            assert_eq!(holds.len(), 2 * cycle);
            let strokes: HashSet<_> = holds[..=cycle].windows(2).map(|w| (w[0], w[1])).collect();
            assert_eq!(strokes.len(), cycle);
            assert!(strokes.iter().all(|(from, to)| from != to));
            assert_eq!(holds[..cycle], holds[cycle..]);
            let mut visited: Vec<i16> = holds.clone();
            visited.sort_unstable();
            visited.dedup();
            assert_eq!(visited.len(), usize::from(levels));
            // Symmetric about neutral, rounding included.
            assert!(visited.iter().rev().map(|v| -v).eq(visited.iter().copied()));
        }
    }
}
