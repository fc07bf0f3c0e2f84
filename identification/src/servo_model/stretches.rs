//! A record as the fit sees it: stretches with a known command.
//!
//! A stretch ends where the input is missing and the samples around it do not show it, since the motion after that is not known; the next one begins with a
//! start of its own. Missing outputs are not compared. A stretch is divided into blocks, which the choice of terms
//! leaves out in turn.

use crate::data::Record;
use servoid_dynamics::{Commands, Grid, Start};
use std::ops::Range;

/// Blocks of a record, at least: enough to show whether an advantage exceeds its scatter.
const BLOCKS: usize = 32;

/// Samples of a stretch, at least: a shorter one shows its start and little else.
const SHORTEST: usize = 4;

/// Consecutive samples of one run with all inputs known.
#[derive(Clone, Debug)]
pub(crate) struct Stretch {
    /// Index of the run in the record.
    pub(crate) run: usize,
    /// Its first sample in the run.
    pub(crate) first: usize,
    /// The commands.
    pub(crate) input: Vec<f64>,
    /// How long after its sample each comes into force, where they do not at once \[s\].
    late_s: Option<Vec<f64>>,
    /// The outputs, NaN where missing.
    pub(crate) output: Vec<f64>,
    /// Which of the controllers drove it.
    pub(crate) controller: usize,
    /// The servo stood still before it, under this command.
    pub(crate) at_rest: Option<f64>,
    /// The state at its first sample.
    pub(crate) start: Start<f64>,
    /// Number of its first block in the record.
    first_block: usize,
    /// Samples in each of its blocks, but for the last.
    block_length: usize,
}

impl Stretch {
    /// The block of sample `k`.
    pub(crate) fn block(&self, k: usize) -> usize {
        self.first_block + k / self.block_length
    }

    /// The commands, with the moments at which they come into force.
    pub(crate) fn commands(&self) -> Commands<'_> {
        Commands {
            levels: &self.input,
            late_s: self.late_s.as_deref(),
        }
    }

    /// The command in force so many steps of the integration after the first sample.
    pub(crate) fn command_at(&self, step: usize, grid: &Grid) -> f64 {
        let sample = step / grid.steps;
        let since_s = (step % grid.steps) as f64 * grid.period_s / grid.steps as f64;
        let is_late = self
            .late_s
            .as_ref()
            .is_some_and(|late_s| since_s < late_s[sample]);
        self.input[sample.saturating_sub(usize::from(is_late))]
    }

    /// Its blocks.
    pub(crate) fn blocks(&self) -> Range<usize> {
        self.first_block..self.first_block + self.input.len().div_ceil(self.block_length)
    }
}

/// The stretches of a record, and the fold that each of their blocks belongs to. `controllers` has the controller of each run.
pub(crate) fn stretches(record: &Record, controllers: &[usize]) -> (Vec<Stretch>, Vec<usize>) {
    let record = &record.with_bridged_inputs();
    let block_length = (record.samples() / BLOCKS).max(1);
    let mut all: Vec<Stretch> = Vec::new();
    for (run, samples) in record.runs().iter().enumerate() {
        let known: Vec<bool> = samples.input().iter().map(|u| !u.is_nan()).collect();
        let mut at = 0;
        for part in known.chunk_by(|a, b| a == b) {
            let range = at..at + part.len();
            at = range.end;
            let output = &samples.output()[range.clone()];
            // The start of the motion is taken from the first output.
            let Some(lead) = output.iter().position(|y| !y.is_nan()) else {
                continue;
            };
            if !part[0] || part.len() - lead < SHORTEST {
                continue;
            }
            let first = range.start + lead;
            let at_rest = samples.input_at_rest().filter(|_| first == 0);
            let output = output[lead..].to_vec();
            all.push(Stretch {
                run,
                first,
                input: samples.input()[first..range.end].to_vec(),
                late_s: (samples.late_inputs()).map(|late_s| late_s[first..range.end].to_vec()),
                controller: controllers.get(run).copied().unwrap_or(0),
                at_rest,
                start: Start::at_rest(
                    first_rest(&samples.input()[first..range.end], &output, at_rest),
                    at_rest,
                ),
                output,
                first_block: 0,
                block_length,
            });
        }
    }
    let mut blocks = 0;
    for stretch in &mut all {
        // Blocks of a stretch are equally long: the last one is no remainder of a few samples.
        let count = (stretch.input.len() / block_length).max(1);
        stretch.block_length = stretch.input.len().div_ceil(count);
        stretch.first_block = blocks;
        blocks = stretch.blocks().end;
    }
    let folds = folds(&all, blocks, record.runs().len());
    (all, folds)
}

/// Samples whose mean is taken for the output at the start, at the most.
const FIRST_REST: usize = 200;

/// The output in which a stretch begins, if at rest: the mean of its samples under the first command, as long as those of both
/// halves agree. The noise of a single one would stay in the simulation for the whole first hold where friction or a dead band
/// hold the shaft.
fn first_rest(input: &[f64], output: &[f64], at_rest: Option<f64>) -> f64 {
    // A command that changes with the first sample moves the servo as soon as its delay is over, which may be at once.
    let constant = match at_rest.is_none_or(|before| before == input[0]) {
        true => input.iter().take_while(|u| **u == input[0]).count(),
        false => 1,
    };
    let mut length = constant.min(FIRST_REST).min(output.len());
    let noise = noise_sd(output);
    let mean = |part: &[f64]| {
        let known: Vec<f64> = part.iter().copied().filter(|y| !y.is_nan()).collect();
        known.iter().sum::<f64>() / known.len() as f64
    };
    while length > 1 {
        let (early, late) = output[..length].split_at(length / 2);
        let chance = 4.0 * noise * (4.0 / length as f64).sqrt();
        if (mean(early) - mean(late)).abs() <= chance {
            return mean(&output[..length]);
        }
        length /= 2;
    }
    output[0]
}

/// Standard deviation of what changes from sample to sample without a trend, from third differences: robust against
/// strokes, whose share of the samples is small.
pub(crate) fn noise_sd(output: &[f64]) -> f64 {
    let third = |w: &[f64]| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).abs();
    let mut differences: Vec<f64> = output
        .windows(4)
        .map(third)
        .filter(|d| !d.is_nan())
        .collect();
    if differences.is_empty() {
        return 0.0;
    }
    differences.sort_by(f64::total_cmp);
    // The median of |x| is 0.6745 sd; a third difference of white noise has sqrt(20) times its sd.
    differences[differences.len() / 2] / 0.6745 / 20f64.sqrt()
}

/// Parts that the choice of terms leaves out in turn.
pub(crate) const FOLDS: usize = 4;

/// Deals the blocks to the folds, or whole runs where there is one for each fold. Dealing by the sum of the digits in base
/// [`FOLDS`] (the generalised Thue-Morse sequence) has no period, so no fold gets all strokes of one direction.
fn folds(stretches: &[Stretch], blocks: usize, runs: usize) -> Vec<usize> {
    let mut folds = vec![0; blocks];
    for stretch in stretches {
        let own = stretch.blocks();
        for (block, fold) in own.clone().zip(&mut folds[own]) {
            let dealt = if runs >= FOLDS { stretch.run } else { block };
            *fold = digit_sum(dealt) % FOLDS;
        }
    }
    folds
}

/// Sum of the digits of a number in base [`FOLDS`].
fn digit_sum(mut number: usize) -> usize {
    let mut sum = 0;
    while number > 0 {
        sum += number % FOLDS;
        number /= FOLDS;
    }
    sum
}
