//! Measures by simulation how often the bands hold what they should, and prints the table of the
//! documentation as markdown.
//!
//! `cargo run --release -p servoid-benches --example coverage -- [RUNS] [FILTER] [auto|narrow] [stable]`
//! with 300 runs a case by default; FILTER keeps the lines that contain it, such as `Staircase | A` or `Glitches`;
//! `narrow` takes the narrow number of frequencies, `stable` the stable prior. The last sentence is the overall rate of false alarms of the
//! lines shown.

use servoid_identification::{Frequencies, Options, Prior};
use servoid_test_support::arguments;
use servoid_test_support::coverage::{Case, Line, Reference, measure};
use servoid_test_support::hard_lines::{hard_lines, repeating_lines};
use servoid_test_support::plants::{Noise, Plant};

fn main() {
    let runs = arguments::count(300);
    let mut arguments = std::env::args().skip(2);
    let filter = arguments.next().unwrap_or_default();
    let options = Options {
        frequencies: arguments.next().map_or(Frequencies::Auto, |word| {
            word.parse().expect("auto, narrow or an odd number")
        }),
        prior: arguments
            .next()
            .map_or(Prior::None, |word| word.parse().expect("none or stable")),
        ..Options::default()
    };
    println!("{}", Line::HEADING);
    let (mut lines, mut withdrawn, mut alarmed) = (0.0, 0.0, 0.0);
    for (label, measure) in all_lines(&options) {
        if !label.contains(&filter) {
            continue;
        }
        let line = measure(runs);
        println!("{line}");
        lines += 1.0;
        withdrawn += line.withdrawn;
        alarmed += line.alarmed;
    }
    println!(
        "\nOf all {} records, errors were not taken for noise in {:.2} %; there was any false alarm in {:.2} %.",
        lines * runs as f64,
        100.0 * withdrawn / lines,
        100.0 * alarmed / lines
    );
}

type Measure<'a> = Box<dyn Fn(usize) -> Line + 'a>;

/// The first columns of every line, and what measures it.
fn all_lines(options: &Options) -> Vec<(String, Measure<'_>)> {
    let even = cases().into_iter().map(|case| {
        let measure: Measure<'_> = Box::new(move |runs| Line {
            oracle: case.oracle(),
            ..measure(case, runs, options)
        });
        (case.label(), measure)
    });
    let hard = hard_lines()
        .into_iter()
        .chain(repeating_lines())
        .map(|line| {
            let measure: Measure<'_> = Box::new(move |runs| Line {
                oracle: line.oracle(),
                ..line.measure(runs, options)
            });
            (line.label(), measure)
        });
    even.chain(hard).collect()
}

fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for scale in [1.0, 5.0] {
        for reference in [
            Reference::Staircase,
            Reference::Prbs,
            Reference::LowPassed,
            Reference::Square,
        ] {
            for plant in [Plant::A, Plant::B, Plant::C, Plant::D, Plant::E] {
                for noise in [Noise::White, Noise::Ar1, Noise::Ar2] {
                    cases.push(Case {
                        reference,
                        plant,
                        noise,
                        scale,
                    });
                }
            }
        }
    }
    cases
}
