//! Measures how often bounds hold on hard recordings whose numbers are drawn, so that none of them was looked at before:
//!
//! ```sh
//! cargo run --release -p servoid-benches --example drawn_lines -- 100 1 44
//! ```
//!
//! The numbers are those of recordings for each line, the seed of the lines, and how many lines are drawn.

use servoid_identification::Options;
use servoid_test_support::arguments;
use servoid_test_support::coverage::Line;
use servoid_test_support::drawn_lines::drawn_lines;

fn main() {
    let runs = arguments::count(100);
    let mut further = std::env::args().skip(2).map(|text| {
        text.parse()
            .expect("the seed and the count of lines are numbers")
    });
    let (seed, count) = (further.next().unwrap_or(1), further.next().unwrap_or(44));
    println!("{}", Line::HEADING);
    for line in drawn_lines(seed, count as usize) {
        println!("{}", line.measure(runs, &Options::default()));
    }
}
