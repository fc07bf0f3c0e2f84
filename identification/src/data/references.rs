//! Which runs have one reference.
//!
//! A servo that is not linear leaves the same errors in each run of a reference. There they are no chance that runs average out: what repeats in all runs of one reference
//! counts once, however many there are.

use super::record::Run;

/// Square of the difference of two commands, in parts of that of one about its mean, up to which they are one reference: edges that a logger saw some rows apart. Two draws of
/// random levels differ by twice that square.
const ALIKE: f64 = 0.25;

/// The longer of two runs of one reference, in lengths of the shorter.
const AS_LONG: f64 = 1.1;

/// The reference of each of some runs, numbered from 0 in the order in which they come.
pub(crate) struct References {
    /// Of each run.
    pub(crate) of_runs: Vec<usize>,
    /// The longest run of each \[samples\].
    pub(crate) lengths: Vec<usize>,
}

impl References {
    pub(crate) fn of<'a>(runs: impl Iterator<Item = &'a Run<'a>>) -> Self {
        let (mut of_runs, mut lengths) = (Vec::new(), Vec::new());
        let mut firsts: Vec<&Run> = Vec::new();
        for run in runs {
            let same = firsts.iter().position(|first| are_alike(first, run));
            let reference = same.unwrap_or(firsts.len());
            if same.is_none() {
                firsts.push(run);
                lengths.push(0);
            }
            of_runs.push(reference);
            lengths[reference] = lengths[reference].max(run.len());
        }
        Self { of_runs, lengths }
    }

    /// Number of references.
    pub(crate) fn count(&self) -> usize {
        self.lengths.len()
    }

    /// Whether some of these runs have the same reference as others.
    pub(crate) fn repeat(runs: &[Run]) -> bool {
        Self::of(runs.iter()).count() < runs.len()
    }

    /// How often a sample of these runs is the answer to the same commands.
    pub(crate) fn repeats<'a>(runs: impl Iterator<Item = &'a Run<'a>> + Clone) -> f64 {
        let samples: usize = runs.clone().map(Run::len).sum();
        let of_references: usize = Self::of(runs).lengths.iter().sum();
        samples as f64 / of_references.max(1) as f64
    }
}

/// Whether two runs have commands that go together.
fn are_alike(a: &Run, b: &Run) -> bool {
    let lengths = [a.len(), b.len()].map(|length| length as f64);
    if lengths[0].max(lengths[1]) > AS_LONG * lengths[0].min(lengths[1]) {
        return false;
    }
    let pairs = a.input().iter().zip(b.input());
    let known: Vec<(f64, f64)> = (pairs.map(|(a, b)| (*a, *b)))
        .filter(|(a, b)| !(a + b).is_nan())
        .collect();
    let mean = known.iter().map(|(a, _)| a).sum::<f64>() / known.len() as f64;
    let square: f64 = known.iter().map(|(a, _)| (a - mean).powi(2)).sum();
    let difference: f64 = known.iter().map(|(a, b)| (a - b).powi(2)).sum();
    difference <= ALIKE * square
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Random levels, each held for 100 samples, the first for `first`.
    fn levels(seed: u64, first: usize) -> Run<'static> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut level = || random.random_range(-10.0..10.0);
        let mut input = vec![level(); first];
        while input.len() < 3000 {
            input.extend(std::iter::repeat_n(level(), 100));
        }
        let output = vec![0.0; input.len()];
        Run::new(input, output).unwrap()
    }

    #[test]
    fn edges_some_rows_apart_are_of_one_reference_and_other_levels_are_not() {
        let runs = [
            levels(1, 100),
            levels(2, 100),
            levels(1, 102),
            levels(2, 100),
            levels(1, 150),
        ];
        let found = References::of(runs.iter());
        assert_eq!(found.of_runs, [0, 1, 0, 1, 2]);
        assert_eq!(found.count(), 3);
        assert_eq!(found.lengths[0], 3002);
    }

    #[test]
    fn a_run_that_is_much_shorter_has_another_reference() {
        let whole = levels(1, 100);
        let runs = [
            whole.part(0..2900),
            whole.part(0..1500),
            whole.part(0..3000),
        ];
        assert_eq!(References::of(runs.iter()).of_runs, [0, 1, 0]);
    }
}
