//! Many sines at once.

use super::amplitude::{amplitude, is_amplitude};
use super::sine::{ONE, sine};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Most tones of a [`Multisine`]. It bounds the board's work in one frame.
pub const MAX_TONES: u16 = 128;

/// Parts of a microsecond in which the amplitude of a tone is given.
const TONE_PARTS: u32 = 64;

/// A quarter turn in 1/65536.
const QUARTER_TURN: u16 = 1 << 14;

/// Equal cosines at multiples of 1/period, repeated.
///
/// Tone i = 1..n has harmonic `first + (i-1)·spacing` of the period and Schroeder's phase
/// -π i(i-1)/n, which spreads the energy over the period (M. Schroeder, IEEE Trans. Information
/// Theory 16, 1970). The sum is rounded to whole microseconds and clipped to ±`amplitude_us`;
/// [`Multisine::with_largest_tones`] gives the largest tones that are not clipped.
///
/// * Duration: period · periods · 20 ms.
/// * Crest factor: about 1.7 (1.6 to 2), whatever the number of tones.
/// * Spectrum: equal tones at harmonic/(period · 20 ms) Hz, and only the rounding in between. With an
///   odd `first` and a `spacing` of 2, even harmonics of the output are due to the servo's nonlinearity.
///
/// ```
/// use servoid_protocol::reference::Multisine;
/// let multisine = Multisine {
///     amplitude_us: 50, tone_64ths_us: 0, period_frames: 250, first: 1, spacing: 2, tones: 50, periods: 2,
/// }.with_largest_tones();
/// assert_eq!(multisine.frames(), 500); // 10 s
/// assert_eq!(multisine.offset_us(7), multisine.offset_us(257));
/// let largest = (0..250).filter_map(|k| multisine.offset_us(k)).map(i16::abs).max();
/// assert!(largest >= Some(49) && largest <= Some(50));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Multisine {
    /// Limit of the sum (µs from neutral); the rest is clipped.
    pub amplitude_us: u16,
    /// Amplitude of each tone (1/64 µs).
    pub tone_64ths_us: u16,
    /// Period (frames).
    pub period_frames: u16,
    /// Harmonic of the lowest tone.
    pub first: u16,
    /// Difference of the harmonics of neighbouring tones.
    pub spacing: u16,
    /// Number of tones, at most [`MAX_TONES`].
    pub tones: u16,
    /// Number of periods.
    pub periods: u16,
}

impl Multisine {
    /// The same with the largest tones that are not clipped. Computes every frame of a period.
    #[must_use]
    pub fn with_largest_tones(self) -> Self {
        let frames = 0..u32::from(self.period_frames);
        let peak = frames.map(|k| self.sum(k).unsigned_abs()).max();
        let room = u64::from(self.amplitude_us) * u64::from(TONE_PARTS) * ONE as u64;
        let tone = room.checked_div(peak.unwrap_or(0).into()).unwrap_or(0);
        Self {
            tone_64ths_us: u16::try_from(tone).unwrap_or(u16::MAX),
            ..self
        }
    }

    /// The harmonic of each tone.
    pub fn harmonics(&self) -> impl Iterator<Item = u32> + use<> {
        let (first, spacing) = (u32::from(self.first), u32::from(self.spacing));
        (0..u32::from(self.tones.min(MAX_TONES))).map(move |i| first + i * spacing)
    }

    /// Length (frames).
    pub fn frames(&self) -> u32 {
        u32::from(self.period_frames) * u32::from(self.periods)
    }

    /// Offset from neutral in frame `frame` (µs), or `None` past the end.
    pub fn offset_us(&self, frame: u32) -> Option<i16> {
        if frame >= self.frames() {
            return None;
        }
        const UNIT: i64 = ONE as i64 * TONE_PARTS as i64;
        let sum = self.sum(frame.checked_rem(self.period_frames.into())?);
        let product = i64::from(sum) * i64::from(self.tone_64ths_us);
        let rounded = (product.abs() + UNIT / 2) / UNIT;
        let limit = amplitude(self.amplitude_us);
        let size = i16::try_from(rounded).unwrap_or(limit).min(limit);
        Some(if product < 0 { -size } else { size })
    }

    /// The sum of unit cosines in frame k of the period (1/32768). At most 128 terms of at most
    /// 32768.
    fn sum(&self, k: u32) -> i32 {
        let tones = u32::from(self.tones.min(MAX_TONES));
        let phase = |tone: (u32, u32)| {
            let (i, harmonic) = tone;
            let period = u32::from(self.period_frames);
            // A harmonic below half of the period times a frame within it is below 2^32.
            let turned = turns(harmonic.wrapping_mul(k), period);
            turned
                .wrapping_sub(turns(i * (i + 1), 2 * tones))
                .wrapping_add(QUARTER_TURN)
        };
        (0..)
            .zip(self.harmonics())
            .map(|tone| sine(phase(tone)))
            .sum()
    }

    /// Whether something moves, it ends, and every tone is below half the frame rate.
    pub fn is_well_formed(&self) -> bool {
        let highest = self.harmonics().last().unwrap_or(0);
        is_amplitude(self.amplitude_us)
            && self.tone_64ths_us > 0
            && (1..=MAX_TONES).contains(&self.tones)
            && self.first > 0
            && (self.spacing > 0 || self.tones == 1)
            && 2 * highest < u32::from(self.period_frames)
            && self.periods > 0
    }
}

/// `numerator`/`denominator` without its whole turns (1/65536), for a denominator below 2^16.
fn turns(numerator: u32, denominator: u32) -> u16 {
    let part = numerator.checked_rem(denominator).unwrap_or(0);
    // A part that rounds to a whole turn is none.
    ((part << 16) + denominator / 2)
        .checked_div(denominator)
        .unwrap_or(0) as u16
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    fn example(tones: u16) -> Multisine {
        Multisine {
            amplitude_us: 500,
            tone_64ths_us: 0,
            period_frames: 300,
            first: 1,
            spacing: 1,
            tones,
            periods: 1,
        }
        .with_largest_tones()
    }

    #[test]
    fn the_pulses_are_the_formulas_to_a_microsecond() {
        for tones in [1, 7, 128] {
            let multisine = example(tones);
            let tone = f64::from(multisine.tone_64ths_us) / 64.0;
            for k in 0..300 {
                let sum: f64 = (1..=tones)
                    .map(|i| {
                        let i = f64::from(i);
                        let schroeder = PI * i * (i - 1.0) / f64::from(tones);
                        (TAU * i * f64::from(k) / 300.0 - schroeder).cos()
                    })
                    .sum();
                let played = f64::from(multisine.offset_us(k).unwrap());
                // Rounding; and for each tone the sine's 1.1e-4 and two phases of half of 1/65536 turn.
                let tolerance = 0.5 + tone * f64::from(tones) * (1.1e-4 + TAU / 65536.0);
                assert!((played - tone * sum).abs() <= tolerance, "{tones}, {k}");
            }
        }
    }

    #[test]
    fn the_largest_tones_use_the_amplitude_and_the_crest_factor_is_low() {
        for tones in [10, 31, 60, 128] {
            let multisine = example(tones);
            let values: Vec<f64> = (0..300)
                .map(|k| f64::from(multisine.offset_us(k).unwrap()))
                .collect();
            let peak = values.iter().fold(0.0, |peak: f64, v| peak.max(v.abs()));
            let rms = (values.iter().map(|v| v * v).sum::<f64>() / 300.0).sqrt();
            // The tone is cut to a 64th of a microsecond, and there are up to 128 of them.
            assert!((498.0..=500.0).contains(&peak), "{peak}");
            assert!(
                (1.5..2.0).contains(&(peak / rms)),
                "{tones}: {}",
                peak / rms
            );
        }
    }

    #[test]
    fn beyond_the_amplitude_it_is_clipped() {
        let loud = Multisine {
            tone_64ths_us: u16::MAX,
            ..example(20)
        };
        let largest = (0..300).filter_map(|k| loud.offset_us(k)).max();
        assert_eq!(largest, Some(500));
    }
}
