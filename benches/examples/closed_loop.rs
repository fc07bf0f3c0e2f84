//! Prints the table "Closed loop" of docs/assumptions.md: whether recordings in closed loop have bounds, and whether these hold.
//!
//!     cargo run --release -p servoid-benches --example closed_loop -- 4

use servoid_identification::results::Reason;
use servoid_identification::{Options, identify};
use servoid_test_support::arguments;
use servoid_test_support::closed_loop::{Course, Loop};
use servoid_test_support::plants::{Noise, Plant, random};

/// Of the recordings of one line of the table, in numbers.
#[derive(Default)]
struct Counts {
    recordings: usize,
    withdrawn: usize,
    /// Of the withdrawn, those for this reason.
    as_closed_loop: usize,
    inside: usize,
    outside: usize,
}

fn main() {
    let runs: u64 = arguments::count(4);
    println!(
        "| controller | noise, times | recordings | withdrawn | as a closed loop | band holds the response | band misses it |"
    );
    println!("|---|---|---|---|---|---|---|");
    print_line("none", None, 1.0, 0, runs);
    for scale in [1.0, 3.0, 10.0] {
        for (name, delay) in [
            ("at once", 0),
            ("1 sample later", 1),
            ("5 samples later", 5),
        ] {
            print_line(name, Some(0.3), scale, delay, runs);
        }
    }
}

fn print_line(name: &str, controller: Option<f64>, scale: f64, delay: usize, runs: u64) {
    let mut counts = Counts::default();
    for course in [
        Course::Staircase,
        Course::Telegraph,
        Course::Prbs,
        Course::Multisine,
    ] {
        for noise in [Noise::White, Noise::Ar1, Noise::Ar2] {
            let line = Loop {
                course,
                controller,
                plant: Plant::A,
                noise,
                scale,
                delay,
            };
            (0..runs).for_each(|run| counts.add(&line, run));
        }
    }
    println!(
        "| {name} | {scale} | {} | {} | {} | {} | {} |",
        counts.recordings, counts.withdrawn, counts.as_closed_loop, counts.inside, counts.outside
    );
}

impl Counts {
    fn add(&mut self, line: &Loop, run: u64) {
        let options = Options {
            longest_settling: Some(301),
            ..Options::default()
        };
        let trial = line.trial(&mut random(1000 * run + 7));
        self.recordings += 1;
        let Ok(model) = identify(&trial.record, &options) else {
            self.withdrawn += 1;
            return;
        };
        let Some(bounds) = model.step.bounds.valid() else {
            self.withdrawn += 1;
            let reason = model.bounds.withdrawn();
            self.as_closed_loop += usize::from(reason == Some(Reason::InputFollowsOutput));
            return;
        };
        let whole = &bounds.simultaneous;
        let mut points = whole.lower.iter().zip(&whole.upper).zip(&trial.truth);
        match points.all(|((lower, upper), truth)| lower <= truth && truth <= upper) {
            true => self.inside += 1,
            false => self.outside += 1,
        }
    }
}
