//! The reference signals.
//!
//! A reference is a short description that fits one message. Both ends expand it with the same
//! code, [`Reference::offset_us`], to one pulse offset per PWM frame. Offsets are whole
//! microseconds from neutral, and holds are whole frames. So the edge of every step lies on a frame
//! edge, and the host's regressor has the same input as the servo.
//!
//! | reference     | crest factor | power (f in Hz)                                    | use                         |
//! |---------------|--------------|----------------------------------------------------|-----------------------------|
//! | [`Staircase`] | 1            | falls as 1/f², no gaps                             | the paper's: step response  |
//! | [`Stairs`]    | 1.2 - 1.7    | falls as 1/f², gaps at multiples of 1/hold         | limits, levels, asymmetry   |
//! | [`Prbs`]      | 1            | even up to 0.44/chip, gap at 1/chip                | the linear response, fast   |
//! | [`Sweep`]     | 1.41         | even from its lowest to its highest frequency      | resonances, seen by eye     |
//! | [`Multisine`] | about 1.7    | on its tones only, equal on all of them            | the frequency response      |
//! | [`Steps`]     | its table's  | its table's                                        | anything else               |
//!
//! The crest factor is the largest offset over the root mean square. Since offsets change once per
//! frame, the frame's hold multiplies the power by (sin πx/πx)², x = f·20 ms: -0.6 dB at 10 Hz,
//! -3.9 dB at 25 Hz.
//!
//! Every expansion is a function of the frame's number alone, in whole numbers, with a bounded
//! number of steps. The board has no floating point unit, and after a lost frame it still needs the
//! next pulse.

mod amplitude;
mod multisine;
mod prbs;
mod sine;
mod staircase;
mod stairs;
mod steps;
mod sweep;

pub use crate::timing::HIGHEST_MILLIHERTZ;
pub use multisine::{MAX_TONES, Multisine};
pub use prbs::Prbs;
pub use staircase::Staircase;
pub use stairs::{MAX_LEVELS, Stairs};
pub use steps::{MAX_STEPS, Step, Steps};
pub use sweep::Sweep;

use amplitude::amplitude;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// A reference signal, in frames and microseconds from neutral.
///
/// New kinds are added at the end; the order of the variants is the wire format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Reference {
    /// The paper's signal: two levels, holds that get shorter.
    Staircase(Staircase),
    /// Many levels, each reached from all others.
    Stairs(Stairs),
    /// A pseudo-random binary sequence of maximal length.
    Prbs(Prbs),
    /// A sine whose frequency moves evenly.
    Sweep(Sweep),
    /// Many sines at once, repeated.
    Multisine(Multisine),
    /// A table.
    Steps(Steps),
}

impl Reference {
    /// Its name on the command line and in recordings.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Staircase(_) => "staircase",
            Self::Stairs(_) => "stairs",
            Self::Prbs(_) => "prbs",
            Self::Sweep(_) => "sweep",
            Self::Multisine(_) => "multisine",
            Self::Steps(_) => "steps",
        }
    }

    /// Length (frames).
    pub fn frames(&self) -> u32 {
        match self {
            Self::Staircase(staircase) => staircase.frames(),
            Self::Stairs(stairs) => stairs.frames(),
            Self::Prbs(prbs) => prbs.frames(),
            Self::Sweep(sweep) => sweep.frames(),
            Self::Multisine(multisine) => multisine.frames(),
            Self::Steps(steps) => steps.frames(),
        }
    }

    /// Offset from neutral in frame `frame` (µs), or `None` past the end.
    pub fn offset_us(&self, frame: u32) -> Option<i16> {
        match self {
            Self::Staircase(staircase) => staircase.offset_us(frame),
            Self::Stairs(stairs) => stairs.offset_us(frame),
            Self::Prbs(prbs) => prbs.offset_us(frame),
            Self::Sweep(sweep) => sweep.offset_us(frame),
            Self::Multisine(multisine) => multisine.offset_us(frame),
            Self::Steps(steps) => steps.offset_us(frame),
        }
    }

    /// Every offset in turn (µs).
    ///
    /// ```
    /// use servoid_protocol::reference::{Reference, Staircase};
    /// let paper = Reference::Staircase(Staircase::PAPER);
    /// assert_eq!(paper.offsets_us().filter(|offset| *offset == 50).count(), 180);
    /// ```
    pub fn offsets_us(self) -> impl Iterator<Item = i16> {
        (0..self.frames()).map_while(move |frame| self.offset_us(frame))
    }

    /// The smallest and the largest possible offset from neutral (µs), for the check of travel limits.
    pub fn extremes_us(&self) -> (i16, i16) {
        let to_both_sides = |amplitude_us| (-amplitude(amplitude_us), amplitude(amplitude_us));
        match self {
            Self::Staircase(staircase) => to_both_sides(staircase.amplitude_us),
            Self::Stairs(stairs) => to_both_sides(stairs.amplitude_us),
            Self::Prbs(prbs) => to_both_sides(prbs.amplitude_us),
            Self::Sweep(sweep) => to_both_sides(sweep.amplitude_us),
            Self::Multisine(multisine) => to_both_sides(multisine.amplitude_us),
            Self::Steps(steps) => steps.extremes_us(),
        }
    }

    /// Whether the description is valid: something moves, and it ends.
    pub fn is_well_formed(&self) -> bool {
        match self {
            Self::Staircase(staircase) => staircase.is_well_formed(),
            Self::Stairs(stairs) => stairs.is_well_formed(),
            Self::Prbs(prbs) => prbs.is_well_formed(),
            Self::Sweep(sweep) => sweep.is_well_formed(),
            Self::Multisine(multisine) => multisine.is_well_formed(),
            Self::Steps(steps) => steps.is_well_formed(),
        }
    }
}

#[cfg(test)]
mod tests;
