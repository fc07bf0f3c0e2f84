//! Pairs of recordings of one simulated servo, and the verdict of the comparison.
//!
//! One servo recorded twice must not be called different. The recordings differ in their noise and,
//! where the options ask for `scatter`, in the conditions that no rig holds constant between runs.

use super::recordings::recording;
use servoid_identification::comparison::{Comparison, ComparisonOptions, Verdict, compare};
use servoid_protocol::reference::{Reference, Staircase};

/// Compares recordings of seeds 2k and 2k + 1 for each k in `pairs`, in as many threads as there are
/// processors.
pub fn compare_pairs(servo: [&str; 2], pairs: std::ops::Range<u64>) -> Vec<Comparison> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from) as u64;
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads)
            .map(|first| {
                let own = pairs.clone().skip(first as usize).step_by(threads as usize);
                let one = move |k| {
                    let paper = Reference::Staircase(Staircase::PAPER);
                    let a = recording(servo[0], paper, 2 * k);
                    let b = recording(servo[1], paper, 2 * k + 1);
                    compare(&a, &b, &ComparisonOptions::default()).expect("well excited")
                };
                scope.spawn(move || own.map(one).collect::<Vec<_>>())
            })
            .collect();
        let done = workers.into_iter().map(|worker| worker.join());
        done.flat_map(|found| found.expect("no comparison panics"))
            .collect()
    })
}

/// How many of them were called this.
pub fn count(found: &[Comparison], verdict: Verdict) -> usize {
    found.iter().filter(|c| c.verdict == verdict).count()
}
