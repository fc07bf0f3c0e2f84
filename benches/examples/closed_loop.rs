//! Prints the table "Closed loop" of docs/method.md: whether recordings in closed loop have bounds, and whether these hold.
//!
//!     cargo run --release -p servoid-benches --example closed_loop -- 20

use servoid_identification::results::Reason;
use servoid_identification::{Options, identify};
use servoid_test_support::arguments;
use servoid_test_support::closed_loop::{Course, Loop};
use servoid_test_support::plants::{Noise, Plant, random};

const COURSES: [Course; 4] = [
    Course::Staircase,
    Course::Telegraph,
    Course::Prbs,
    Course::Multisine,
];

fn main() {
    let runs: u64 = arguments::count(20);
    println!("| reference | noise | controller | runs | withdrawn | as a closed loop | band holds the response | band misses it |");
    println!("|---|---|---|---|---|---|---|---|");
    for course in COURSES {
        for noise in [Noise::White, Noise::Ar1, Noise::Ar2] {
            let open = (None, 1.0, 0);
            let closed = [1.0, 3.0, 10.0].into_iter().flat_map(|scale| [0, 1, 5].map(|delay| (Some(0.3), scale, delay)));
            for (controller, scale, delay) in std::iter::once(open).chain(closed) {
                let line = Loop {
                    course,
                    controller,
                    plant: Plant::A,
                    noise,
                    scale,
                    delay,
                };
                println!("{} | {}", line.label(), counts(&line, runs));
            }
        }
    }
}

/// Withdrawn, withdrawn for this reason, held and missed, in numbers of runs.
fn counts(line: &Loop, runs: u64) -> String {
    let options = Options {
        longest_settling: Some(301),
        ..Options::default()
    };
    let (mut withdrawn, mut named, mut inside, mut outside) = (0, 0, 0, 0);
    for run in 0..runs {
        let trial = line.trial(&mut random(1000 * run + 7));
        let Ok(model) = identify(&trial.record, &options) else {
            withdrawn += 1;
            continue;
        };
        let Some(bounds) = model.step.bounds.valid() else {
            withdrawn += 1;
            named += usize::from(model.bounds.withdrawn() == Some(Reason::InputFollowsOutput));
            continue;
        };
        let whole = &bounds.simultaneous;
        let mut points = whole.lower.iter().zip(&whole.upper).zip(&trial.truth);
        match points.all(|((lower, upper), truth)| lower <= truth && truth <= upper) {
            true => inside += 1,
            false => outside += 1,
        }
    }
    format!("{runs} | {withdrawn} | {named} | {inside} | {outside} |")
}
