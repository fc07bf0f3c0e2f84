//! The table of servos behind pulses in docs/method.md, "When the errors are not noise":
//!
//! ```sh
//! cargo run --release -p servoid-benches --example behind_pulses -- 40
//! ```
//!
//! The number is that of recordings for each line; seeds begin at 100.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use servoid::analysis::identified;
use servoid::data::dataset::{About, Controllers, Dataset};
use servoid_identification::{Options, Record};
use servoid_test_support::arguments;

/// A step of the simulation \[s\].
const STEP_S: f64 = 1e-4;

/// Steps from row to row.
const ROW: usize = 50;

/// What commands are: rows for which they are held, by number and chance, and levels.
#[derive(Clone, Copy)]
enum Commands {
    EqualHolds,
    RandomHolds,
    Square,
    Stairs,
}

/// What keeps the servo from being linear: shares of the longest stroke of 10, and of the speed that it has there.
#[derive(Clone, Copy, Default)]
struct Fault {
    /// The highest speed, of both ways or of one.
    speed: Option<f64>,
    one_way: bool,
    friction: f64,
    play: f64,
}

fn main() {
    let count = arguments::count(40) as u64;
    let limited = |speed: f64| Fault {
        speed: Some(speed),
        ..Fault::default()
    };
    let servos = [
        ("linear", Fault::default()),
        ("half of its speed", limited(0.5)),
        (
            "half of its speed one way",
            Fault {
                one_way: true,
                ..limited(0.5)
            },
        ),
        (
            "friction, 0.04 of a stroke",
            Fault {
                friction: 0.04,
                ..Fault::default()
            },
        ),
        (
            "play, 0.04 of a stroke",
            Fault {
                play: 0.04,
                ..Fault::default()
            },
        ),
    ];
    let commands = [
        ("levels, equal holds", Commands::EqualHolds),
        ("levels, random holds", Commands::RandomHolds),
        ("square wave, random holds", Commands::Square),
        ("stairs, random holds", Commands::Stairs),
    ];
    println!(
        "| servo | command | recordings | without waits | behind pulses, but for these | behind pulses |"
    );
    println!("|---|---|---|---|---|---|");
    for (servo, fault) in servos {
        for (name, command) in commands {
            let found: Vec<[bool; 3]> = (100..100 + count)
                .into_par_iter()
                .map(|seed| not_linear(seed, command, fault))
                .collect();
            let [sure, alone, asked] =
                [0, 1, 2].map(|i| found.iter().filter(|found| found[i]).count());
            println!("| {servo} | {name} | {count} | {sure} | {alone} | {asked} |");
        }
    }
}

/// Whether a servo is called not linear: without waits, behind pulses if these are not looked for, and as it is.
fn not_linear(seed: u64, command: Commands, fault: Fault) -> [bool; 3] {
    let found = |waits: bool, at_rows: bool| {
        let data = Dataset {
            record: record(seed, command, fault, waits),
            controllers: Controllers::default(),
            about: About {
                commands_at_rows: at_rows,
                ..About::default()
            },
        };
        let found = identified(&data, "simulated", &Options::default());
        !found.expect("it can be identified").model.linear
    };
    [found(false, false), found(true, false), found(true, true)]
}

/// 20 s of a servo of 25 to 70 rad/s under levels within 5, in rows of 5 ms and white noise of 0.2 to 2 % of that. Frames are of 14 to 25 ms.
fn record(seed: u64, command: Commands, fault: Fault, waits: bool) -> Record<'static> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let natural = random.random_range(25.0..70.0);
    let damping = random.random_range(0.6..1.2);
    let noise = 0.01 * random.random_range(1.0f64..10.0);
    let frame = random.random_range(140..250);
    let first = random.random_range(0..frame);
    let usual = (1.2 / natural / STEP_S * 6.0 / ROW as f64) as usize;
    let top = fault
        .speed
        .map_or(f64::INFINITY, |share| share * 4.0 * natural);
    let down = if fault.one_way { f64::INFINITY } else { top };
    let friction = 10.0 * fault.friction * natural * natural;
    let half = 5.0 * fault.play;
    let (mut input, mut output) = (Vec::new(), Vec::new());
    let (mut angle, mut speed, mut shaft, mut in_force) = (0.0f64, 0.0f64, 0.0f64, 0.0);
    let mut step = first;
    for hold in 0.. {
        let level = match command {
            Commands::EqualHolds | Commands::RandomHolds => random.random_range(-5.0..5.0),
            Commands::Square => [5.0, -5.0][hold % 2],
            Commands::Stairs => [-5.0, -2.5, 0.0, 2.5, 5.0, 2.5, 0.0, -2.5][hold % 8],
        };
        let rows = match command {
            Commands::EqualHolds => usual,
            _ => random.random_range(usual..2 * usual),
        };
        for _ in 0..rows {
            let normal: f64 = StandardNormal.sample(&mut random);
            input.push(level);
            output.push(shaft + noise * normal);
            for _ in 0..ROW {
                if !waits || step % frame == 0 {
                    in_force = level;
                }
                step += 1;
                let drive =
                    natural * natural * (in_force - angle) - 2.0 * damping * natural * speed;
                let free = speed + STEP_S * drive;
                // It sticks where friction would turn it round.
                speed = free - (STEP_S * friction).min(free.abs()).copysign(free);
                speed = speed.clamp(-down, top);
                angle += STEP_S * speed;
                shaft = shaft.clamp(angle - half, angle + half);
            }
        }
        if input.len() >= 4000 {
            break;
        }
    }
    Record::of_run(ROW as f64 * STEP_S, input, output).expect("it moves")
}
