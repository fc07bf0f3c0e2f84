//! Prints which pairs of recordings a comparison says to differ by a shift in time alone.
//!
//! ```sh
//! cargo run --release -p servoid-benches --example shifted_pairs -- 40
//! ```
//!
//! The number is that of pairs for each line; seeds begin at 0. A second argument is another first seed.

use servoid_test_support::arguments;
use servoid_test_support::shifted_pairs::Second::{self, Damped, Gain, Lagging, Later, Quicker};

const SECOND: [(&str, Second); 16] = [
    ("1 ms later", Later(0.001)),
    ("2 ms later", Later(0.002)),
    ("5 ms earlier", Later(-0.005)),
    ("10 ms later", Later(0.01)),
    ("20 ms earlier", Later(-0.02)),
    ("the same", Later(0.0)),
    ("bandwidth -3 %", Quicker(0.97)),
    ("bandwidth -8 %", Quicker(0.92)),
    ("bandwidth -20 %", Quicker(0.8)),
    ("bandwidth -50 %", Quicker(0.5)),
    ("bandwidth +15 %", Quicker(1.15)),
    ("damping -15 %", Damped(0.85)),
    ("damping +30 %", Damped(1.3)),
    ("a further lag of 3 ms", Lagging(0.003)),
    ("a further lag of 10 ms", Lagging(0.01)),
    ("gain -3 %", Gain(0.97)),
];

fn main() {
    let pairs = arguments::count(40);
    let first = std::env::args().nth(2).and_then(|text| text.parse().ok());
    let first = first.unwrap_or(0);
    println!(
        "| the second servo beside the first | with bounds | a shift alone | more than a shift | intervals of the shift hold |"
    );
    println!("|---|---|---|---|---|");
    for (label, second) in SECOND {
        let said = second.said(pairs, first);
        let held = match said.intervals {
            0 => String::new(),
            all => format!("{} of {all}", said.held),
        };
        println!(
            "| {label} | {} of {} | {} | {} | {} |",
            said.claimed, said.pairs, said.shift_alone, said.more, held
        );
    }
}
