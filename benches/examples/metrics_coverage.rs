//! Prints how often the 99 % intervals of the metrics hold the exact figures of linear servos.
//!
//! `cargo run --release -p servoid-benches --example metrics_coverage -- RUNS`

use servoid_identification::Settling;
use servoid_test_support::arguments;
use servoid_test_support::metrics_coverage::{Case, NAMES, run};
use servoid_test_support::servos::Linear;

fn main() {
    let runs = arguments::count(300);
    println!(
        "| servo | noise | N |{}",
        NAMES.map(|name| format!(" {name} |")).concat()
    );
    println!("|---|---|---|{}", "---|".repeat(NAMES.len()));
    for zeta in [0.5, 0.7, 0.78, 0.9, 1.5] {
        for (noise, settling) in [
            (1.0, Settling::Auto),
            (1.0, Settling::Samples(201)),
            (10.0, Settling::Samples(201)),
        ] {
            let case = Case {
                servo: Linear::second_order(0.97, 0.0255, zeta, 60.0),
                sample_phase_s: 0.0005,
                noise,
                settling,
                level: 0.99,
            };
            let cells = run(&case, runs, 50_000).map(|found| {
                format!(
                    " {:.1} % ({:.4}, closed {:.0} %, bias {:+.1e} of {:.4}) |",
                    100.0 * found.share,
                    found.width,
                    100.0 * found.closed,
                    found.bias,
                    found.exact
                )
            });
            println!("| {zeta}/60 | {noise} | {settling} |{}", cells.concat());
        }
    }
}
