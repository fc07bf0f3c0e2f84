//! Whether a servo has moved in a run.
//!
//! A jammed, unplugged or powerless servo stands still while its sensor's reading has noise as always, so
//! [`FrozenSensor`](super::FrozenSensor) does not find it. The scatter of the position, as means over frames, which have little noise, is
//! held against the scatter of the command.

use servoid_protocol::timing::SAMPLES_PER_FRAME;

/// A servo that moves by less of its command has hardly moved, or its scales are wrong by ten times.
const HARDLY: f64 = 0.1;

/// A mean distance of position and command beyond this is no friction and no load \[deg\].
pub const FAR_FROM_COMMAND_DEG: f64 = 20.0;

/// Commands and positions of a run, as they come.
#[derive(Clone, Debug, Default)]
pub struct Movement {
    command: Scatter,
    position: Scatter,
}

impl Movement {
    /// Takes the command of a frame, and its positions (deg).
    pub fn take(&mut self, command: f64, positions: [f64; SAMPLES_PER_FRAME]) {
        let mean = positions.iter().sum::<f64>() / SAMPLES_PER_FRAME as f64;
        self.command.take(command);
        self.position.take(mean);
    }

    /// Standard deviation of the position over that of the command: near 1 for a servo of gain 1 that has the time to arrive. `None`
    /// where the command has not changed.
    #[must_use]
    pub fn share(&self) -> Option<f64> {
        let commanded = self.command.squares;
        (commanded > 0.0).then(|| (self.position.squares / commanded).sqrt())
    }
}

impl Movement {
    /// How far the position lies from the command on average (deg); `None` of no frames.
    #[must_use]
    pub fn apart_deg(&self) -> Option<f64> {
        (self.position.count > 0.0).then_some(self.position.mean - self.command.mean)
    }
}

/// Whether a servo that moves by this share of its command has hardly moved.
#[must_use]
pub fn hardly_moved(share: f64) -> bool {
    share < HARDLY
}

/// Mean, and sum of squares about it, of values as they come (Welford's recursion, which does not cancel).
#[derive(Clone, Copy, Debug, Default)]
struct Scatter {
    count: f64,
    mean: f64,
    squares: f64,
}

impl Scatter {
    fn take(&mut self, value: f64) {
        self.count += 1.0;
        let before = value - self.mean;
        self.mean += before / self.count;
        self.squares += before * (value - self.mean);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The share of a servo that answers with `gain` after three frames, with noise of 0.2 degrees.
    fn share(gain: f64) -> f64 {
        let command = |frame: u32| {
            if (frame / 20).is_multiple_of(2) {
                5.0
            } else {
                -5.0
            }
        };
        let mut movement = Movement::default();
        for frame in 0..200u32 {
            let noise = if frame * frame % 7 < 3 { 0.2 } else { -0.2 };
            let position = 60.0 + gain * command(frame.saturating_sub(3)) + noise;
            movement.take(command(frame), [position; SAMPLES_PER_FRAME]);
        }
        movement.share().unwrap()
    }

    #[test]
    fn a_servo_that_moves_is_distinguished_from_one_that_stands_still() {
        for gain in [1.0, -0.5] {
            let found = share(gain);
            assert!((found - f64::abs(gain)).abs() < 0.02, "{gain}: {found}");
            assert!(!hardly_moved(found));
        }
        assert!(hardly_moved(share(0.0)), "{}", share(0.0));
        assert!(hardly_moved(share(0.05)) && !hardly_moved(share(0.2)));
    }

    #[test]
    fn without_a_command_that_changes_nothing_is_known() {
        let mut movement = Movement::default();
        assert_eq!(movement.share(), None);
        for frame in 0..100 {
            movement.take(1.0, [f64::from(frame); SAMPLES_PER_FRAME]);
        }
        assert_eq!(movement.share(), None);
    }
}
