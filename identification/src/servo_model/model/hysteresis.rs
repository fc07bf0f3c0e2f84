//! Positions of rest that depend on the direction of approach, in the record and by a model of the servo.

use super::ServoModel;
use crate::results::{Interval, Reason};

/// Rests that are farther apart in the record than the model shows why, or than it is sure to show why: it has friction and a dead band, but no play of
/// the gears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnexplainedHysteresis {
    /// Between rests under one command, the farthest in the record \[output\]; `None` where it shows only that they depend on the direction of approach.
    pub shown: Option<f64>,
    /// What friction and dead band of the model make of it at the most \[output\]: those of the fit, whether or not the record determines each by
    /// itself, because a file has them as well.
    pub explained: f64,
}

impl ServoModel {
    /// The hysteresis of the record, where friction and dead band of the model do not make as much, or where errors that are not noise show that
    /// they are not all. Where the load stalls the drive, a servo stays where it came from, and that is in the model.
    #[must_use]
    pub fn unexplained_hysteresis(&self) -> Option<UnexplainedHysteresis> {
        if self.stalls().iter().any(Option::is_some) {
            return None;
        }
        let (shown, at_least) = self.apart_at_rest()?;
        let explained = 2.0 * self.held_at_rest() * self.parameters(0).gain.abs();
        let lacks_something = self.covariance.withdrawn() == Some(Reason::ErrorsNotNoise);
        (explained < at_least || lacks_something).then_some(UnexplainedHysteresis {
            shown,
            explained: shown.map_or(explained, |shown| explained.min(shown)),
        })
    }

    /// How far off the middle friction and a dead band of the model hold the shaft under the commands of the record, where they do most \[units of the command\]. Friction of
    /// gears under load holds it farther than without. A command under which the load stalls the drive has no such rest. Of a file without its
    /// commands, under command 0.
    #[must_use]
    pub fn held_at_rest(&self) -> f64 {
        let servo = self.parameters(0);
        let is_held = |command: &f64| {
            let load = servo.load.at(servo.resting_angle(*command));
            let limit = servo.drive_limit();
            limit.is_none_or(|limit| {
                let [up, down] = limit.both_ways();
                let within = -down..=up;
                (servo.holding_drives(load).iter()).all(|drive| within.contains(drive))
            })
        };
        let commands = self
            .commands
            .map_or_else(|| vec![0.0], |of| vec![of.least, of.middle(), of.largest]);
        let held = commands.into_iter().filter(is_held).map(|command| {
            let [low, high] = servo.staying_angles(command);
            0.5 * (high - low)
        });
        held.fold(0.0, f64::max)
    }

    /// How far rests under one command are apart in the record, where strokes are made again, and at least. The mean between both directions of approach is a least
    /// distance alone: levels that are overshot count against it.
    fn apart_at_rest(&self) -> Option<(Option<f64>, f64)> {
        let sure = |apart: Interval| Some((apart.value, apart.lower.filter(|lower| *lower > 0.0)?));
        let by_direction = || self.hysteresis?.value.map(|mean| (None, mean));
        self.rests_apart.and_then(sure).or_else(by_direction)
    }
}
