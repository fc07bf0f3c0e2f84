//! Measures how often bounds of a servo's mean hold where its dynamics change from run to run:
//!
//! ```sh
//! cargo run --release -p servoid-benches --example changing_servos -- 100
//! ```
//!
//! The number is that of recordings for each line. Those of the first line have the seeds 0, 1, ..., of the second 1 000 000, ...

use servoid_test_support::arguments;
use servoid_test_support::changing_servos::{Changes, ChangingServo, Kind};
use servoid_test_support::metrics_coverage::NAMES;
use servoid_test_support::plants::Noise;

/// No changes come first.
fn lines() -> Vec<ChangingServo> {
    let line = |kind, runs, changes| ChangingServo {
        kind,
        runs,
        changes,
        noise: Noise::White,
        scale: 1.0,
    };
    let frequency = |frequency| Changes {
        frequency,
        ..Changes::default()
    };
    let damping = |damping| Changes {
        damping,
        ..Changes::default()
    };
    let all = Changes {
        gain: 0.01,
        delay_ms: 1.0,
        frequency: 0.03,
        damping: 0.05,
    };
    let gain_and_delay = Changes {
        gain: 0.01,
        delay_ms: 1.0,
        ..Changes::default()
    };
    let base = Kind::Second(50.0, 0.7);
    let slow_noise = |runs| ChangingServo {
        noise: Noise::Ar1,
        scale: 5.0,
        ..line(base, runs, Changes::default())
    };
    let mut lines: Vec<ChangingServo> = Vec::new();
    lines.extend([3, 4, 5, 10].map(|runs| line(base, runs, Changes::default())));
    lines.extend([3, 4, 5, 10].map(slow_noise));
    lines.extend([
        line(base, 5, frequency(0.05)),
        line(base, 5, frequency(0.02)),
        line(base, 3, frequency(0.03)),
        line(Kind::Second(50.0, 0.6), 5, damping(0.1)),
        line(Kind::Second(50.0, 0.6), 10, damping(0.05)),
        line(Kind::Second(60.0, 0.4), 3, frequency(0.08)),
        line(Kind::Second(60.0, 0.4), 10, frequency(0.01)),
        line(Kind::Second(60.0, 0.4), 5, damping(0.04)),
        line(Kind::First(0.03), 3, frequency(0.03)),
        line(Kind::First(0.03), 5, frequency(0.08)),
        line(Kind::First(0.03), 10, frequency(0.03)),
        line(Kind::Lagged(60.0, 0.6, 0.05), 5, damping(0.1)),
        line(Kind::Lagged(60.0, 0.6, 0.05), 10, frequency(0.05)),
        line(Kind::Second(50.0, 0.6), 3, all),
        line(Kind::Second(50.0, 0.6), 5, all),
        line(Kind::Second(50.0, 0.6), 10, all),
        line(Kind::Second(50.0, 0.6), 5, gain_and_delay),
        ChangingServo {
            noise: Noise::Ar1,
            scale: 3.0,
            ..line(base, 5, frequency(0.04))
        },
        line(Kind::LimitedDrive, 4, frequency(0.01)),
        line(Kind::LimitedDrive, 5, frequency(0.03)),
        line(Kind::LimitedDrive, 10, frequency(0.02)),
    ]);
    lines
}

fn main() {
    let records = arguments::count(100) as u64;
    println!(
        "| servo | noise | runs | scatter | claimed % | mean % | whole % | half width, point / whole | magnitude % | phase % | {} % |",
        NAMES.join(" % | ")
    );
    println!(
        "|---|---|---|---|---|---|---|---|---|---|{}",
        "---|".repeat(NAMES.len())
    );
    for (line, seed) in lines().iter().zip((0..).step_by(1_000_000)) {
        let found = line.measure(records, seed);
        let percent = |share: f64| format!("{:.1}", 100.0 * share);
        println!(
            "{line} {} | {:.2} | {} | {:.4} / {:.4} | {} | {} | {} |",
            percent(found.claimed),
            100.0 * found.mean,
            percent(found.whole),
            found.half_widths.0,
            found.half_widths.1,
            percent(found.magnitude),
            percent(found.phase),
            found.figures.map(percent).join(" | "),
        );
    }
}
