//! A table of steps.

use crate::framing::MAX_PAYLOAD;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Most bytes of a 16-bit number in postcard: 7 bits go into each byte.
const U16_BYTES: usize = (u16::BITS as usize).div_ceil(7);

/// Most bytes of a [`Start`](crate::message::Start) request beside the table: session, id, run,
/// pre-roll, post-roll and repeats are 16-bit numbers, command and reference one byte each.
const BESIDE_THE_TABLE: usize = 6 * U16_BYTES + 2;

/// Most steps of a table: as many as one message carries, whatever their numbers.
pub const MAX_STEPS: usize = (MAX_PAYLOAD - BESIDE_THE_TABLE) / (2 * U16_BYTES);

/// One line of a table: an offset and its hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Step {
    /// Offset from neutral (µs).
    pub offset_us: i16,
    /// Its hold (frames). A hold of no frames is past the table's end.
    pub hold_frames: u16,
}

/// A table of at most [`MAX_STEPS`] steps, played several times.
///
/// * Duration: repeats · Σ holds · 20 ms.
/// * Crest factor and spectrum: the table's own.
///
/// ```
/// use servoid_protocol::reference::{Step, Steps};
/// let doublet = [(50, 20), (-50, 20), (0, 40)].map(|(offset_us, hold_frames)| Step { offset_us, hold_frames });
/// let steps = Steps::new(3, &doublet).unwrap();
/// assert_eq!(steps.frames(), 240); // 4.8 s
/// assert_eq!(steps.offset_us(100), Some(-50));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Steps {
    /// How often the table is played.
    pub repeats: u16,
    /// The steps, then zeros.
    pub table: [Step; MAX_STEPS],
}

impl Steps {
    /// The table `steps`, played `repeats` times; `None` where it has more than [`MAX_STEPS`].
    pub fn new(repeats: u16, steps: &[Step]) -> Option<Self> {
        let mut table = [Step::default(); MAX_STEPS];
        table.get_mut(..steps.len())?.copy_from_slice(steps);
        Some(Self { repeats, table })
    }

    /// The steps that are held.
    pub fn held(&self) -> impl Iterator<Item = &Step> {
        self.table.iter().take_while(|step| step.hold_frames > 0)
    }

    /// Frames of the table played once.
    fn frames_once(&self) -> u32 {
        self.held().map(|step| u32::from(step.hold_frames)).sum()
    }

    /// Length (frames).
    pub fn frames(&self) -> u32 {
        self.frames_once().saturating_mul(self.repeats.into())
    }

    /// Offset from neutral in frame `frame` (µs), or `None` past the end.
    pub fn offset_us(&self, frame: u32) -> Option<i16> {
        if frame >= self.frames() {
            return None;
        }
        let mut within = frame.checked_rem(self.frames_once())?;
        for step in self.held() {
            match within.checked_sub(step.hold_frames.into()) {
                None => return Some(step.offset_us),
                Some(after) => within = after,
            }
        }
        None
    }

    /// The smallest and the largest offset (µs).
    pub fn extremes_us(&self) -> (i16, i16) {
        let offsets = || self.held().map(|step| step.offset_us);
        (offsets().min().unwrap_or(0), offsets().max().unwrap_or(0))
    }

    /// Whether something moves, it ends, and nothing stands behind the table's end.
    pub fn is_well_formed(&self) -> bool {
        let behind = self.table.iter().skip_while(|step| step.hold_frames > 0);
        self.held().any(|step| step.offset_us != 0)
            && self.repeats > 0
            && behind.copied().all(|step| step == Step::default())
    }
}
