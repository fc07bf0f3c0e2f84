//! Simulated time.
//!
//! One unit for everything, chosen so that each clock of the chip is a whole number of it: 72 MHz
//! from the crystal, 64 MHz from the internal oscillator, the ADC's clock, the watchdog's 40 kHz and
//! the bits of a 115200 baud line. So no time is ever rounded. It is fine enough for an internal oscillator that is
//! off by tenths of a percent.

use std::time::Duration;

/// A time since the board was switched on, or a length of time (1/57 600 µs).
pub type Ticks = u64;

/// Ticks in a second: a hundred times the least common multiple of 64 MHz and 72 MHz.
pub const TICKS_PER_SECOND: Ticks = 57_600_000_000;

/// Ticks in a microsecond.
pub const TICKS_PER_MICROSECOND: Ticks = TICKS_PER_SECOND / 1_000_000;

/// `us` microseconds.
pub const fn microseconds(us: u64) -> Ticks {
    us * TICKS_PER_MICROSECOND
}

/// `ms` milliseconds.
pub const fn milliseconds(ms: u64) -> Ticks {
    microseconds(1_000 * ms)
}

/// A [`Duration`] in ticks, rounded down.
pub fn from_duration(duration: Duration) -> Ticks {
    let ticks = duration.as_nanos() * u128::from(TICKS_PER_SECOND) / 1_000_000_000;
    Ticks::try_from(ticks).unwrap_or(Ticks::MAX)
}

/// Ticks as a [`Duration`], rounded down to nanoseconds.
pub fn to_duration(ticks: Ticks) -> Duration {
    let (seconds, rest) = (ticks / TICKS_PER_SECOND, ticks % TICKS_PER_SECOND);
    let nanoseconds = u128::from(rest) * 1_000_000_000 / u128::from(TICKS_PER_SECOND);
    Duration::new(seconds, nanoseconds as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_clock_of_the_chip_is_a_whole_number_of_ticks() {
        for hz in [
            72_000_000, 64_000_000, 36_000_000, 32_000_000, 12_000_000, 8_000_000, 40_000, 115_200,
        ] {
            assert_eq!(TICKS_PER_SECOND % hz, 0, "{hz} Hz");
        }
    }

    #[test]
    fn durations_come_back() {
        for us in [0, 1, 551, 20_000, 7_200_000_000] {
            let duration = Duration::from_micros(us);
            assert_eq!(from_duration(duration), microseconds(us));
            assert_eq!(to_duration(microseconds(us)), duration);
        }
    }
}
