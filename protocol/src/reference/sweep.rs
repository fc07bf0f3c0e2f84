//! A sine whose frequency moves evenly.

use super::amplitude::{amplitude, is_amplitude};
use super::sine::{ONE, sine};
use crate::timing::{FRAMES_PER_SECOND, HIGHEST_MILLIHERTZ};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// A linear chirp from `first_millihertz` to `last_millihertz`, upwards or downwards.
///
/// Frequencies are in cycles per 50 000 frames, which is mHz with the usual frame of 20 ms; with another frame the host
/// scales them.
///
/// Frame k of K has A sin 2π(f₀ k + (f₁ - f₀) k²/2K)·20 ms, rounded to whole microseconds. The phase
/// is exact to 1/65536 turn and the sine to 1.1e-4 of the amplitude, both far below the rounding.
///
/// * Duration: frames · 20 ms.
/// * Crest factor: sqrt 2.
/// * Spectrum: even between the two frequencies; beyond them it falls off within about
///   sqrt(|f₁ - f₀|/duration) Hz.
///
/// ```
/// use servoid_protocol::reference::Sweep;
/// // 1 Hz all the way: 50 frames a turn.
/// let sweep = Sweep { amplitude_us: 50, first_millihertz: 1_000, last_millihertz: 1_000, frames: 100 };
/// let quarter: Vec<_> = [0, 12, 25, 38, 50].iter().filter_map(|k| sweep.offset_us(*k)).collect();
/// assert_eq!(quarter, [0, 50, 0, -50, 0]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Sweep {
    /// Amplitude of the sine (µs).
    pub amplitude_us: u16,
    /// Frequency at the beginning (mHz), at most half the frame rate.
    pub first_millihertz: u16,
    /// Frequency at the end (mHz), at most half the frame rate.
    pub last_millihertz: u16,
    /// Length (frames).
    pub frames: u16,
}

impl Sweep {
    /// Length (frames).
    pub fn frames(&self) -> u32 {
        self.frames.into()
    }

    /// Offset from neutral in frame `frame` (µs), or `None` past the end.
    pub fn offset_us(&self, frame: u32) -> Option<i16> {
        if frame >= self.frames() {
            return None;
        }
        // Within i32: the amplitude has 15 bits, the sine 16 with its sign, and one half is added.
        let product = i32::from(amplitude(self.amplitude_us)) * sine(self.turns(frame));
        let rounded = (product.abs() + ONE / 2) / ONE;
        Some((product.signum() * rounded) as i16)
    }

    /// The phase in frame k (1/65536 turn).
    ///
    /// In turns it is k (f₀ (2K - k) + f₁ k)/(2K · frame rate), where no term is negative. With mHz
    /// and 16-bit lengths the numerator is below 2^49 and the denominator below 2^33, so the
    /// remainder can be scaled by 2^16 within 64 bits.
    fn turns(&self, k: u32) -> u16 {
        let (k, length) = (u64::from(k), u64::from(self.frames));
        let first = u64::from(self.first_millihertz);
        let last = u64::from(self.last_millihertz);
        let whole = 2 * length * 1_000 * u64::from(FRAMES_PER_SECOND);
        let turns = k * (first * (2 * length).saturating_sub(k) + last * k);
        let part = turns.checked_rem(whole).unwrap_or(0);
        // A phase that rounds to a whole turn is none.
        (((part << 16) + whole / 2).checked_div(whole).unwrap_or(0)) as u16
    }

    /// Whether something moves, at no more than half the frame rate.
    pub fn is_well_formed(&self) -> bool {
        let highest = self.first_millihertz.max(self.last_millihertz);
        is_amplitude(self.amplitude_us)
            && (1..=HIGHEST_MILLIHERTZ).contains(&highest)
            && self.frames > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pulses_are_the_formulas_to_a_microsecond() {
        for (first_millihertz, last_millihertz) in [(100, 20_000), (20_000, 0), (25_000, 25_000)] {
            let sweep = Sweep {
                amplitude_us: 500,
                first_millihertz,
                last_millihertz,
                frames: 3_000,
            };
            for k in 0..3_000 {
                let (first, last) = (f64::from(first_millihertz), f64::from(last_millihertz));
                let t = f64::from(k) * 0.02e-3;
                let turns = t * (first + (last - first) * f64::from(k) / 6_000.0);
                let exact = 500.0 * (std::f64::consts::TAU * turns).sin();
                let played = f64::from(sweep.offset_us(k).unwrap());
                // Rounding, the sine's 1.1e-4, and half of 1/65536 turn at its steepest.
                let tolerance = 0.5 + 500.0 * (1.1e-4 + std::f64::consts::PI / 65536.0);
                assert!((played - exact).abs() <= tolerance, "{k}: {played} {exact}");
            }
        }
    }
}
