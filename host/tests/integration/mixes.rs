//! Everything at once: line, terminal, disk, signals, another host, and a rig that lies.

use servoid_test_support::trials::mixes::{Outcome, trial};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

/// Programs at a time: they wait most of the time.
const AT_ONCE: usize = 8;

/// Runs the mixes of these seeds, requires that none is hung or wrong, returns how many were complete, partial and
/// refused.
fn tally(seeds: std::ops::Range<u64>) -> [usize; 3] {
    let next = AtomicU64::new(seeds.start);
    let work = || {
        let mut outcomes = Vec::new();
        loop {
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if seed >= seeds.end {
                return outcomes;
            }
            let folder = tempfile::tempdir().unwrap();
            let servoid = Path::new(env!("CARGO_BIN_EXE_servoid"));
            outcomes.push(trial(servoid, folder.path(), seed).map_err(|how| (seed, how)));
        }
    };
    let outcomes: Vec<_> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..AT_ONCE).map(|_| scope.spawn(work)).collect();
        workers
            .into_iter()
            .flat_map(|worker| worker.join().unwrap())
            .collect()
    });
    let wrong: Vec<_> = outcomes.iter().filter_map(|it| it.as_ref().err()).collect();
    assert!(wrong.is_empty(), "{} wrong: {wrong:#?}", wrong.len());
    [Outcome::Complete, Outcome::Partial, Outcome::Refused]
        .map(|which| outcomes.iter().filter(|it| **it == Ok(which)).count())
}

#[test]
#[ignore = "ten seconds: cargo test -p servoid --test integration -- --ignored some_mixes"]
fn some_mixes_of_everything_are_neither_hung_nor_wrong() {
    tally(0..8);
}

#[test]
#[ignore = "three seconds: cargo test -p servoid --test integration -- --ignored more_mixes"]
fn more_mixes_of_everything_are_neither_hung_nor_wrong() {
    tally(8..24);
}

#[test]
#[ignore = "a quarter of an hour: cargo test -p servoid --test integration -- --ignored --nocapture a_thousand_mixes; FIRST=206 MIXES=1 for some of them"]
fn a_thousand_mixes_of_everything_are_neither_hung_nor_wrong() {
    let number = |name: &str, usual| std::env::var(name).map_or(usual, |it| it.parse().unwrap());
    let (first, mixes) = (number("FIRST", 0), number("MIXES", 1_000));
    let [complete, partial, refused] = tally(first..first + mixes);
    println!(
        "{mixes} mixes: {complete} complete, {partial} partial, {refused} refused; 0 hung, 0 wrong"
    );
}
