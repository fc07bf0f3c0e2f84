//! Rests under the outermost commands that a model does not have.

use serde::{Deserialize, Serialize};

use super::settling;
use super::visits::{Visit, visits};
use crate::data::column::span;
use crate::data::{Record, Run};
use crate::results::Model;
use crate::thresholds::STOP_SHORT;

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

/// Of the lowest and the highest command under which the servo comes to rest, those whose rests in `simulated`, run by run, are off by more than 1 % of the way
/// between the farthest rests, and rests under one command are [`apart`](super::rests_apart) \[output\] in the record. The linear `model` of the record gives
/// the length of a response.
#[must_use]
pub fn missed_rests(
    record: &Record,
    simulated: &[Vec<f64>],
    model: &Model,
    apart: f64,
) -> Vec<MissedRest> {
    let pairs = record.runs().iter().zip(simulated);
    let by_model = pairs.map(|(run, output)| run.with_output(output.clone()));
    let by_model: Vec<Run> = by_model.collect();
    let settling = settling(record, model);
    let measured = visits(record.runs(), settling);
    let modelled = visits(&by_model, settling);
    let Some(way) = span(measured.iter().map(|visit| visit.rest)) else {
        return Vec::new();
    };
    let commands = || measured.iter().map(|visit| visit.command);
    let ends = [commands().reduce(f64::min), commands().reduce(f64::max)];
    let missed = ends.into_iter().flatten().filter_map(|command| {
        let mean = |visits: &[Visit]| {
            let at_end = visits.iter().filter(|visit| visit.command == command);
            let rests: Vec<f64> = at_end.map(|visit| visit.rest).collect();
            (!rests.is_empty()).then(|| rests.iter().sum::<f64>() / rests.len() as f64)
        };
        let rest = MissedRest {
            command,
            measured: mean(&measured)?,
            modelled: mean(&modelled)?,
        };
        ((rest.measured - rest.modelled).abs() > apart + STOP_SHORT * way).then_some(rest)
    });
    missed.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Options, Settling, identify};

    /// A servo of first order that stops at 6.5, under levels of 100 samples.
    #[test]
    fn a_rest_at_a_stop_is_missed_by_a_servo_without_one() {
        let levels = [0.0, 4.0, 2.0, 8.0, -4.0, 6.0, -2.0];
        let input: Vec<f64> = (0..4200).map(|k| levels[k / 100 % 7]).collect();
        let moved = |stop: f64| -> Vec<f64> {
            let follow = |y: &mut f64, u: &f64| {
                *y = (*y + 0.2 * (u - *y)).min(stop);
                Some(*y)
            };
            input.iter().scan(0.0, follow).collect()
        };
        let noise = |k: usize| 0.002 * ((k * 7919 % 101) as f64 - 50.0) / 50.0;
        let output: Vec<f64> = (moved(6.5).iter().enumerate())
            .map(|(k, y)| y + noise(k))
            .collect();
        let record = Record::of_run(0.002, &input, &output).unwrap();
        let options = Options {
            settling: Settling::Samples(61),
            ..Options::default()
        };
        let model = identify(&record, &options).unwrap();
        let [missed] = missed_rests(&record, &[moved(100.0)], &model, 0.0)[..] else {
            panic!("one end is missed");
        };
        assert_eq!(missed.command, 8.0);
        // The noise is 0.002 at the most.
        assert!((missed.measured - 6.5).abs() < 0.002 && (missed.modelled - 8.0).abs() < 0.01);
        assert!(missed_rests(&record, &[moved(6.5)], &model, 0.0).is_empty());
    }
}
