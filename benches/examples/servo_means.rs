//! Prints what comparisons of several runs a side say of servos whose runs scatter.
//!
//! `cargo run --release -p servoid-benches --example servo_means -- PAIRS`

use servoid_test_support::arguments;
use servoid_test_support::servo_means::Means;

/// Runs a side; scatter of gain \[share\], delay \[s\] and natural frequency \[share\]; relative gain of the second, and how much later it is \[s\]. A gain of 0.957
/// is at the margin: the difference is largest where the response overshoots, by 16 %.
const CASES: [(usize, [f64; 3], f64, f64); 9] = [
    (3, [0.005, 0.0, 0.0], 0.957, 0.0),
    (3, [0.005, 0.0, 0.0], 1.0, 0.0),
    (3, [0.02, 0.001, 0.0], 0.9, 0.004),
    (3, [0.02, 0.001, 0.0], 1.0, 0.0),
    (5, [0.02, 0.001, 0.0], 1.0, 0.0),
    (5, [0.02, 0.001, 0.0], 0.9, 0.004),
    (5, [0.0, 0.001, 0.0], 1.0, 0.002),
    (5, [0.0, 0.0, 0.0], 0.957, 0.0),
    (3, [0.01, 0.0005, 0.02], 1.0, 0.0),
];

fn main() {
    let pairs = arguments::count(100);
    println!("{pairs} pairs a line, seeds from 0, margin 5 %, level 99 %\n");
    println!(
        "| runs a side | scatter of gain, delay, natural frequency | second servo | different | undecided | same | interval holds | curves hold | shift holds | mean at most |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for (runs, [gain_sd, delay_sd_s, frequency_sd], second_gain, later_s) in CASES {
        let case = Means {
            runs,
            gain_sd,
            delay_sd_s,
            frequency_sd,
            second_gain,
            later_s,
        };
        let found = case.compare(pairs);
        println!(
            "| {runs} | {} %, {} ms, {} % | gain {} %, {} ms later | {} | {} | {} | {} of {pairs} | {} of {pairs} | {} of {} | {:.1} % |",
            100.0 * gain_sd,
            1e3 * delay_sd_s,
            100.0 * frequency_sd,
            1e-1 * (1e3 * (second_gain - 1.0)).round(),
            1e3 * later_s,
            found.different,
            found.undecided,
            found.same,
            found.held,
            found.curves_held,
            found.shift_held.0,
            found.shift_held.1,
            found.at_most_percent,
        );
    }
}
