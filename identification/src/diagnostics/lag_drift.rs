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
//! may do as much to a servo that is not linear. So what goes with the speed of a block is taken out of the lags first, and a record whose
//! command has another range or goes another way in its second half is not asked.

use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::data::{Moments, Record, Run};
use crate::diagnostics::simulation_error::{Simulated, simulated_whole};
use crate::estimation::GlsFit;
use crate::thresholds::{LAG_DRIFT_SAMPLES, LAG_DRIFT_SIGNIFICANCE, RANGES_ALIKE, WAYS_ALIKE};

/// Blocks of a record.
const BLOCKS: usize = 24;

/// The shortest block, in lengths of the history: its ends are those of other blocks, too.
const HISTORIES: usize = 2;

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

/// The change of the lag along the runs, where it is beyond chance and matters. A record whose command is not even is not simulated at all.
pub(crate) fn lag_drift(record: &Record, moments: &Moments, fit: &GlsFit) -> Option<LagDrift> {
    if !record.runs().iter().all(is_even) {
        return None;
    }
    let runs = simulated_whole(record, moments, fit);
    let history = fit.coordinates.basis.settling();
    let samples: usize = runs.iter().map(|run| run.errors.len()).sum();
    let longest = runs.iter().map(|run| run.errors.len()).max()?;
    let length = (samples / BLOCKS).max(HISTORIES * history);
    let blocks: Vec<Block> = (runs.iter().enumerate())
        .flat_map(|(index, run)| blocks_of(index, run, length))
        .collect();
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

/// Whether the command moves as far and as much in both halves of a run.
fn is_even(run: &Run<'_>) -> bool {
    let (first, second) = run.input().split_at(run.len() / 2);
    let range = |part: &[f64]| {
        let known = part.iter().filter(|value| !value.is_nan());
        let (low, high) = known.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(*value), high.max(*value))
        });
        high - low
    };
    let way = |part: &[f64]| {
        let steps = part.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        steps.filter(|step| !step.is_nan()).sum::<f64>()
    };
    let alike = |of: &dyn Fn(&[f64]) -> f64, most: f64| {
        let (a, b) = (of(first), of(second));
        a.max(b) <= most * a.min(b)
    };
    alike(&range, RANGES_ALIKE) && alike(&way, WAYS_ALIKE)
}

/// The slope of the lags over time, each run with a lag of its own and all with one effect of speed, and the probability of one as far
/// from 0.
fn slope(blocks: &[Block], runs: usize) -> Option<(f64, f64)> {
    let degrees = blocks.len().checked_sub(runs + 3)?;
    let own = |run: usize| blocks.iter().filter(move |block| block.run == run);
    let centre = |run: usize| {
        let mut sums = [0.0; 3];
        let mut weights = 0.0;
        for block in own(run) {
            weights += block.weight;
            for (sum, value) in sums.iter_mut().zip(block.row()) {
                *sum += block.weight * value;
            }
        }
        sums.map(|sum| sum / weights)
    };
    let centres: Vec<[f64; 3]> = (0..runs).map(centre).collect();
    let centred = |block: &Block| {
        let (row, centre) = (block.row(), centres[block.run]);
        std::array::from_fn::<f64, 3, _>(|i| row[i] - centre[i])
    };
    let sum = |of: &dyn Fn([f64; 3]) -> f64| -> f64 {
        blocks
            .iter()
            .map(|block| block.weight * of(centred(block)))
            .sum()
    };
    let (speeds, both) = (sum(&|[_, v, _]| v * v), sum(&|[t, v, _]| t * v));
    // Of runs of one speed throughout there is no effect of it.
    let share = |product: f64| if speeds > 0.0 { product / speeds } else { 0.0 };
    let (of_time, of_lag) = (share(both), share(sum(&|[_, v, lag]| v * lag)));
    let square = sum(&|[t, v, _]| (t - of_time * v).powi(2));
    let slope = sum(&|[t, v, lag]| (t - of_time * v) * (lag - of_lag * v)) / square;
    let left = sum(&|[t, v, lag]| (lag - of_lag * v - slope * (t - of_time * v)).powi(2));
    let t = slope / (left / degrees as f64 / square).sqrt();
    // Without degrees of freedom, or without any scatter, nothing is known of chance.
    let distribution = StudentsT::new(0.0, 1.0, degrees as f64).ok()?;
    t.is_finite()
        .then(|| (slope, 2.0 * distribution.sf(t.abs())))
}

impl Block {
    /// Time, rms speed and lag.
    fn row(&self) -> [f64; 3] {
        [self.at, self.weight.sqrt(), self.lag]
    }
}
