//! A record as the fit sees it: stretches with a known command.
//!
//! A stretch ends where the input is missing, since the motion after that is not known; the next one begins with a
//! start of its own. Missing outputs are not compared. A stretch is divided into blocks, which the choice of terms
//! leaves out in turn.

use crate::data::Record;
use servoid_dynamics::Start;

/// Blocks of a record, at least: enough to show whether an advantage exceeds its scatter.
const BLOCKS: usize = 32;

/// Samples of a stretch, at least: a shorter one shows its start and little else.
const SHORTEST: usize = 4;

/// Consecutive samples of one run with all inputs known.
#[derive(Clone, Debug)]
pub(super) struct Stretch {
    /// Index of the run in the record.
    pub(super) run: usize,
    /// Its first sample in the run.
    pub(super) first: usize,
    /// The commands.
    pub(super) input: Vec<f64>,
    /// The outputs, NaN where missing.
    pub(super) output: Vec<f64>,
    /// Which of the controllers drove it.
    pub(super) controller: usize,
    /// The servo stood still before it, under this command.
    pub(super) at_rest: Option<f64>,
    /// The state at its first sample.
    pub(super) start: Start<f64>,
    /// Number of its first block in the record.
    first_block: usize,
    /// Samples in each of its blocks, but for the last.
    block_length: usize,
}

impl Stretch {
    /// The block of sample `k`.
    pub(super) fn block(&self, k: usize) -> usize {
        self.first_block + k / self.block_length
    }

    fn blocks(&self) -> usize {
        self.input.len().div_ceil(self.block_length)
    }
}

/// The stretches of a record, and the fold that each of their blocks belongs to. `controllers` has the controller of each run.
pub(super) fn stretches(record: &Record, controllers: &[usize]) -> (Vec<Stretch>, Vec<usize>) {
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
                controller: controllers.get(run).copied().unwrap_or(0),
                at_rest,
                start: Start::at_rest(output[0], at_rest),
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
        blocks += stretch.blocks();
    }
    let folds = folds(&all, blocks, record.runs().len());
    (all, folds)
}

/// Parts that the choice of terms leaves out in turn.
pub(super) const FOLDS: usize = 4;

/// Deals the blocks to the folds, or whole runs where there is one for each fold. Dealing by the sum of the digits in base
/// [`FOLDS`] (the generalised Thue-Morse sequence) has no period, so no fold gets all strokes of one direction.
fn folds(stretches: &[Stretch], blocks: usize, runs: usize) -> Vec<usize> {
    let mut folds = vec![0; blocks];
    for stretch in stretches {
        let own = stretch.first_block..stretch.first_block + stretch.blocks();
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
