//! Whether the servo answers later and later, or sooner and sooner, along a run: two clocks that differ, or a servo that changes.
//!
//! In each block of a run, the errors e of the model and the speed s' of its output give the time by which the servo is later than the
//! model,
//!
//! ```text
//! τ = -Σ e s' / Σ s'²
//! ```
//!
//! Its slope over the run is held against the scatter from block to block, whatever causes that. A motion that itself changes along the run
//! may do as much to a servo that is not linear, so such a record is not asked.

use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::data::{Record, Run, usual_hold};
use crate::diagnostics::simulation_error::Simulated;
use crate::thresholds::{LAG_DRIFT_SAMPLES, LAG_DRIFT_SIGNIFICANCE};

/// Blocks of a record.
const BLOCKS: usize = 24;

/// The shortest block, in lengths of the history: its ends are those of other blocks, too.
const HISTORIES: usize = 2;

/// Ratio of usual holds, and of ranges, of both halves of a run up to which the command moves alike in both: of random holds, medians
/// differ by a half.
const ALIKE: f64 = 2.0;

/// A lag that changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LagDrift {
    /// Change of the lag for each second \[s/s\]; positive where the servo gets later.
    pub(crate) rate: f64,
    /// Change from the beginning to the end of the longest run \[s\].
    pub(crate) change_s: f64,
    /// Probability of as much, if the lag does not change.
    pub(crate) p: f64,
}

/// The lag of a block.
struct Block {
    run: usize,
    /// Its middle \[samples\].
    at: f64,
    /// Later than the model by \[samples\].
    lag: f64,
    /// Sum of squares of the speed.
    weight: f64,
}

/// The change of the lag along the runs, where it is beyond chance and matters. `history` is that of the model \[samples\].
pub(crate) fn lag_drift(
    record: &Record,
    runs: &[Simulated<'_>],
    history: usize,
) -> Option<LagDrift> {
    let samples: usize = runs.iter().map(|run| run.errors.len()).sum();
    let longest = runs.iter().map(|run| run.errors.len()).max()?;
    let length = (samples / BLOCKS).max(HISTORIES * history);
    let blocks: Vec<Block> = (runs.iter().enumerate())
        .flat_map(|(index, run)| blocks_of(index, run, length))
        .collect();
    if !record.runs().iter().all(|run| is_even(record, run)) {
        return None;
    }
    let (slope, p) = slope(&blocks, runs.len())?;
    let change = slope * longest as f64;
    (p < LAG_DRIFT_SIGNIFICANCE && change.abs() > LAG_DRIFT_SAMPLES).then(|| LagDrift {
        rate: slope,
        change_s: change * record.sample_period_s(),
        p,
    })
}

fn blocks_of(index: usize, run: &Simulated<'_>, length: usize) -> Vec<Block> {
    let speed = run.speed();
    let of_block = |(number, errors): (usize, &[f64])| {
        let from = number * length;
        let (mut product, mut weight) = (0.0, 0.0);
        for (error, speed) in errors.iter().zip(&speed[from..]) {
            if !(error * speed).is_nan() {
                product += error * speed;
                weight += speed * speed;
            }
        }
        (weight > 0.0).then(|| Block {
            run: index,
            at: from as f64 + 0.5 * length as f64,
            lag: -product / weight,
            weight,
        })
    };
    let parts = run.errors.chunks_exact(length).enumerate();
    parts.filter_map(of_block).collect()
}

/// Whether the command moves alike in both halves of a run.
fn is_even(record: &Record, run: &Run<'_>) -> bool {
    let middle = run.len() / 2;
    let halves = [0..middle, middle..run.len()].map(|half| {
        let part = Record::new(record.sample_period_s(), vec![run.part(half)]);
        part.map_or((0, 0.0), |part| {
            let values = part.runs().iter().flat_map(Run::input);
            let values = values.filter(|value| !value.is_nan());
            let (low, high) = values
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                    (low.min(*value), high.max(*value))
                });
            (usual_hold(&part), high - low)
        })
    });
    let alike = |a: f64, b: f64| a.max(b) <= ALIKE * a.min(b);
    let [(hold, range), (later_hold, later_range)] = halves;
    alike(hold as f64, later_hold as f64) && alike(range, later_range)
}

/// The slope of the lags over time, each run with a lag of its own, and the probability of one as far from 0.
fn slope(blocks: &[Block], runs: usize) -> Option<(f64, f64)> {
    let degrees = blocks
        .len()
        .checked_sub(runs + 2)
        .filter(|degrees| *degrees > 2)?;
    let centre = |of: fn(&Block) -> f64, run: usize| {
        let own = || blocks.iter().filter(|block| block.run == run);
        let weights: f64 = own().map(|block| block.weight).sum();
        own().map(|block| block.weight * of(block)).sum::<f64>() / weights
    };
    let centres: Vec<(f64, f64)> = (0..runs)
        .map(|run| {
            (
                centre(|block| block.at, run),
                centre(|block| block.lag, run),
            )
        })
        .collect();
    let (mut square, mut product) = (0.0, 0.0);
    for block in blocks {
        let (at, lag) = centres[block.run];
        square += block.weight * (block.at - at).powi(2);
        product += block.weight * (block.at - at) * (block.lag - lag);
    }
    let slope = product / square;
    let left = |block: &Block| {
        let (at, lag) = centres[block.run];
        block.weight * (block.lag - lag - slope * (block.at - at)).powi(2)
    };
    let variance = blocks.iter().map(left).sum::<f64>() / degrees as f64 / square;
    let t = slope / variance.sqrt();
    let distribution = StudentsT::new(0.0, 1.0, degrees as f64).ok()?;
    let p = 2.0 * distribution.sf(t.abs());
    (!p.is_nan()).then_some((slope, p))
}
