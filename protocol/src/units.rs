//! Pulse widths, sensor counts and degrees.
//!
//! The board uses microseconds and counts only; degrees follow from the user's rig file. A
//! [`ServoScale`] turns commanded degrees into pulses, a [`SensorScale`] turns counts into measured
//! degrees. Both have a sign: a longer pulse may turn a servo either way, and a sensor may be mounted
//! either way round.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Width of a servo pulse (µs).
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, Schema,
)]
#[repr(transparent)]
pub struct PulseWidth(pub u16);

impl PulseWidth {
    /// Half of the usual range of 1-2 ms: the neutral of most R/C servos.
    pub const NEUTRAL: Self = Self(1500);

    /// The width `offset_us` away from this one, or `None` outside the number range.
    pub fn offset_by(self, offset_us: i16) -> Option<Self> {
        self.0.checked_add_signed(offset_us).map(Self)
    }
}

/// One sample of the angle sensor: the sum of the ADC's repeated 12-bit conversions.
///
/// [`Hello`](crate::Hello) gives the number of conversions and the full scale.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    Serialize,
    Deserialize,
    Schema,
)]
#[repr(transparent)]
pub struct Counts(pub u16);

impl Counts {
    /// The largest value that takes two bytes on the wire (14 bits: a varint's two groups of seven).
    /// No rig's full scale exceeds it, so a frame takes at most 40 bytes.
    pub const MAX_TWO_BYTES: Self = Self((1 << 14) - 1);
}

/// An angle (deg).
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
#[repr(transparent)]
pub struct Degrees(pub f64);

/// The scale of a servo: `angle = (pulse - neutral) / us_per_degree`.
///
/// A negative `us_per_degree` means that a longer pulse turns the servo the other way.
///
/// ```
/// use servoid_protocol::{Degrees, PulseWidth, ServoScale};
/// let servo = ServoScale { neutral: PulseWidth(1500), us_per_degree: 10.0 };
/// assert_eq!(servo.pulse(Degrees(-5.0)), Some(PulseWidth(1450)));
/// assert_eq!(servo.degrees(PulseWidth(1550)), Degrees(5.0));
/// assert_eq!(servo.pulse(Degrees(1e9)), None); // no such pulse
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoScale {
    /// The pulse that commands 0 degrees.
    pub neutral: PulseWidth,
    /// Change of the pulse width for one degree (µs/deg).
    pub us_per_degree: f64,
}

impl ServoScale {
    /// The angle that `pulse` commands.
    pub fn degrees(&self, pulse: PulseWidth) -> Degrees {
        Degrees((f64::from(pulse.0) - f64::from(self.neutral.0)) / self.us_per_degree)
    }

    /// The pulse, to the nearest microsecond, that commands `angle`; `None` where none exists.
    pub fn pulse(&self, angle: Degrees) -> Option<PulseWidth> {
        let us = round_half_up(f64::from(self.neutral.0) + angle.0 * self.us_per_degree);
        // This order of comparisons excludes NaN as well.
        (us >= 0.0 && us <= f64::from(u16::MAX)).then_some(PulseWidth(us as u16))
    }
}

/// The scale of a sensor: `angle = (counts - zero_counts) · degrees_per_count`.
///
/// ```
/// use servoid_protocol::{Counts, Degrees, SensorScale};
/// let sensor = SensorScale { zero_counts: 8190.0, degrees_per_count: -0.01 };
/// assert_eq!(sensor.degrees(Counts(8290)), Degrees(-1.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorScale {
    /// The counts at 0 degrees, not necessarily a whole number.
    pub zero_counts: f64,
    /// Change of the angle for one count (deg).
    pub degrees_per_count: f64,
}

impl SensorScale {
    /// The angle at `counts`.
    pub fn degrees(&self, counts: Counts) -> Degrees {
        Degrees((f64::from(counts.0) - self.zero_counts) * self.degrees_per_count)
    }
}

/// `f64::round` needs `std`. For positive widths, adding a half and truncating is the same.
fn round_half_up(x: f64) -> f64 {
    if x > 0.0 && x < 1e9 {
        (x + 0.5) as u32 as f64
    } else {
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_microsecond_survives_the_way_to_degrees_and_back() {
        for us_per_degree in [10.0, -8.37] {
            let servo = ServoScale {
                neutral: PulseWidth(1520),
                us_per_degree,
            };
            for us in 900..=2100 {
                let pulse = PulseWidth(us);
                assert_eq!(servo.pulse(servo.degrees(pulse)), Some(pulse));
            }
        }
    }

    #[test]
    fn a_pulse_that_does_not_exist_is_none() {
        let servo = ServoScale {
            neutral: PulseWidth(1500),
            us_per_degree: 10.0,
        };
        for angle in [-150.1, 6404.0, f64::NAN, f64::INFINITY] {
            assert_eq!(servo.pulse(Degrees(angle)), None, "{angle} deg");
        }
    }
}
