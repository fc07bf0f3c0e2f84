//! Positions of rest that depend on the direction of approach, in the record and by a model of the servo.

use super::ServoModel;
use crate::numerics::halved;
use crate::results::{Interval, Reason};
use crate::servo_model::quantities::quantity_kind::QuantityKind;
use crate::thresholds::SERVO_FRICTION_UNSHOWN;

/// Rests that are farther apart in the record than friction, dead band and play of the model make them, or than these are sure to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnexplainedHysteresis {
    /// Between rests under one command, the farthest in the record \[output\]; `None` where it shows only that they depend on the direction of approach.
    pub shown: Option<f64>,
    /// What friction, dead band and play of the model make of it at the most \[output\]: those of the fit, whether or not the record determines each by
    /// itself, because a file has them as well.
    pub explained: f64,
}

impl ServoModel {
    /// The hysteresis of the record, where friction, dead band and play of the model do not make as much, or where errors that are not noise show that
    /// they are not all. Where the load stalls the drive, a servo stays where it came from, and that is in the model.
    #[must_use]
    pub fn unexplained_hysteresis(&self) -> Option<UnexplainedHysteresis> {
        if self.stalls().iter().any(Option::is_some) {
            return None;
        }
        let (shown, at_least) = self.apart_at_rest()?;
        let explained = self.held_apart();
        let lacks_something = self.covariance.withdrawn() == Some(Reason::ErrorsNotNoise);
        (explained < at_least || lacks_something).then_some(UnexplainedHysteresis {
            shown,
            explained: shown.map_or(explained, |shown| explained.min(shown)),
        })
    }

    /// How far off the middle friction, a dead band and play of the model hold the output under the commands of the record, where they do most \[units of the command\]. Friction of
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
        let without_load = self.command_without_load();
        let held = commands
            .into_iter()
            .chain(without_load)
            .filter(is_held)
            .map(|command| {
                let [low, high] = servo.staying_angles(command);
                0.5 * (high - low)
            });
        held.fold(0.0, f64::max) + servo.half_play()
    }

    /// How far apart that lets rests under one command be \[output\].
    fn held_apart(&self) -> f64 {
        2.0 * self.held_at_rest() * self.parameters(0).gain.abs()
    }

    /// The command of the record at whose rest the load changes its sign, where it does: there it pushes the shaft to neither edge of a dead band.
    #[must_use]
    pub fn command_without_load(&self) -> Option<f64> {
        let (servo, commands) = (self.parameters(0), self.commands?);
        let load = |command: f64| servo.load.at(servo.resting_angle(command));
        let (least, largest) = (commands.least, commands.largest);
        let of_least = load(least);
        (of_least * load(largest) < 0.0)
            .then(|| halved(least, largest, |command| of_least * load(command) > 0.0))
    }

    /// How far apart friction, dead band and play of the model may hold rests under one command \[output\], where nothing in the record shows as much: its rests are not half as far apart, and no interval says
    /// that it is more than they are. Strokes of less may leave the model where it is.
    #[must_use]
    pub fn held_without_evidence(&self) -> Option<f64> {
        let shown = self.rests_apart?.upper?;
        let held = self.held_apart();
        (held > SERVO_FRICTION_UNSHOWN * shown && !self.surely_holds(shown)).then_some(held)
    }

    /// Whether friction of the model surely holds rests this far apart \[output\]: smaller strokes than those that are made again may show it.
    fn surely_holds(&self, apart: f64) -> bool {
        let at_least = || {
            let resting_error = self.quantity(QuantityKind::RestingError)?;
            resting_error.interval.valid()?.lower
        };
        let gain = self.parameters(0).gain.abs();
        at_least().is_some_and(|lower| 2.0 * lower * gain > apart)
    }

    /// With the rests that its record shows, beside which friction at rest may be left open.
    #[must_use]
    pub fn with_rests(mut self, hysteresis: Option<Interval>, apart: Option<Interval>) -> Self {
        self.hysteresis = hysteresis;
        self.rests_apart = apart;
        let is_open = self.held_without_evidence().is_some();
        for quantity in &mut self.quantities {
            quantity.determined &= !is_open || quantity.kind() != Some(QuantityKind::RestingError);
        }
        self
    }

    /// How far rests under one command are apart in the record, where strokes are made again, and at least. The mean between both directions of approach is a least
    /// distance alone: levels that are overshot count against it.
    fn apart_at_rest(&self) -> Option<(Option<f64>, f64)> {
        let sure = |apart: Interval| Some((apart.value, apart.lower.filter(|lower| *lower > 0.0)?));
        let by_direction = || self.hysteresis?.value.map(|mean| (None, mean));
        self.rests_apart.and_then(sure).or_else(by_direction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Record;
    use crate::results::Bounds;
    use crate::servo_model::{Covariance, ServoModelOptions, fit};
    use servoid_dynamics::{Friction, Grid, ServoParameters, Start, simulate};

    /// Friction holds it 0.6 to each side.
    #[test]
    fn friction_that_no_rest_shows_is_left_open() {
        let servo = ServoParameters {
            friction: Some(Friction {
                coulomb: 1500.0,
                of_gears: 0.0,
                at_rest: None,
            }),
            ..ServoParameters::linear(2500.0, 85.0)
        };
        let input: Vec<f64> = (0..1200)
            .map(|k| [0.0, 5.0, -3.0, 1.0, 4.0, -1.0][k / 60 % 6])
            .collect();
        let (grid, start) = (Grid::new(0.01, 0.0, 1e-4), Start::at_rest(0.0, Some(0.0)));
        let mut output = Vec::new();
        simulate(&servo, &grid, &start, &input, |_, y| output.push(y));
        let record = Record::of_run(0.01, input, output).unwrap();
        let mut model = fit(&record, &ServoModelOptions::default()).unwrap();
        assert!((model.held_at_rest() - 0.6).abs() < 0.05);
        let apart = |of: f64| Some(Interval::new(of, 0.9 * of, 1.1 * of));
        let leaves_open = |model: &ServoModel, of: f64| {
            let model = model.clone().with_rests(None, apart(of));
            let found = model.quantity(QuantityKind::RestingError).unwrap();
            assert_eq!(model.held_without_evidence().is_none(), found.determined);
            !found.determined
        };
        for quantity in &mut model.quantities {
            quantity.determined = true;
        }
        // What an interval holds needs no other evidence: here rests that are 0.2 apart beside one of at least 0.5 to each side, and of at least 0.05.
        model.covariance = Bounds::Valid(Covariance {
            level: 0.99,
            rows: Vec::new(),
        });
        for (lower, is_open) in [(0.5, false), (0.05, true)] {
            for quantity in &mut model.quantities {
                quantity.interval = Bounds::Valid(Interval::new(0.6, lower, 0.7));
            }
            assert_eq!(leaves_open(&model, 0.2), is_open, "{lower}");
        }
        model.covariance = Bounds::Withdrawn(Reason::ErrorsNotNoise);
        assert!(!leaves_open(&model, 1.0));
        assert!(leaves_open(&model, 0.2));
    }
}
