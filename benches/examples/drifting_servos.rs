//! The table "Gains that change, and slow servos" of docs/assumptions.md:
//!
//! ```sh
//! cargo run --release -p servoid-benches --example drifting_servos -- 12
//! ```
//!
//! The number is that of recordings for each line. Those of the first line have the seeds 0, 1, ..., of the second 1 000 000, ...

use rayon::prelude::*;
use servoid_identification::results::{Check, Reason};
use servoid_identification::{Options, identify};
use servoid_test_support::arguments;
use servoid_test_support::drifting_servos::{Beside, Command, Course, DriftingServo, Motion};
use servoid_test_support::plants::Noise;

/// Commands, noises with their factors, and numbers of runs with their lengths \[s\]; the recordings of a line go through all of these.
const COMMANDS: [Command; 4] = [
    Command::Levels(1.0),
    Command::Staircase,
    Command::Telegraph,
    Command::Prbs,
];
const NOISES: [(Noise, f64); 3] = [(Noise::White, 1.0), (Noise::Ar1, 1.0), (Noise::Ar2, 2.0)];
const RUNS: [(usize, f64); 4] = [(1, 20.0), (3, 20.0), (1, 60.0), (1, 120.0)];

/// What is found in a recording.
#[derive(PartialEq)]
enum Found {
    GainDrift,
    Slow,
    OtherReason,
    Bounds,
    Refused,
}

fn found(servo: &DriftingServo, seed: u64) -> Found {
    let Ok(model) = identify(&servo.record(seed), &Options::default()) else {
        return Found::Refused;
    };
    let is_slow = |check: &Check| *check == Check::SlowServo;
    match model.bounds.withdrawn() {
        _ if model.advice.iter().any(|advice| is_slow(&advice.check)) => Found::Slow,
        Some(Reason::GainDrift) => Found::GainDrift,
        Some(_) => Found::OtherReason,
        None => Found::Bounds,
    }
}

fn main() {
    let count = arguments::count(12);
    println!("| servo | gain changes | slow | other reason | bounds | refused |");
    println!("|---|---|---|---|---|---|");
    for ((name, servo), seed) in lines().iter().zip((0..).step_by(1_000_000)) {
        let each = (0..count).into_par_iter().map(|k| {
            let (noise, scale) = NOISES[k / COMMANDS.len() % NOISES.len()];
            let (runs, seconds) = RUNS[(k + k / COMMANDS.len()) % RUNS.len()];
            let servo = DriftingServo {
                command: COMMANDS[k % COMMANDS.len()],
                noise,
                scale,
                runs,
                seconds,
                ..*servo
            };
            found(&servo, seed + k as u64)
        });
        let all: Vec<Found> = each.collect();
        let of = |what: Found| all.iter().filter(|one| **one == what).count();
        println!(
            "| {name} | {} | {} | {} | {} | {} |",
            of(Found::GainDrift),
            of(Found::Slow),
            of(Found::OtherReason),
            of(Found::Bounds),
            of(Found::Refused)
        );
    }
}

fn lines() -> Vec<(String, DriftingServo)> {
    let servo = DriftingServo::default();
    let mut lines = vec![("linear".to_owned(), servo)];
    for percent in [1.0, 2.0, 3.0, 4.0, 8.0] {
        for (course, words) in [
            (Course::Evenly, "evenly"),
            (Course::AtOnce(0.6), "at 60 % of a run"),
        ] {
            let changing = DriftingServo {
                change: -0.01 * percent,
                course,
                ..servo
            };
            lines.push((format!("gain falls by {percent} % {words}"), changing));
        }
    }
    lines.extend(
        besides().map(|(name, beside)| (name.to_owned(), DriftingServo { beside, ..servo })),
    );
    for seconds in [0.1, 0.3, 0.5, 1.0, 2.0, 4.0, 10.0] {
        let motion = Motion::Lag(seconds);
        lines.push((
            format!("lag of {seconds} s"),
            DriftingServo { motion, ..servo },
        ));
    }
    for rate in [0.1, 1.0] {
        let motion = Motion::Integral(rate);
        lines.push((
            format!("integral of the command, {rate} a second for 1"),
            DriftingServo { motion, ..servo },
        ));
    }
    lines
}

/// Servos whose gain does not change, and that are not slow.
fn besides() -> impl Iterator<Item = (&'static str, Beside)> {
    [
        ("3 % of the response in 1.5 s", Beside::SlowEnd(0.03)),
        ("10 % of the response in 1.5 s", Beside::SlowEnd(0.1)),
        ("gains of the runs scatter by 3 %", Beside::RunGains(0.03)),
        ("offsets of the runs scatter by 1", Beside::RunOffsets(1.0)),
        ("output drifts by 2", Beside::Drift(2.0)),
        ("glitches in 0.3 % of the rows", Beside::Glitches(0.003)),
        (
            "noise 10 times as loud in the last eighth",
            Beside::LateNoise(10.0),
        ),
        (
            "noise 40 times as loud in the last eighth",
            Beside::LateNoise(40.0),
        ),
        (
            "noise that grows with the speed",
            Beside::NoiseOfMotion(0.1),
        ),
        ("times of the rows scatter by 1 ms", Beside::Jitter(0.001)),
        (
            "levels are off by 0.3, alike at each visit",
            Beside::LevelErrors(0.3),
        ),
        ("gain grows by 5 % over the output", Beside::Bend(0.05)),
        ("gain grows by 30 % over the output", Beside::Bend(0.3)),
        ("speed limited to 100 a second", Beside::TopSpeed(100.0)),
        ("speed limited to 50 a second", Beside::TopSpeed(50.0)),
        ("speed limited to 20 a second", Beside::TopSpeed(20.0)),
        ("play of 0.3", Beside::Play(0.3)),
        ("play of 1", Beside::Play(1.0)),
        ("dead band of 0.1", Beside::DeadBand(0.1)),
        ("dead band of 0.4", Beside::DeadBand(0.4)),
        ("stop at 8 of 10", Beside::Stop(8.0)),
        ("closed loop", Beside::Loop(1.0)),
    ]
    .into_iter()
}
