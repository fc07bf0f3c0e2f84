//! A sine in whole numbers, the same to the bit on every machine.

/// The number that stands for 1.
pub(super) const ONE: i32 = 1 << 15;

/// Steps of the table in a quarter turn.
const QUARTER: usize = 64;

/// sin(π/2 · k/64) · 32768, computed by the compiler.
const TABLE: [u16; QUARTER + 1] = table();

/// sin(2π `turns`/65536) · 32768 by straight lines between the values of [`TABLE`].
///
/// Its error is at most 1.1e-4 of the amplitude: a chord of π/128 stays below (π/128)²/8 = 7.5e-5
/// from the arc, and two roundings add half of 1/32768 each.
pub(super) fn sine(turns: u16) -> i32 {
    const QUADRANT: u16 = 1 << 14;
    const FINE: u16 = QUADRANT / QUARTER as u16;
    let within = turns % QUADRANT;
    let falling = turns / QUADRANT % 2 == 1;
    let place = if falling { QUADRANT - within } else { within };
    let (index, fine) = (usize::from(place / FINE), i32::from(place % FINE));
    let at = |index: usize| i32::from(TABLE.get(index).copied().unwrap_or(ONE as u16));
    let rise = (at(index + 1) - at(index)) * fine;
    let value = at(index) + (rise + i32::from(FINE) / 2) / i32::from(FINE);
    if turns >= 2 * QUADRANT { -value } else { value }
}

#[allow(clippy::indexing_slicing)] // const, so without iterators; the condition bounds it
const fn table() -> [u16; QUARTER + 1] {
    let mut table = [0; QUARTER + 1];
    let mut k = 0;
    while k <= QUARTER {
        let angle = core::f64::consts::FRAC_PI_2 * k as f64 / QUARTER as f64;
        table[k] = (taylor_sine(angle) * ONE as f64 + 0.5) as u16;
        k += 1;
    }
    table
}

/// Taylor's series up to x^17: for x at most π/2 the first term left out is below 5e-14.
const fn taylor_sine(x: f64) -> f64 {
    let (mut sum, mut term, mut power) = (0.0, x, 1.0);
    while power < 18.0 {
        sum += term;
        term = -term * x * x / ((power + 1.0) * (power + 2.0));
        power += 2.0;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_is_what_the_documentation_says() {
        let worst = (0..=u16::MAX)
            .map(|turns| {
                let exact = (std::f64::consts::TAU * f64::from(turns) / 65536.0).sin();
                (f64::from(sine(turns)) / f64::from(ONE) - exact).abs()
            })
            .fold(0.0, f64::max);
        assert!(worst < 1.1e-4, "{worst:e}");
    }

    #[test]
    fn quarters_are_exact_and_halves_mirror() {
        assert_eq!([0, 16384, 32768, 49152].map(sine), [0, ONE, 0, -ONE]);
        for turns in 0..=u16::MAX {
            assert_eq!(sine(turns), -sine(turns.wrapping_add(32768)));
            assert_eq!(sine(turns), sine(32768u16.wrapping_sub(turns)));
        }
    }
}
