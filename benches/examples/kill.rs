//! Kills captures at random moments; prints how much of each was missing in its file.
//!
//! ```text
//! cargo build --release && cargo run --release -p servoid-benches --example kill [KILLS]
//! ```
//!
//! The exit code is 1 if a file could not be read, or if more than the last 40 ms of rows were missing
//! in one, the time by which the machine itself was late not counted.

use rand::{RngExt, SeedableRng};
use servoid_test_support::arguments;
use servoid_test_support::trials::kill;
use std::process::ExitCode;
use std::time::Duration;

fn main() -> ExitCode {
    let kills: u32 = arguments::count(100);
    // The program lies beside the folder of the examples.
    let example = std::env::current_exe().unwrap_or_default();
    let servoid = example.with_file_name("").join("../servoid");
    let folder = std::env::temp_dir();
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
    let (mut worst, mut unreadable, mut late) = (Duration::ZERO, 0, 0);
    let mut missing = Vec::new();
    for kill in 0..kills {
        let at = Duration::from_millis(rng.random_range(200..3_000));
        match kill::trial(&servoid, &folder, at) {
            Ok(cost) => {
                if cost.missing > Duration::from_millis(40) + cost.lateness {
                    late += 1;
                }
                worst = worst.max(cost.missing);
                missing.push(cost.missing);
            }
            Err(how) => {
                eprintln!("kill {kill} at {at:?}: {how}");
                unreadable += 1;
            }
        }
    }
    missing.sort();
    let middle = missing.get(missing.len() / 2).copied().unwrap_or_default();
    println!(
        "{kills} kills: {unreadable} files unreadable; missing: median {middle:.1?}, at most {worst:.1?}; {late} beyond 40 ms and the machine's own lateness"
    );
    if unreadable == 0 && late == 0 {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
