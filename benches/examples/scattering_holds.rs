//! Measures how often bounds hold where something differs from hold to hold: when a command takes effect, or what was written of it.
//!
//! ```sh
//! cargo run --release -p servoid-benches --example scattering_holds -- 300
//! ```
//!
//! The number is that of recordings for each line.

use servoid_test_support::arguments;
use servoid_test_support::scattering_holds::scattering_holds;

fn main() {
    let runs = arguments::count(300);
    println!(
        "| waits of up to ms | written in steps of | levels | noise | claimed % | mean % | worst % | whole % | half width, point / whole |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for holds in scattering_holds() {
        let line = holds.measure(runs);
        let percent = |share: f64| 100.0 * share;
        println!(
            "{} {:.1} | {:.2} | {:.1} | {:.1} | {:.4} / {:.4} |",
            line.label,
            percent(line.claimed),
            percent(line.mean),
            percent(line.worst),
            percent(line.whole),
            line.half_widths.0,
            line.half_widths.1
        );
    }
}
