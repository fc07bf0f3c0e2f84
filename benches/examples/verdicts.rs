//! Prints how often the detectors and the comparison speak up, on servos that have nothing to show and on
//! servos that do.
//!
//! `cargo run --release -p servoid-benches --example verdicts -- RUNS`

use rayon::prelude::*;
use servoid_identification::comparison::{ComparisonOptions, Verdict, compare};
use servoid_identification::nonlinear::{Limits, RateVerdict, split_by_direction};
use servoid_identification::results::Model;
use servoid_identification::{Options, Record, identify};
use servoid_test_support::arguments;
use servoid_test_support::servos::{
    Limit, Linear, PERIOD, exact_shift, limited, measured, sizes, staircase, stairs,
};

/// A servo as a function of its input and where it starts.
type Servo = dyn Fn(&[f64], f64) -> Vec<f64> + Sync;

fn identified(input: &[f64], clean: &[f64], seed: u64) -> (Record<'static>, Model) {
    let record =
        Record::of_run(PERIOD, input.to_vec(), measured(clean, 1.0, seed)).expect("simulated");
    let model = identify(&record, &Options::default()).expect("well excited");
    (record, model)
}

/// Share of `runs` seeds in which `found`, in percent.
fn share(runs: u64, found: impl Fn(u64) -> bool + Sync) -> f64 {
    let count = (0..runs)
        .into_par_iter()
        .filter(|seed| found(*seed))
        .count();
    100.0 * count as f64 / runs as f64
}

fn limits(input: &[f64], clean: &[f64], seed: u64) -> Limits {
    let (record, model) = identified(input, clean, seed);
    Limits::of(&record, &model, Options::default().level)
}

fn detectors(runs: u64) {
    let linear = |zeta: f64, omega: f64| Linear::second_order(0.97, 0.0255, zeta, omega);
    let exact = |servo: Linear| move |input: &[f64], rest: f64| servo.respond(input, rest, 0.0);
    let with = |zeta: f64, limit: Limit| {
        move |input: &[f64], rest: f64| limited(zeta, 60.0, limit, input, rest)
    };
    let servos: Vec<(&str, Box<Servo>)> = vec![
        ("linear 0.5/60", Box::new(exact(linear(0.5, 60.0)))),
        ("linear 0.9/40", Box::new(exact(linear(0.9, 40.0)))),
        ("linear 0.3/80", Box::new(exact(linear(0.3, 80.0)))),
        (
            "linear 0.6/70 + lag 8 ms",
            Box::new(exact(linear(0.6, 70.0).with_lag(0.008))),
        ),
        ("rate 200", Box::new(with(0.5, Limit::Rate(200.0, 200.0)))),
        ("rate 100", Box::new(with(0.5, Limit::Rate(100.0, 100.0)))),
        ("play 0.1, 0.9/60", Box::new(with(0.9, Limit::Play(0.1)))),
        ("play 0.3, 0.5/60", Box::new(with(0.5, Limit::Play(0.3)))),
        (
            "stops -4.5 and 5",
            Box::new(with(0.5, Limit::Clip(-4.5, 5.0))),
        ),
    ];
    println!(
        "\n| servo | asymmetric | rate limited | grows less | hysteresis | low end | high end | not determined |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let levels: Vec<f64> = (-3..=3).map(|k| 2.0 * f64::from(k)).collect();
    for (name, servo) in &servos {
        row(name, servo.as_ref(), &levels, runs);
    }
}

fn row(name: &str, servo: &Servo, levels: &[f64], runs: u64) {
    let paper = staircase();
    let paper_output = servo(&paper, -5.0);
    let asymmetric = share(runs, |seed| {
        let (record, model) = identified(&paper, &paper_output, seed);
        split_by_direction(&record, &model)
            .expect("both directions")
            .asymmetric()
    });
    let strokes = sizes(1.0, 150);
    let stroke_output = servo(&strokes, 0.0);
    let rates: Vec<RateVerdict> = (0..runs)
        .into_par_iter()
        .flat_map_iter(|seed| {
            let found = limits(&strokes, &stroke_output, seed);
            [found.rate_up.verdict, found.rate_down.verdict]
        })
        .collect();
    let of = |verdict: RateVerdict| {
        100.0 * rates.iter().filter(|found| **found == verdict).count() as f64 / rates.len() as f64
    };
    let stairs = stairs(levels, 3, 150);
    let stairs_output = servo(&stairs, -6.0);
    let found: Vec<Limits> = (0..runs)
        .into_par_iter()
        .map(|seed| limits(&stairs, &stairs_output, seed))
        .collect();
    let percent = |test: &dyn Fn(&Limits) -> bool| {
        100.0 * found.iter().filter(|limits| test(limits)).count() as f64 / runs as f64
    };
    let end = |k: usize| {
        percent(&|limits| {
            limits
                .ends
                .as_ref()
                .is_some_and(|ends| ends[k].softens == Some(true))
        })
    };
    println!(
        "| {name} | {asymmetric:.1} | {:.1} | {:.1} | {:.1} | {:.1} | {:.1} | {:.1} |",
        of(RateVerdict::Limited),
        of(RateVerdict::GrowsLess),
        percent(&|limits| limits.hysteresis.found == Some(true)),
        end(0),
        end(1),
        percent(&|limits| limits.hysteresis.found.is_none()),
    );
}

fn comparisons(pairs: u64) {
    println!(
        "| b against 0.97, 25.5 ms, 0.5/60 | different | undecided | same | at least | at most | true shift, ms | half width, ms | covered |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let bench = Linear::second_order(0.97, 0.0255, 0.5, 60.0);
    let others = [
        ("same", bench.clone()),
        ("gain -2 %", Linear::second_order(0.9506, 0.0255, 0.5, 60.0)),
        ("gain -10 %", Linear::second_order(0.873, 0.0255, 0.5, 60.0)),
        ("delay +2 ms", Linear::second_order(0.97, 0.0275, 0.5, 60.0)),
        ("speed -10 %", Linear::second_order(0.97, 0.0255, 0.5, 54.0)),
        (
            "slower, damped",
            Linear::second_order(0.9, 0.0262, 0.7, 45.0),
        ),
    ];
    let input = staircase();
    let clean = bench.respond(&input, -5.0, 0.0);
    for (name, other) in others {
        let changed = other.respond(&input, -5.0, 0.0);
        let found: Vec<_> = (0..pairs)
            .into_par_iter()
            .map(|seed| {
                let record = |clean: &[f64], seed| {
                    Record::of_run(PERIOD, &input, measured(clean, 1.0, seed)).expect("simulated")
                };
                let (a, b) = (record(&clean, 2 * seed), record(&changed, 2 * seed + 1));
                compare(&a, &b, &ComparisonOptions::default()).expect("well excited")
            })
            .collect();
        let count = |verdict| {
            100.0 * found.iter().filter(|c| c.verdict == verdict).count() as f64 / pairs as f64
        };
        let mean = |of: fn(&servoid_identification::comparison::DifferencePercent) -> f64| {
            let bounds = found.iter().filter_map(|c| c.bounds.valid());
            bounds.map(|b| of(&b.difference_percent)).sum::<f64>() / pairs as f64
        };
        let exact = exact_shift(&bench, &other);
        let bounds: Vec<[f64; 2]> = found
            .iter()
            .filter_map(|c| c.bounds.valid()?.delay_shift_s)
            .collect();
        let held = bounds
            .iter()
            .filter(|[low, high]| *low <= exact && exact <= *high);
        let width: f64 = bounds.iter().map(|[low, high]| high - low).sum();
        println!(
            "| {name} | {:.0} | {:.0} | {:.0} | {:.1} | {:.1} | {:.2} | {:.3} | {:.1} |",
            count(Verdict::Different),
            count(Verdict::Undecided),
            count(Verdict::Same),
            mean(|d| d.at_least),
            mean(|d| d.at_most),
            1e3 * exact,
            1e3 * width / 2.0 / pairs as f64,
            100.0 * held.count() as f64 / pairs as f64
        );
    }
}

fn main() {
    let runs = arguments::count(100);
    println!("Shares in % of {runs} seeds\n");
    comparisons(runs);
    detectors(runs);
}
