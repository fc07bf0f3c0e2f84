//! The table "Times that are not what they seem, and stops" of docs/assumptions.md:
//!
//! ```sh
//! cargo run --release -p servoid-benches --example loggers -- 40
//! ```
//!
//! The number is that of recordings for each line; seeds begin at 100.

use servoid_identification::results::Reason;
use servoid_identification::{Options, identify};
use servoid_test_support::loggers::Logger;

fn main() {
    let argument = std::env::args().nth(1);
    let count: u64 = argument.and_then(|text| text.parse().ok()).unwrap_or(40);
    let sound = Logger::default();
    let five = Logger { levels: 5, ..sound };
    let limited = Logger { top: 60.0, ..sound };
    let lines = [
        ("none", sound),
        ("none; speed limited to 60 a second", limited),
        (
            "clocks differ by 0.01 %",
            Logger {
                drift: 1e-4,
                ..sound
            },
        ),
        (
            "clocks differ by 0.02 %",
            Logger {
                drift: 2e-4,
                ..sound
            },
        ),
        (
            "clocks differ by 0.1 %",
            Logger {
                drift: 1e-3,
                ..sound
            },
        ),
        (
            "clocks differ by 0.1 %; speed limited",
            Logger {
                drift: 1e-3,
                ..limited
            },
        ),
        (
            "stiffness falls by 10 %",
            Logger {
                weaker: 0.1,
                ..sound
            },
        ),
        (
            "stiffness falls by 30 %",
            Logger {
                weaker: 0.3,
                ..sound
            },
        ),
        (
            "sensor read every 2nd sample",
            Logger {
                refresh: 2,
                ..sound
            },
        ),
        (
            "sensor read every 10th sample",
            Logger {
                refresh: 10,
                ..sound
            },
        ),
        (
            "command 6 ms late (delay 12 ms)",
            Logger { late: 3, ..sound },
        ),
        ("command 20 ms late", Logger { late: 10, ..sound }),
        (
            "command 20 ms late; speed limited",
            Logger {
                late: 10,
                ..limited
            },
        ),
        ("command 40 ms late", Logger { late: 20, ..sound }),
        ("stop at 9.5 of 10", Logger { stop: 9.5, ..sound }),
        ("stop at 9 of 10", Logger { stop: 9.0, ..sound }),
        ("stop at 7 of 10", Logger { stop: 7.0, ..sound }),
        ("none; five levels", five),
        (
            "stop at 9.8 of 10; five levels",
            Logger { stop: 9.8, ..five },
        ),
        (
            "stop at 9.5 of 10; five levels",
            Logger { stop: 9.5, ..five },
        ),
        (
            "stop at 9 of 10; six levels",
            Logger {
                stop: 9.0,
                levels: 6,
                ..sound
            },
        ),
    ];
    println!(
        "| fault | lag drifts | output held | moves early | runs into a stop | other reason | bounds |"
    );
    println!("|---|---|---|---|---|---|---|");
    for (name, logger) in lines {
        let mut found = [0; 6];
        for seed in 100..100 + count {
            let model = identify(&logger.record(seed), &Options::default());
            let model = model.expect("it can be identified");
            let column = match model.bounds.withdrawn() {
                Some(Reason::LagDrift) => 0,
                Some(Reason::HeldOutput) => 1,
                Some(Reason::EarlyMotion) => 2,
                Some(Reason::TravelEnd | Reason::TravelEndOpen) => 3,
                Some(_) => 4,
                None => 5,
            };
            found[column] += 1;
        }
        let cells: Vec<String> = found.iter().map(u32::to_string).collect();
        println!("| {name} | {} |", cells.join(" | "));
    }
}
