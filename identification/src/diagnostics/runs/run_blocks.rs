//! What the errors of a model show of a servo, block by block of each run, and how that changes along the runs.
//!
//! A change is held against the scatter from block to block, whatever causes that. A motion that itself changes along the run may do as much
//! to a servo that is not linear. So what goes with the size of the motion of a block is taken out first, and a record whose command has another
//! range, goes another way or moves more often in its second half is not asked. The blocks at both ends of a run are left out, and those with an answer to its first two strokes or its last one: a run
//! begins and ends at some neutral position, with strokes that no other block has, after which a servo with a dead band rests elsewhere.
//!
//! What the strokes of a servo that is not linear leave in a block, they leave in that block of each run of the same [reference](References). So blocks at one place of one
//! reference are one block, with their mean: several runs have less noise, and no more strokes.
//!
//! Blocks of a linear servo scatter as their noise does, which may be louder in some. Those of a servo that is not linear differ by much more, each by what its strokes
//! are, and one or two with little noise must not decide. So a change has to be beyond chance with two kinds of weights, those of the noise w and those that allow
//! for a variance v between blocks, whose estimate comes from the weighted squares Q that w leaves with d degrees of freedom (DerSimonian and Laird, *Meta-analysis in
//! clinical trials*, Controlled Clinical Trials 7, 1986):
//!
//! ```text
//! w' = 1/(1/w + v),     v = max(0, (Q - d) / Σ w (1 - h)),     h: leverage of a block
//! ```

use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::data::column::span;
use crate::data::{Moments, Record, References, Run, between_ends};
use crate::diagnostics::residuals::simulation_error::{Simulated, simulated_whole};
use crate::estimation::GlsFit;
use crate::thresholds::{RANGES_ALIKE, WAYS_ALIKE};

/// Blocks of a record, and of each run at least.
const BLOCKS: usize = 24;
const BLOCKS_OF_RUN: usize = 8;

/// The shortest block, in lengths of the history: its ends are those of other blocks, too.
const HISTORIES: usize = 2;

/// Size of the motion, in parts of the root mean square of all blocks, below which nothing moves: such a block shows nothing, and is no degree of freedom.
const STILL: f64 = 1e-3;

/// What a block shows.
pub(super) struct Block {
    /// Its run, and then its reference.
    run: usize,
    /// Its middle \[samples\].
    pub(super) at: f64,
    /// Coefficient of a regressor in the errors.
    value: f64,
    /// Root of the sum of squares of the regressor: the size of the motion.
    size: f64,
    /// The inverse of the variance of `value`, but for what the colour of the noise makes of all alike.
    weight: f64,
}

/// The blocks of a record.
pub(super) struct Blocks {
    blocks: Vec<Block>,
    /// Number of references.
    references: usize,
    /// The longest run \[samples\].
    pub(super) longest: usize,
}

impl Blocks {
    /// Those of `record`, each with the coefficient of `regressor` in the errors of `fit`. `None`, and nothing is simulated, where the command does not
    /// move as far, as much and as often in both halves of each run.
    pub(super) fn of(
        record: &Record,
        moments: &Moments,
        fit: &GlsFit,
        regressor: fn(&Simulated<'_>) -> Vec<f64>,
    ) -> Option<Self> {
        if !record.runs().iter().all(is_even) {
            return None;
        }
        let runs = simulated_whole(record, moments, fit);
        let references = References::of(runs.iter().map(|run| &run.run));
        let lengths = &references.lengths;
        let history = fit.coordinates.basis.settling();
        let of_record = lengths.iter().sum::<usize>() / BLOCKS;
        let of_run = lengths.iter().min()? / BLOCKS_OF_RUN;
        let length = of_record.min(of_run).max(HISTORIES * history);
        let of_run = |(index, run): (usize, &Simulated<'_>)| {
            let regressor = regressor(run);
            let parts = (run.errors.chunks_exact(length)).zip(regressor.chunks_exact(length));
            let of_part = |(number, (errors, regressor)): (usize, (&[f64], &[f64]))| {
                Block::of(errors, regressor).map(|block| Block {
                    run: index,
                    at: (number as f64 + 0.5) * length as f64,
                    ..block
                })
            };
            let inner = 1..parts.len().saturating_sub(1);
            let usual = between_ends(run.run.input());
            let inner = parts.enumerate().filter(|(number, _)| {
                let samples = number * length..(number + 1) * length;
                inner.contains(number) && usual.start <= samples.start && samples.end <= usual.end
            });
            inner.filter_map(of_part).collect::<Vec<_>>()
        };
        let mut blocks: Vec<Block> = runs.iter().enumerate().flat_map(of_run).collect();
        keep_moving(&mut blocks);
        Some(Self {
            blocks: of_references(blocks, &references.of_runs),
            references: references.count(),
            longest: lengths.iter().copied().max()?,
        })
    }

    /// The middles of blocks \[samples\], ascending, each once.
    pub(super) fn places(&self) -> Vec<f64> {
        let mut places: Vec<f64> = self.blocks.iter().map(|block| block.at).collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        places
    }

    /// How the values change with a `time` of each block.
    pub(super) fn course(&self, time: &dyn Fn(&Block) -> f64) -> Option<BlockCourse> {
        course(&self.blocks, self.references, time)
    }
}

impl Block {
    /// `None` where nothing moves, or too much is missing.
    fn of(errors: &[f64], regressor: &[f64]) -> Option<Self> {
        let pairs = errors.iter().zip(regressor);
        let known: Vec<(f64, f64)> = (pairs.map(|(e, x)| (*e, *x)))
            .filter(|(e, x)| !(e * x).is_nan())
            .collect();
        let count = known.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| known.iter().map(of).sum::<f64>() / count;
        let (of_errors, of_regressor) = (mean(|pair| pair.0), mean(|pair| pair.1));
        let (mut squares, mut products, mut size) = (0.0, 0.0, 0.0);
        for (error, regressor) in &known {
            let (error, regressor) = (error - of_errors, regressor - of_regressor);
            squares += error * error;
            products += error * regressor;
            size += regressor * regressor;
        }
        let value = products / size;
        // Noise may be louder in one block than in another.
        let weight = size * (count - 2.0) / (squares - value * products);
        (weight.is_finite() && weight > 0.0).then_some(Self {
            run: 0,
            at: 0.0,
            value,
            size: size.sqrt(),
            weight,
        })
    }
}

/// Whether the command moves as far, as much and as often in both halves of a run.
fn is_even(run: &Run<'_>) -> bool {
    let (first, second) = run.input().split_at(run.len() / 2);
    let halves = [first, second];
    let ranges = halves.map(|half| span(half.iter().copied()).unwrap_or_default());
    let steps = halves.map(|half| {
        let steps = half.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        steps.filter(|step| *step > 0.0).collect::<Vec<f64>>()
    });
    let ways = steps.each_ref().map(|steps| steps.iter().sum());
    let moves = steps.each_ref().map(|steps| steps.len() as f64);
    let alike = |[a, b]: [f64; 2], most: f64| a.max(b) <= most * a.min(b);
    alike(ranges, RANGES_ALIKE) && alike(ways, WAYS_ALIKE) && alike(moves, WAYS_ALIKE)
}

/// Leaves those of `blocks` in which something moves.
fn keep_moving(blocks: &mut Vec<Block>) {
    let squares: f64 = blocks.iter().map(|block| block.size.powi(2)).sum();
    let usual = (squares / blocks.len() as f64).sqrt();
    blocks.retain(|block| block.size > STILL * usual);
}

/// Those of each reference, of which `references` has one for each run: at each place one block, with the mean of what the runs have there, each about its own mean.
fn of_references(mut blocks: Vec<Block>, references: &[usize]) -> Vec<Block> {
    let mut sums = vec![[0.0; 2]; references.len()];
    for block in &blocks {
        let [weights, values] = &mut sums[block.run];
        *weights += block.weight;
        *values += block.weight * block.value;
    }
    for block in &mut blocks {
        let [weights, values] = sums[block.run];
        block.value -= values / weights;
        block.run = references[block.run];
    }
    // A stable sort: runs stay in their order.
    blocks.sort_by(|a, b| (a.run.cmp(&b.run)).then(a.at.total_cmp(&b.at)));
    let same = blocks.chunk_by(|a, b| a.run == b.run && a.at == b.at);
    same.map(mean_block).collect()
}

/// The mean of blocks at one place, by their weights.
fn mean_block(blocks: &[Block]) -> Block {
    let weight: f64 = blocks.iter().map(|block| block.weight).sum();
    let mean = |of: fn(&Block) -> f64| {
        let terms = blocks.iter().map(|block| block.weight * of(block));
        terms.sum::<f64>() / weight
    };
    Block {
        run: blocks[0].run,
        at: blocks[0].at,
        value: mean(|block| block.value),
        size: mean(|block| block.size),
        weight,
    }
}

/// How values change with a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BlockCourse {
    /// The coefficient of the time.
    pub(super) slope: f64,
    /// The mean of the time over the blocks.
    pub(super) mean_time: f64,
    /// Probability of a slope as far from 0.
    pub(super) p: f64,
}

/// That of the values of `blocks`, each reference with a mean of its own and all with one effect of the size of the motion.
fn course(
    blocks: &[Block],
    references: usize,
    time: &dyn Fn(&Block) -> f64,
) -> Option<BlockCourse> {
    let degrees = blocks.len().checked_sub(references + 3)? as f64;
    let of_noise: Vec<f64> = blocks.iter().map(|block| block.weight).collect();
    let by_noise = Line::of(blocks, &of_noise, references, time);
    let between = ((by_noise.left - degrees) / by_noise.open).max(0.0);
    let beside = |weight: &f64| (weight.recip() + between).recip();
    let beside: Vec<f64> = of_noise.iter().map(beside).collect();
    let line = Line::of(blocks, &beside, references, time);
    // Without degrees of freedom, or without any scatter, nothing is known of chance.
    let distribution = StudentsT::new(0.0, 1.0, degrees).ok()?;
    let t = by_noise.t(degrees).abs().min(line.t(degrees).abs());
    t.is_finite().then(|| BlockCourse {
        slope: line.slope,
        mean_time: line.mean_time,
        p: 2.0 * distribution.sf(t),
    })
}

/// The values of blocks explained by the time, with weights.
struct Line {
    slope: f64,
    mean_time: f64,
    /// Weighted squares of the time beside means and size.
    square: f64,
    /// Weighted squares of what is left of the values.
    left: f64,
    /// The sum of the weights, each times what the line leaves open of its block: 1 less its leverage.
    open: f64,
}

impl Line {
    fn of(
        blocks: &[Block],
        weights: &[f64],
        references: usize,
        time: &dyn Fn(&Block) -> f64,
    ) -> Self {
        let weighted: Vec<(&Block, f64)> = blocks.iter().zip(weights.iter().copied()).collect();
        let row = |block: &Block| [1.0, time(block), block.size, block.value];
        let mut sums = vec![[0.0; 4]; references];
        for (block, weight) in &weighted {
            for (sum, value) in sums[block.run].iter_mut().zip(row(block)) {
                *sum += weight * value;
            }
        }
        let centred = |block: &Block| {
            let (row, sums) = (row(block), sums[block.run]);
            std::array::from_fn::<f64, 3, _>(|i| row[i + 1] - sums[i + 1] / sums[0])
        };
        let sum = |of: &dyn Fn([f64; 3]) -> f64| -> f64 {
            let terms = weighted.iter().map(|(block, w)| w * of(centred(block)));
            terms.sum()
        };
        let (sizes, both) = (sum(&|[_, v, _]| v * v), sum(&|[t, v, _]| t * v));
        // Of blocks of one size throughout there is no effect of it.
        let share = |product: f64| if sizes > 0.0 { product / sizes } else { 0.0 };
        let (of_time, of_value) = (share(both), share(sum(&|[_, v, value]| v * value)));
        let square = sum(&|[t, v, _]| (t - of_time * v).powi(2));
        let slope = sum(&|[t, v, value]| (t - of_time * v) * (value - of_value * v)) / square;
        let left = |[t, v, value]: [f64; 3]| value - of_value * v - slope * (t - of_time * v);
        let open = |(block, weight): &(&Block, f64)| {
            let [t, v, _] = centred(block);
            let of_line = share(v * v) + (t - of_time * v).powi(2) / square;
            weight * (1.0 - weight * (sums[block.run][0].recip() + of_line))
        };
        let times: f64 = sums.iter().map(|[_, time, ..]| time).sum();
        Self {
            slope,
            mean_time: times / weights.iter().sum::<f64>(),
            square,
            left: sum(&|row| left(row).powi(2)),
            open: weighted.iter().map(open).sum(),
        }
    }

    /// The slope in standard deviations, as what is left shows them.
    fn t(&self, degrees: f64) -> f64 {
        self.slope / (self.left / degrees / self.square).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    /// The probability of a step before the last three of 24 blocks, at which the coefficient changes by `change`, and the noise is `louder` times as loud.
    fn p(change: f64, louder: f64, seed: u64) -> f64 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || random.sample::<f64, _>(StandardNormal);
        let block = |number: usize| {
            let (coefficient, noise) = match number < 21 {
                true => (0.0, 0.1),
                false => (change, 0.1 * louder),
            };
            let regressor: Vec<f64> = (0..100).map(|_| normal()).collect();
            let errors = regressor.iter().map(|x| coefficient * x + noise * normal());
            let errors: Vec<f64> = errors.collect();
            let found = Block::of(&errors, &regressor).unwrap();
            Block {
                at: number as f64,
                ..found
            }
        };
        let blocks: Vec<Block> = (0..24).map(block).collect();
        let after = |block: &Block| f64::from(u8::from(block.at > 20.5));
        course(&blocks, 1, &after).unwrap().p
    }

    #[test]
    fn a_coefficient_that_changes_is_found() {
        assert!((0..20).all(|seed| p(0.1, 1.0, seed) < 1e-5));
    }

    /// Blocks of a servo that is not linear differ by much more than their noise, and two at the beginning that have little of it differ from the others.
    #[test]
    fn one_or_two_blocks_with_little_noise_do_not_decide() {
        let claims = (0..200).filter(|seed| {
            let mut random = ChaCha8Rng::seed_from_u64(*seed);
            let block = |number: usize| {
                let value = 0.1 * random.sample::<f64, _>(StandardNormal);
                Block {
                    run: 0,
                    at: number as f64,
                    value,
                    size: random.random_range(1.0..3.0),
                    weight: if number < 2 { 1e6 } else { 1e3 },
                }
            };
            let blocks: Vec<Block> = (0..24).map(block).collect();
            let after = |block: &Block| f64::from(u8::from(block.at > 1.5));
            course(&blocks, 1, &after).unwrap().p < 0.01
        });
        // Two are expected; nine or more are so in one of 4000 trials.
        assert!(claims.count() < 9);
    }

    /// Six runs of one reference of a servo that is not linear: what a block is off by, it is in all of them.
    #[test]
    fn what_repeats_in_each_run_of_a_reference_counts_once() {
        let found = |slope: f64, seed: u64| {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let repeated: Vec<f64> = (0..24).map(|_| random.sample(StandardNormal)).collect();
            let of_run = |run: usize| -> Vec<Block> {
                let block = |(number, repeated): (usize, &f64)| Block {
                    run,
                    at: number as f64,
                    value: repeated
                        + slope * number as f64
                        + 0.1 * random.sample::<f64, _>(StandardNormal)
                        + 5.0 * run as f64,
                    size: 1.0 + 0.1 * number as f64 % 0.7,
                    weight: 100.0,
                };
                repeated.iter().enumerate().map(block).collect()
            };
            let blocks: Vec<Block> = (0..6).flat_map(of_run).collect();
            let blocks = of_references(blocks, &[0; 6]);
            assert_eq!(blocks.len(), 24);
            course(&blocks, 1, &|block: &Block| block.at).unwrap().p
        };
        let chances = (0..200).filter(|seed| found(0.0, *seed) < 0.01);
        // Two are expected; nine or more are so in one of 4000 trials.
        assert!(chances.count() < 9);
        assert!((0..20).all(|seed| found(0.5, seed) < 1e-5));
    }

    #[test]
    fn a_block_in_which_nothing_moves_is_no_degree_of_freedom() {
        let block = |size: f64| Block {
            run: 0,
            at: 0.0,
            value: 1.0 / size,
            size,
            weight: size * size,
        };
        let mut blocks = vec![block(30.0), block(1e-13), block(50.0), block(1e-14)];
        keep_moving(&mut blocks);
        assert_eq!(blocks.len(), 2);
    }

    /// Levels that are held for so many samples in the first half and in the second.
    fn is_even_with_holds(first: usize, second: usize) -> bool {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let mut input = Vec::new();
        for (hold, end) in [(first, 4000), (second, 8000)] {
            while input.len() < end {
                let level = random.random_range(-10.0..10.0);
                input.extend(std::iter::repeat_n(level, hold));
            }
        }
        is_even(&Run::new(input, vec![0.0; 8000]).unwrap())
    }

    /// A servo whose speed is limited answers quick strokes, which it does not end, sooner than whole ones.
    #[test]
    fn a_command_that_moves_more_often_is_another_motion() {
        assert!(is_even_with_holds(80, 80));
        assert!(!is_even_with_holds(80, 20));
    }

    #[test]
    fn noise_that_gets_louder_is_no_change() {
        for louder in [0.02, 1.0, 40.0] {
            let chances = (0..200).filter(|seed| p(0.0, louder, *seed) < 0.01);
            // Two are expected; nine or more are so in one of 4000 trials.
            assert!(chances.count() < 9, "{louder}");
        }
    }
}
