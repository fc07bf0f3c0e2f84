//! Pseudo-random binary sequences.

use super::amplitude::{amplitude, is_amplitude};
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// The valid lengths of the shift register.
const REGISTERS: core::ops::RangeInclusive<u16> = 2..=15;

/// For each register length n from 2: a primitive polynomial x^n + ... + 1 without its x^n, bit k for
/// x^k (W. Stahnke, "Primitive binary polynomials", Mathematics of Computation 27, 1973). The tests
/// check each one.
const POLYNOMIALS: [u16; 14] = [
    0b11,               // x²  + x + 1
    0b11,               // x³  + x + 1
    0b11,               // x⁴  + x + 1
    0b101,              // x⁵  + x² + 1
    0b11,               // x⁶  + x + 1
    0b11,               // x⁷  + x + 1
    0b110_0011,         // x⁸  + x⁶ + x⁵ + x + 1
    0b1_0001,           // x⁹  + x⁴ + 1
    0b1001,             // x¹⁰ + x³ + 1
    0b101,              // x¹¹ + x² + 1
    0b1001_1001,        // x¹² + x⁷ + x⁴ + x³ + 1
    0b1_1011,           // x¹³ + x⁴ + x³ + x + 1
    0b1_1000_0000_0011, // x¹⁴ + x¹² + x¹¹ + x + 1
    0b11,               // x¹⁵ + x + 1
];

/// A binary sequence of maximal length from a linear feedback shift register, each of its values held
/// for `chip_frames`.
///
/// The sequence s obeys the recurrence of the register's primitive polynomial. Its first values are
/// the bits of `seed`, the lowest first; 1 stands for `+amplitude_us`, 0 for `-amplitude_us`. It
/// repeats after 2^register - 1 chips.
///
/// * Duration: chips · chip · 20 ms.
/// * Crest factor: 1.
/// * Spectrum: lines every 1/(period) Hz under (sin πx/πx)², x = f·chip: even (to 3 dB) up to
///   0.44/chip, with gaps at multiples of 1/chip. Over a whole period the mean is one chip's share.
///
/// ```
/// use servoid_protocol::reference::Prbs;
/// let prbs = Prbs { amplitude_us: 50, register: 3, seed: 0b111, chip_frames: 1, chips: 7 };
/// let chips: Vec<_> = (0..7).filter_map(|frame| prbs.offset_us(frame)).collect();
/// assert_eq!(chips, [50, 50, 50, -50, -50, 50, -50]); // s(k+3) = s(k+1) + s(k)
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Prbs {
    /// Offset of both levels from neutral (µs).
    pub amplitude_us: u16,
    /// Length of the shift register (bits), 2 to 15: the sequence has 2^register - 1 chips.
    pub register: u16,
    /// Initial content of the register: its lowest bit is the first chip. Not zero.
    pub seed: u16,
    /// How long each chip is held (frames).
    pub chip_frames: u16,
    /// Number of chips.
    pub chips: u16,
}

impl Prbs {
    /// Chips after which the sequence repeats: 2^register - 1.
    pub fn period_chips(&self) -> u16 {
        1u16.checked_shl(self.register.into())
            .map_or(u16::MAX, |length| length.saturating_sub(1))
    }

    /// Length (frames).
    pub fn frames(&self) -> u32 {
        u32::from(self.chips) * u32::from(self.chip_frames)
    }

    /// Offset from neutral in frame `frame` (µs), or `None` past the end.
    pub fn offset_us(&self, frame: u32) -> Option<i16> {
        if frame >= self.frames() {
            return None;
        }
        let chip = frame.checked_div(self.chip_frames.into())?;
        let amplitude = amplitude(self.amplitude_us);
        let sign = if self.bit(chip) { 1 } else { -1 };
        Some(sign * amplitude)
    }

    /// s(k). Every value of the sequence is a sum (modulo 2) of some of the first ones: those in the
    /// remainder of x^k on division by the polynomial. So there is no state to step.
    fn bit(&self, k: u32) -> bool {
        let index = usize::from(self.register.saturating_sub(*REGISTERS.start()));
        let Some(&polynomial) = POLYNOMIALS.get(index) else {
            return false;
        };
        let field = Field {
            degree: self.register,
            polynomial: polynomial.into(),
        };
        (field.power_of_x(k) & u32::from(self.seed)).count_ones() % 2 == 1
    }

    /// Whether something moves and it ends.
    pub fn is_well_formed(&self) -> bool {
        is_amplitude(self.amplitude_us)
            && REGISTERS.contains(&self.register)
            && (1..=self.period_chips()).contains(&self.seed)
            && self.chip_frames > 0
            && self.chips > 0
    }
}

/// Polynomials over {0, 1} modulo one of degree `degree`; bit k stands for x^k.
struct Field {
    degree: u16,
    /// The modulus without its highest term.
    polynomial: u32,
}

impl Field {
    fn times_x(&self, a: u32) -> u32 {
        let shifted = a << 1;
        let overflow = (shifted >> self.degree) & 1;
        shifted ^ (overflow << self.degree) ^ (overflow * self.polynomial)
    }

    fn product(&self, a: u32, b: u32) -> u32 {
        (0..self.degree)
            .rev()
            .fold(0, |sum, bit| self.times_x(sum) ^ (((b >> bit) & 1) * a))
    }

    /// x^k by squaring: at most 32 squarings.
    fn power_of_x(&self, k: u32) -> u32 {
        (0..u32::BITS - k.leading_zeros())
            .rev()
            .fold(1, |power, bit| {
                let square = self.product(power, power);
                if (k >> bit) & 1 == 1 {
                    self.times_x(square)
                } else {
                    square
                }
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The register itself, shifted chip by chip.
    fn shifted(register: u16, seed: u16, count: usize) -> Vec<bool> {
        let polynomial = POLYNOMIALS[usize::from(register - 2)];
        let mut values: Vec<bool> = (0..register).map(|bit| (seed >> bit) & 1 == 1).collect();
        while values.len() < count {
            let oldest = values.len() - usize::from(register);
            let next = (0..register)
                .filter(|tap| (polynomial >> tap) & 1 == 1)
                .fold(false, |sum, tap| sum ^ values[oldest + usize::from(tap)]);
            values.push(next);
        }
        values
    }

    #[test]
    fn every_register_is_of_maximal_length_and_the_jump_is_the_walk() {
        for register in REGISTERS {
            let prbs = Prbs {
                amplitude_us: 1,
                register,
                seed: 1,
                chip_frames: 1,
                chips: u16::MAX,
            };
            let period = usize::from(prbs.period_chips());
            let walked = shifted(register, 1, period + usize::from(register));
            // Maximal: every state but zero comes once, so the first one returns only after all.
            let states: std::collections::HashSet<u16> = walked
                .windows(usize::from(register))
                .take(period)
                .map(|w| w.iter().rev().fold(0, |s, bit| (s << 1) | u16::from(*bit)))
                .collect();
            assert_eq!(states.len(), period, "register {register}");
            for (k, bit) in walked.iter().enumerate() {
                assert_eq!(prbs.bit(k as u32), *bit, "register {register}, chip {k}");
            }
        }
    }

    #[test]
    fn a_seed_is_a_place_in_the_sequence() {
        for seed in [1, 77, 511] {
            let prbs = Prbs {
                amplitude_us: 1,
                register: 9,
                seed,
                chip_frames: 1,
                chips: 600,
            };
            let jumped: Vec<bool> = (0..600).map(|k| prbs.bit(k)).collect();
            assert_eq!(jumped, shifted(9, seed, 600));
        }
    }
}
