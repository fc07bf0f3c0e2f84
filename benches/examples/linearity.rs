//! Prints the findings of identification in the simulated servos under references of every kind and size, as the
//! documentation's table on servos that are not linear.
//!
//! `cargo run --release -p servoid-benches --example linearity -- [SEEDS]`

use servoid_test_support::arguments;
use servoid_test_support::trials::linearity::{Findings, Motion, findings, motions};

/// Degrees to each side.
const SIZES_DEG: [f64; 5] = [1.0, 2.5, 5.0, 10.0, 30.0];

/// Of a reference and servo, over all sizes and seeds.
struct Line {
    findings: Vec<Findings>,
    /// Differences of gain \[%\] and delay \[ms\] from those under the staircase of the same size, where
    /// bounds have a level.
    apart: Vec<[f64; 2]>,
    refused: usize,
}

impl Line {
    fn of(servo: &str, motion: &Motion, staircase: &Motion, seeds: u64) -> Self {
        let mut line = Self {
            findings: Vec::new(),
            apart: Vec::new(),
            refused: 0,
        };
        for degrees in SIZES_DEG {
            for seed in 1..=seeds {
                let Ok(found) = findings(servo, motion.of_size(degrees), seed) else {
                    line.refused += 1;
                    continue;
                };
                line.findings.push(found);
                let held = findings(servo, staircase.of_size(degrees), 1000 + seed).ok();
                line.apart
                    .extend(held.and_then(|held| apart(&found, &held)));
            }
        }
        line
    }

    fn count(&self, what: impl Fn(&Findings) -> bool) -> usize {
        self.findings
            .iter()
            .filter(|findings| what(findings))
            .count()
    }

    fn largest(&self, which: usize) -> f64 {
        let sizes = self.apart.iter().map(|apart| apart[which].abs());
        sizes.fold(0.0, f64::max)
    }
}

fn apart(found: &Findings, held: &Findings) -> Option<[f64; 2]> {
    let (gain, other) = (found.gain.filter(|_| found.level)?, held.gain?);
    let (delay, reference) = (found.delay_ms?, held.delay_ms?);
    Some([100.0 * (gain / other - 1.0), delay - reference])
}

fn main() {
    let seeds = arguments::count(2);
    let motions = motions();
    println!("{SIZES_DEG:?} degrees, {seeds} seeds each\n");
    println!(
        "| servo | reference | recordings | by functions | by rest | reported | level kept | simulation leaves % | gain apart % | delay apart ms |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for servo in ["bench", "aircraft", "linear"] {
        for motion in &motions {
            let line = Line::of(servo, motion, &motions[0], seeds);
            let leaves = || line.findings.iter().map(|findings| findings.leaves_percent);
            println!(
                "| {servo} | {} | {} | {} | {} | {} | {} | {:.0}-{:.0} | {:.1} | {:.1} |",
                motion.name,
                line.findings.len() + line.refused,
                line.count(|findings| findings.found[0]),
                line.count(|findings| findings.found[1]),
                line.count(|findings| findings.reported),
                line.count(|findings| findings.level),
                leaves().fold(f64::INFINITY, f64::min),
                leaves().fold(0.0, f64::max),
                line.largest(0),
                line.largest(1),
            );
        }
    }
}
