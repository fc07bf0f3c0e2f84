//! Prints how often what a model says of a linear servo is true where the reference is smooth or the
//! sensor rounds, as the table of the documentation.
//!
//! `cargo run --release -p servoid-benches --example figures_coverage -- [RUNS] [FILTER]`

use servoid_test_support::arguments;
use servoid_test_support::figures_coverage::{Case, Line, NAMES, Reference, Sensor, measure};
use servoid_test_support::servos::Linear;

fn main() {
    let runs = arguments::count(300);
    let mut arguments = std::env::args().skip(2);
    let filter = arguments.next().unwrap_or_default();
    println!(
        "| reference | servo | sensor | level |{} stated | half width | advice in every run |",
        NAMES.map(|name| format!(" {name} |")).concat()
    );
    println!(
        "|---|---|---|---|{}---|---|---|",
        "---|".repeat(NAMES.len())
    );
    for case in cases() {
        let name = format!(
            "| {:?} | {} | {:?} |",
            case.reference, case.servo.0, case.sensor
        );
        if name.contains(&filter) {
            println!("{name} {}", cells(&measure(&case, runs, 90_000)));
        }
    }
}

/// Shares in percent; of runs with a level there may be none.
fn cells(line: &Line) -> String {
    let percent = |share: f64| format!(" {:.0} |", 100.0 * share);
    let held = line.held.map(|share| match line.level {
        0.0 => " - |".to_owned(),
        _ => percent(share),
    });
    // Shares are sums of rounded parts.
    let always = line.advice.iter().filter(|(_, share)| **share > 0.999);
    let checks: Vec<&str> = always.map(|(check, _)| check.as_str()).collect();
    format!(
        "{:.0} |{}{} {:.4} | {} |",
        100.0 * line.level,
        held.concat(),
        percent(line.stated[0]),
        line.half_width,
        checks.join(", ")
    )
}

fn cases() -> Vec<Case> {
    let servos = [
        ("P", Linear::second_order(0.97, 0.0255, 0.5, 60.0)),
        ("B", Linear::second_order(1.0, 0.02, 0.7, 30.0)),
        ("C", Linear::second_order(1.0, 0.012, 6.0, 480.0)),
        (
            "D",
            Linear::second_order(1.0, 0.0, 0.6, 60.0).with_lag(0.05),
        ),
    ];
    let mut cases = Vec::new();
    let mut add = |references: &[Reference], sensors: &[Sensor]| {
        for reference in references {
            for &sensor in sensors {
                for servo in &servos {
                    cases.push(Case {
                        servo: servo.clone(),
                        reference: reference.clone(),
                        sensor,
                    });
                }
            }
        }
    };
    let smooth = [1, 2, 4].map(Reference::Smooth);
    let noises = [Sensor::Noisy(1.0), Sensor::White(0.05), Sensor::White(0.01)];
    add(&smooth[..2], &noises);
    add(&smooth[2..], &noises[..1]);
    let sines = [(3.0, 1.0), (2.0, 3.0), (1.0, 7.0)];
    let sines = [2, 3].map(|count| Reference::Sines(sines[..count].to_vec()));
    add(&sines, &[Sensor::Noisy(1.0)]);
    let sharp = [
        Reference::Staircase,
        Reference::RandomSteps,
        Reference::Stairs,
    ];
    add(&sharp, &[Sensor::Rounding]);
    add(&smooth[..1], &[Sensor::Rounding]);
    cases
}
