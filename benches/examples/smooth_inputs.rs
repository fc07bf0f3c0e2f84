//! The table "Inputs that excite a band" of docs/method.md:
//!
//! ```sh
//! cargo run --release -p servoid-benches --example smooth_inputs -- 50
//! ```
//!
//! The number is that of recordings for each line; seeds begin at 0. A second argument is another first seed.

use servoid_test_support::arguments;
use servoid_test_support::smooth_inputs::smooth_inputs;

fn main() {
    let runs = arguments::count(50);
    let first = std::env::args().nth(2).and_then(|text| text.parse().ok());
    let first = first.unwrap_or(0);
    println!(
        "| input, servo, noise (deg), rows | bounds | band (Hz) | magnitude: mean, worst | phase: mean, worst | median half width (dB) | -90 degrees held | order rejected | gain held | delay, ω and ζ, or T held | half width of the gain (%) |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    for line in smooth_inputs() {
        let found = line.measure(runs, first);
        let claimed = format!("{} of {}", found.claimed, found.runs);
        if found.claimed == 0 {
            println!("| {} | {claimed} | | | | | | | | | |", line.label);
            continue;
        }
        let percent =
            |[mean, worst]: [f64; 2]| format!("{:.1}, {:.0}", 100.0 * mean, 100.0 * worst);
        let [low, high] = found.band_hz;
        let low_order = &found.low_order;
        let [gain, others @ ..] = low_order.held.map(|tally| tally.to_string());
        let others: Vec<String> = others.into_iter().filter(|text| !text.is_empty()).collect();
        let half = low_order.half_gain_percent();
        let half = half.map_or(String::new(), |half| format!("{half:.3}"));
        println!(
            "| {} | {claimed} | {low:.2}-{high:.1} | {} | {} | {:.3} | {} of {} | {} of {} | {gain} | {} | {half} |",
            line.label,
            percent(found.magnitude),
            percent(found.phase),
            found.half_width_db,
            found.minus_90_held,
            found.minus_90,
            low_order.rejected,
            low_order.fitted,
            others.join(", ")
        );
    }
}
