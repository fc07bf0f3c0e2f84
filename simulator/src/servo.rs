//! What every simulated servo does.

use servoid_protocol::{PulseWidth, ServoScale};
use std::time::Duration;

/// How the simulated servos turn pulses into commanded angles: 1500 µs is 0 degrees, 10 µs are one
/// degree (paper §4).
pub const SERVO_SCALE: ServoScale = ServoScale {
    neutral: PulseWidth::NEUTRAL,
    us_per_degree: 10.0,
};

/// The angle that `pulse` commands (deg).
pub(crate) fn commanded_degrees(pulse: PulseWidth) -> f64 {
    SERVO_SCALE.degrees(pulse).0
}

/// A servo: pulses in, the angle of its output shaft out.
///
/// Time counts from the start of the simulation and only goes forward. The motion depends on the
/// commands and their times alone, never on when or how often the angle is asked for.
pub trait Servo {
    /// A pulse whose rising edge was at `at`, or `None` where a pulse was due and none came. It
    /// stands for all that follow until the next command.
    ///
    /// May be told after the angle has been asked for beyond `at`, as long as the servo's latency
    /// is not over: a real servo, too, knows the width of a pulse only at its end.
    fn command(&mut self, at: Duration, pulse: Option<PulseWidth>);

    /// The angle of the output shaft at `at` (deg), as a perfect sensor sees it. A time before the
    /// latest one asked for gives the angle at the latest one.
    fn angle(&mut self, at: Duration) -> f64;
}
