//! Captures over bad lines, by the thousand; prints what came of them.
//!
//! ```text
//! cargo run --release -p servoid-benches --example chaos [SEEDS [FIRST]]
//! ```
//!
//! Each seed is one capture of a short run, on a simulated rig, through a line that loses, corrupts,
//! doubles, delays and holds up frames both ways. The exit code is 1 if one of them was silently
//! wrong or hung, or if fewer than 99.9 % were complete at 1 %.

use servoid_test_support::bad_line::Faults;
use servoid_test_support::trials::chaos::trial;
use servoid_test_support::trials::judge::Outcome;
use std::process::ExitCode;

fn main() -> ExitCode {
    let mut numbers = std::env::args().skip(1).map(|text| text.parse::<u64>());
    let seeds = numbers.next().and_then(Result::ok).unwrap_or(10_000);
    let first = numbers.next().and_then(Result::ok).unwrap_or(0);
    println!("{seeds} captures a line, seeds from {first}; rates are of frames, each way");
    println!("| lost and corrupted | complete | partial | refused | silently wrong |");
    println!("|-------------------:|---------:|--------:|--------:|---------------:|");
    let mut good = true;
    for rate in [0.01, 0.05] {
        let faults = Faults::of_rate(rate);
        let (mut complete, mut partial, mut refused, mut wrong) = (0_u64, 0_u64, 0_u64, 0_u64);
        for seed in first..first + seeds {
            match trial(seed, faults, faults) {
                Ok(Outcome::Complete) => complete += 1,
                Ok(Outcome::Partial) => partial += 1,
                Ok(Outcome::Refused) => refused += 1,
                Err(how) => {
                    eprintln!("rate {rate}, seed {seed}: {how}");
                    wrong += 1;
                }
            }
        }
        let percent = 100.0 * rate;
        println!("| {percent} % + {percent} % | {complete} | {partial} | {refused} | {wrong} |");
        let enough = rate > 0.01 || complete as f64 >= 0.999 * seeds as f64;
        good &= wrong == 0 && enough;
    }
    if good {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
