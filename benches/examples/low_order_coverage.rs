//! The table "Low-order models" of docs/method.md:
//!
//! ```sh
//! cargo run --release -p servoid-benches --example low_order_coverage -- 150
//! ```
//!
//! The number is that of recordings for each line; seeds begin at 0. A second argument is another first seed.

use servoid_test_support::arguments;
use servoid_test_support::low_order_coverage::low_order_lines;

fn main() {
    let runs = arguments::count(150);
    let first = std::env::args().nth(2).and_then(|text| text.parse().ok());
    let first = first.unwrap_or(0);
    println!("| input, servo | rejected | gain | delay | ω | ζ | lag |");
    println!("|---|---|---|---|---|---|---|");
    for line in low_order_lines() {
        let found = line.measure(runs, first);
        let held = found.held.map(|tally| tally.to_string()).join(" | ");
        let (rejected, fitted) = (found.rejected, found.fitted);
        println!("| {} | {rejected} of {fitted} | {held} |", line.label());
    }
}
