//! The trait of all simulated servos, and their pulses in degrees.

use servoid_protocol::{PulseWidth, ServoScale};
use std::time::Duration;

/// The scale of the simulated servos: 1500 µs is 0 degrees, 10 µs are one
/// degree (paper §4).
pub const SERVO_SCALE: ServoScale = ServoScale {
    neutral: PulseWidth::NEUTRAL,
    us_per_degree: 10.0,
};

/// A servo: pulses in, the angle of its output shaft out.
///
/// Time counts from the start of the simulation and only goes forward. The motion depends on the
/// commands and their times alone, never on the reads of the angle.
pub trait Servo: std::fmt::Debug + Send {
    /// A pulse with its rising edge at `at`, or `None` for a missing one. It repeats until the next command.
    ///
    /// The angle may have been read beyond `at` before, within the servo's latency: a real servo, too, measures the
    /// width of a pulse only at its end.
    fn command(&mut self, at: Duration, pulse: Option<PulseWidth>);

    /// The angle of the output shaft at `at` (deg), as a perfect sensor sees it. A time before the
    /// latest one read gives the angle at the latest one.
    fn angle(&mut self, at: Duration) -> f64;
}
