//! Measures how often bounds of a servo's mean hold where its runs scatter, and what they cost where they do not:
//!
//! ```sh
//! cargo run --release -p servoid-benches --example scattering_runs -- 100
//! ```
//!
//! The number is that of recordings for each line.

use servoid_identification::Options;
use servoid_test_support::arguments;
use servoid_test_support::coverage::Line;
use servoid_test_support::scattering_runs::scattering_runs;

fn main() {
    let runs = arguments::count(100);
    println!("{}", Line::HEADING);
    for line in scattering_runs() {
        println!("{}", line.measure(runs, &Options::default()));
    }
}
