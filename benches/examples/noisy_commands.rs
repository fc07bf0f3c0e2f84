//! The tables "Noise in the column of the command" of docs/assumptions.md:
//!
//! ```sh
//! cargo run --release -p servoid-benches --example noisy_commands -- 60 70000
//! ```
//!
//! The first number is that of recordings for each line; the second is the first seed. A third argument keeps the lines that contain it.

use servoid_identification::Options;
use servoid_test_support::arguments;
use servoid_test_support::coverage::measure_trials;
use servoid_test_support::noisy_commands::{Command, CommandNoise, NoisyCommand};
use servoid_test_support::plants::Plant;

fn main() {
    let runs = arguments::count(40);
    let mut further = std::env::args().skip(2);
    let first = further.next().and_then(|text| text.parse().ok());
    let first: u64 = first.unwrap_or(100);
    let filter = further.next().unwrap_or_default();
    println!(
        "| command | servo | noise | sent | s | said % | claimed % | points % | whole % | half width | exact |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    for (case, begin) in cases().iter().zip((first..).step_by(10_000)) {
        let label = label(case);
        if !label.contains(&filter) {
            continue;
        }
        let seed = |run: usize| begin + run as u64;
        let options = Options::default();
        let line = measure_trials(label.clone(), runs, &options, |run| case.trial(seed(run)));
        // The half width where the noise is stated to be sent.
        let exact = match case.is_sent {
            true => measure_trials(label, runs, &options, |run| case.exact_trial(seed(run)))
                .half_widths
                .1
                .to_string(),
            false => String::new(),
        };
        println!(
            "{} {:.0} | {:.0} | {:.2} | {:.1} | {:.4} | {exact:.6} |",
            line.label,
            100.0 * line.share_of("command_noise"),
            100.0 * line.claimed,
            100.0 * line.mean,
            100.0 * line.whole,
            line.half_widths.1
        );
    }
}

fn label(case: &NoisyCommand) -> String {
    let noise = match case.noise {
        CommandNoise::None => "none".to_owned(),
        CommandNoise::White(share) => format!("white {:.1} %", 100.0 * share),
        CommandNoise::Ar1(memory, share) => format!("AR(1) {memory} {:.1} %", 100.0 * share),
        CommandNoise::Steps(share) => format!("steps {:.1} %", 100.0 * share),
    };
    let sent = if case.is_sent { "yes" } else { "no" };
    let seconds = case.samples / 500;
    format!(
        "| {:?} | {:?} | {noise} | {sent} | {seconds} |",
        case.command, case.plant
    )
}

fn cases() -> Vec<NoisyCommand> {
    use CommandNoise::{Ar1, None, Steps, White};
    let held = [
        (Command::Levels, Plant::A),
        (Command::Telegraph, Plant::B),
        (Command::Square, Plant::C),
        (Command::Stairs, Plant::D),
    ];
    let smooth = [(Command::Multisine, Plant::A), (Command::Stick, Plant::B)];
    let measured = [
        White(0.003),
        White(0.01),
        White(0.03),
        White(0.1),
        Ar1(0.8, 0.01),
        Ar1(0.8, 0.03),
        Steps(0.001),
    ];
    let sent = [None, White(0.003), White(0.01), White(0.03), Ar1(0.8, 0.01)];
    let of = |noise: CommandNoise, is_sent: bool, samples: usize| {
        let case = move |(command, plant)| NoisyCommand {
            command,
            plant,
            noise,
            is_sent,
            samples,
        };
        let smooth = smooth.into_iter().filter(move |_| is_sent);
        held.into_iter().chain(smooth).map(case)
    };
    let lengths = [10_000, 60_000];
    let written = lengths
        .iter()
        .flat_map(|samples| measured.map(|noise| (noise, false, *samples)));
    let all = written.chain(sent.map(|noise| (noise, true, 10_000)));
    all.flat_map(|(noise, is_sent, samples)| of(noise, is_sent, samples))
        .collect()
}
