//! Rests under the outermost commands that a model does not have.

use serde::{Deserialize, Serialize};

use super::visits::Visit;
use crate::data::column::{mean, span};
use crate::numerics::square_about_mean;
use crate::thresholds::{DETECTION, STOP_SHORT};

/// A command under which the servo rests elsewhere than a model of it: beyond it there may be a stop.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MissedRest {
    /// The command \[input\].
    pub command: f64,
    /// Where the servo rests, the mean of its visits \[output\].
    pub measured: f64,
    /// Where the model does in the same visits \[output\].
    pub modelled: f64,
}

/// Of the lowest and the highest command that was visited, where these are at the ends of all `commanded`, those whose rests in `modelled`, visit by visit, are off by more than 1 % of the way between the farthest
/// rests, by more than rests under one command are `apart` \[output\], and by more than the scatter of what the others are off by.
pub(super) fn missed(
    measured: &[Visit],
    modelled: &[Visit],
    apart: f64,
    commanded: [f64; 2],
) -> Vec<MissedRest> {
    let Some(way) = span(measured.iter().map(|visit| visit.rest)) else {
        return Vec::new();
    };
    let commands = || measured.iter().map(|visit| visit.command);
    // Under commands that move on, the servo rests for a moment anywhere.
    let [least, largest] = commanded;
    let [low, high] = [0.25, 0.75].map(|part| least + part * (largest - least));
    let ends = [
        commands().reduce(f64::min).filter(|at| *at < low),
        commands().reduce(f64::max).filter(|at| *at > high),
    ];
    let off: Vec<(f64, f64)> = (measured.iter().zip(modelled))
        .map(|(seen, model)| (seen.command, seen.rest - model.rest))
        .collect();
    let missed = ends.into_iter().flatten().filter_map(|command| {
        let (at_end, others): (Vec<_>, Vec<_>) = off.iter().partition(|(at, _)| *at == command);
        let others: Vec<f64> = others.into_iter().map(|(_, off)| off).collect();
        let variance = match others.len() {
            0 | 1 => 0.0,
            count => square_about_mean(&others) / (count - 1) as f64,
        };
        let chance = DETECTION * (variance / at_end.len() as f64).sqrt();
        let mean_rest = |visits: &[Visit]| {
            let at_end = visits.iter().filter(|visit| visit.command == command);
            mean(&at_end.map(|visit| visit.rest).collect::<Vec<f64>>())
        };
        let rest = MissedRest {
            command,
            measured: mean_rest(measured)?,
            modelled: mean_rest(modelled)?,
        };
        ((rest.measured - rest.modelled).abs() > apart + STOP_SHORT * way + chance).then_some(rest)
    });
    missed.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Levels that are reached twice, each from another one, of a servo that stops at 6.5.
    #[test]
    fn a_rest_at_a_stop_is_missed_by_a_servo_without_one() {
        let visits = |stop: f64, off: f64| -> Vec<Visit> {
            let levels = [0.0, 4.0, 8.0, -4.0, 8.0, 0.0, -4.0];
            let visit = |pair: &[f64]| Visit {
                command: pair[1],
                before: pair[0],
                rest: pair[1].min(stop) + off,
                moved: 0.0,
                samples: 10,
                taken_out: 0.0,
            };
            levels.windows(2).map(visit).collect()
        };
        let (measured, modelled) = (visits(6.5, 0.0), visits(100.0, 0.1));
        let expected = MissedRest {
            command: 8.0,
            measured: 6.5,
            modelled: 8.1,
        };
        assert_eq!(missed(&measured, &modelled, 0.0, [-4.0, 8.0]), [expected]);
        // A stick that goes on to 20 rested there for a moment.
        assert!(missed(&measured, &modelled, 0.0, [-20.0, 20.0]).is_empty());
        // Rests that friction keeps as far apart show nothing.
        assert!(missed(&measured, &modelled, 1.55, [-4.0, 8.0]).is_empty());
        assert!(missed(&measured, &visits(6.5, 0.1), 0.0, [-4.0, 8.0]).is_empty());
    }

    /// Gusts: the one visit of the highest command is off by no more than others.
    #[test]
    fn a_rest_that_is_off_as_others_are_is_not_missed() {
        let rests = |off: [f64; 6]| -> Vec<Visit> {
            let levels = [0.0, 4.0, 2.0, 8.0, -4.0, 4.0, 0.0];
            let visit = |(pair, off): (&[f64], f64)| Visit {
                command: pair[1],
                before: pair[0],
                rest: pair[1] + off,
                moved: 0.0,
                samples: 10,
                taken_out: 0.0,
            };
            levels.windows(2).zip(off).map(visit).collect()
        };
        let modelled = rests([0.0; 6]);
        let gusts = rests([0.4, -0.3, -0.5, 0.5, -0.4, 0.2]);
        assert!(missed(&gusts, &modelled, 0.0, [-4.0, 8.0]).is_empty());
        let calm = rests([0.01, -0.02, -0.5, 0.01, 0.02, 0.0]);
        assert_eq!(missed(&calm, &modelled, 0.0, [-4.0, 8.0]).len(), 1);
    }
}
