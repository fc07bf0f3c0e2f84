//! Runs of one servo whose gains differ a little bend the response that they have in common. That is no slow end.

use servoid_identification::{Options, Record, Run, identify};
use servoid_test_support::loggers::Logger;

/// Three runs with gains that scatter by 0.4 %, from this seed on; a `slow` part of the response has a time constant of 0.4 s.
fn record(seed: u64, slow: f64) -> Record<'static> {
    let gains = [1.0, 0.9935, 1.0015];
    let runs = gains.iter().zip(seed..).map(|(gain, seed)| {
        let alone = Logger::default().record(seed);
        let run = &alone.runs()[0];
        let mut creep = 0.0;
        let both = run.input().iter().zip(run.output());
        let output = both.map(|(u, y)| {
            creep += (u - creep) / 200.0;
            gain * (y + slow * creep)
        });
        let output: Vec<f64> = output.collect();
        Run::new(run.input().to_vec(), output).unwrap()
    });
    Record::new(0.002, runs.collect()).unwrap()
}

#[test]
fn bounds_of_runs_whose_gains_differ_stay_and_a_slow_end_is_seen() {
    // By the common response alone, these had a slow end.
    for seed in [30, 60, 90] {
        let found = identify(&record(seed, 0.0), &Options::default()).unwrap();
        assert_eq!(found.bounds.withdrawn(), None, "{seed}");
        assert!(found.structure.settling_samples < 400, "{seed}");
    }
    let creeping = identify(&record(10, 0.1), &Options::default()).unwrap();
    assert_eq!(creeping.structure.settling_samples, 599);
}
