//! Prints how often comparisons of two servos with slow ends hold the truth.
//!
//! `cargo run --release -p servoid-benches --example compared_ends -- PAIRS`

use servoid_identification::comparison::ComparisonOptions;
use servoid_test_support::arguments;
use servoid_test_support::compared_ends::ComparedEnds;
use servoid_test_support::hard_lines::Drive::{self, Prbs, Staircase};
use servoid_test_support::plants::Noise::{self, Ar1, Ar2, Arma};
use servoid_test_support::plants::Plant::{self, A, B, C, D};

/// Without a slow end.
const NONE: (f64, f64) = (0.0, 0.4);

/// Reference, plant, noise and its factor; share and time constant \[s\] of the slow end of each servo; gain of the second; how far strokes
/// up and down of both differ.
type Case = (Drive, Plant, Noise, f64, [(f64, f64); 2], f64, f64);

const CASES: [Case; 10] = [
    (Staircase, C, Ar1, 1.0, [NONE; 2], 1.0, 0.0),
    (Staircase, C, Ar1, 5.0, [NONE, (0.1, 0.4)], 1.0, 0.0),
    (Staircase, C, Ar1, 5.0, [(0.1, 0.2), (0.1, 0.4)], 0.93, 0.0),
    (Staircase, C, Ar1, 1.0, [NONE, (0.03, 0.4)], 1.0, 0.06),
    (Staircase, B, Ar1, 3.0, [NONE, (0.08, 0.5)], 1.0, 0.0),
    (Prbs, D, Ar1, 5.0, [(0.05, 0.3), NONE], 0.97, 0.0),
    (Staircase, A, Ar2, 5.0, [(0.04, 0.6), NONE], 1.0, 0.0),
    (
        Staircase,
        A,
        Ar1,
        5.0,
        [(-0.06, 0.3), (0.04, 0.5)],
        1.0,
        0.0,
    ),
    (Staircase, B, Ar1, 5.0, [(0.05, 0.6); 2], 0.955, 0.0),
    (Staircase, A, Arma, 2.0, [NONE, (0.05, 0.5)], 1.0, 0.0),
];

fn main() {
    let pairs = arguments::count(30) as u64;
    println!(
        "{pairs} pairs a line, margin 5 %, level 99 %; \"split\" counts those compared by strokes up and down\n"
    );
    println!(
        "| reference, plant, noise, times | slow ends | gain | strokes differ by | level | split | curves hold | gain holds | largest holds | different | same | wrong | half width % | mean at most % |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for (drive, plant, noise, scale, ends, gain, lean) in CASES {
        let case = ComparedEnds {
            drive,
            plant,
            noise,
            scale,
            ends,
            gain,
            lean,
        };
        let found = case.compare(pairs, &ComparisonOptions::default());
        let end = |(share, seconds): (f64, f64)| match share {
            0.0 => "none".to_owned(),
            _ => format!("{:.0} % with {seconds} s", 100.0 * share),
        };
        println!(
            "| {drive:?}, {plant:?}, {noise:?}, {scale} | {}; {} | {gain} | {:.0} % | {} | {} | {} | {} | {} | {} | {} | {} | {:.2} | {:.1} |",
            end(ends[0]),
            end(ends[1]),
            200.0 * lean,
            found.claimed,
            found.split,
            found.whole,
            found.gain,
            found.largest,
            found.different,
            found.same,
            found.wrong,
            found.half_percent,
            found.at_most_percent,
        );
    }
}
