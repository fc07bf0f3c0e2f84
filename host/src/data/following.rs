//! Whether a servo has followed its command in a run.
//!
//! A jammed, unplugged or powerless servo stands still while its sensor's reading has noise as always, so
//! [`FrozenSensor`](super::FrozenSensor) does not find it. The position of each frame is held against the commands of the
//! frames before it: the share of the command that comes back at the lag where most does is near 1 where a servo follows,
//! and near 0 where the position has nothing to do with the command.

use servoid_protocol::timing::SAMPLES_PER_FRAME;

/// Lags that are looked at (frames of 15 to 37.5 ms): 0.4 s or more, beyond the delay and the rise of any servo.
const LAGS: usize = 27;

/// A servo that follows by less has hardly moved, or its scales are wrong by ten times.
const HARDLY: f64 = 0.1;

/// Commands and positions of a run, a pair for each frame.
#[derive(Clone, Debug, Default)]
pub struct Following {
    /// The command, and the mean position (deg); NaN where a frame is lost.
    frames: Vec<(f64, f64)>,
}

impl Following {
    /// Takes a frame: its number, its command, and its positions (deg).
    pub fn take(&mut self, frame: u32, command: f64, positions: [f64; SAMPLES_PER_FRAME]) {
        let lost = (frame as usize).saturating_sub(self.frames.len());
        self.frames
            .extend(std::iter::repeat_n((f64::NAN, f64::NAN), lost));
        let mean = positions.iter().sum::<f64>() / SAMPLES_PER_FRAME as f64;
        self.frames.push((command, mean));
    }

    /// The share of the command by which the position follows it, 1 for a servo of gain 1 that has the time to arrive.
    /// `None` where the command has not changed.
    #[must_use]
    pub fn share(&self) -> Option<f64> {
        let shares = (0..LAGS).filter_map(|lag| self.share_at(lag));
        shares.reduce(f64::max)
    }

    /// The size of the slope of the position over the command `lag` frames before it.
    fn share_at(&self, lag: usize) -> Option<f64> {
        let later = self.frames.iter().skip(lag);
        let pairs: Vec<_> = self
            .frames
            .iter()
            .zip(later)
            .map(|(before, now)| (before.0, now.1))
            .filter(|(command, position)| command.is_finite() && position.is_finite())
            .collect();
        let mean =
            |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / pairs.len() as f64;
        let (command, position) = (mean(|pair| pair.0), mean(|pair| pair.1));
        let (mut product, mut square) = (0.0, 0.0);
        for (u, y) in &pairs {
            product += (u - command) * (y - position);
            square += (u - command).powi(2);
        }
        (square > 0.0).then(|| (product / square).abs())
    }
}

/// Whether a servo that follows by `share` has hardly moved.
#[must_use]
pub fn hardly_moved(share: f64) -> bool {
    share < HARDLY
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The share of a servo that answers with `gain` after three frames, with noise of 0.2 degrees.
    fn share(gain: f64) -> f64 {
        let command = |frame: u32| if frame / 20 % 2 == 0 { 5.0 } else { -5.0 };
        let mut following = Following::default();
        // Frame 50 is lost.
        for frame in (0..200u32).filter(|frame| *frame != 50) {
            let noise = if frame * frame % 7 < 3 { 0.2 } else { -0.2 };
            let position = 60.0 + gain * command(frame.saturating_sub(3)) + noise;
            following.take(frame, command(frame), [position; SAMPLES_PER_FRAME]);
        }
        following.share().unwrap()
    }

    #[test]
    fn a_servo_that_moves_is_distinguished_from_one_that_stands_still() {
        assert!((share(1.0) - 1.0).abs() < 0.02, "{}", share(1.0));
        assert!((share(-0.5) - 0.5).abs() < 0.02, "{}", share(-0.5));
        assert!(hardly_moved(share(0.0)), "{}", share(0.0));
        assert!(hardly_moved(share(0.05)) && !hardly_moved(share(0.2)));
    }

    #[test]
    fn without_a_command_that_changes_nothing_is_known() {
        let mut following = Following::default();
        assert_eq!(following.share(), None);
        for frame in 0..100 {
            following.take(frame, 1.0, [f64::from(frame); SAMPLES_PER_FRAME]);
        }
        assert_eq!(following.share(), None);
    }
}
