//! Prints what the comparison says of many pairs of recordings of simulated servos: of one servo
//! twice, with and without what scatters from run to run, and of servos that do differ.
//!
//! `cargo run --release -p servoid-benches --example verdict_pairs -- PAIRS`

use servoid_identification::comparison::{Comparison, DifferencePercent, Verdict};
use servoid_test_support::arguments;
use servoid_test_support::trials::verdicts::{compare_pairs, count};

/// What is compared with what.
const CASES: [(&str, [&str; 2]); 8] = [
    ("bench, noise alone", ["bench"; 2]),
    (
        "bench, phase of the servo's clock",
        ["bench?scatter=clock"; 2],
    ),
    (
        "bench, supply and friction",
        ["bench?scatter=supply,friction"; 2],
    ),
    ("bench, all scatter", ["bench?scatter=all"; 2]),
    ("aircraft, noise alone", ["aircraft"; 2]),
    ("aircraft, all scatter", ["aircraft?scatter=all"; 2]),
    (
        "bench against aircraft, all scatter",
        ["bench?scatter=all", "aircraft?scatter=all"],
    ),
    ("linear, gain -10 %", ["linear", "linear?gain=0.9"]),
];

fn mean(found: &[Comparison], of: fn(&DifferencePercent) -> f64) -> f64 {
    let bounds = found.iter().filter_map(|c| c.bounds.valid());
    bounds.map(|b| of(&b.difference_percent)).sum::<f64>() / found.len() as f64
}

fn main() {
    let pairs = arguments::count(100);
    println!("{pairs} pairs a line, seeds 2k and 2k + 1, margin 5 %\n");
    println!(
        "| pairs | different | undecided | same | mean at least % | mean at most % | largest at most % |"
    );
    println!("|---|---|---|---|---|---|---|");
    for (name, servos) in CASES {
        let found = compare_pairs(servos, 0..pairs);
        let most = found
            .iter()
            .filter_map(|c| c.bounds.valid())
            .map(|bounds| bounds.difference_percent.at_most)
            .fold(0.0, f64::max);
        println!(
            "| {name} | {} | {} | {} | {:.2} | {:.2} | {most:.2} |",
            count(&found, Verdict::Different),
            count(&found, Verdict::Undecided),
            count(&found, Verdict::Same),
            mean(&found, |d| d.at_least),
            mean(&found, |d| d.at_most),
        );
    }
}
