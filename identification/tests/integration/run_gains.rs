//! Runs of one servo whose gains differ a little bend the response that they have in common, and so does the first stroke of each, from neutral, of a servo
//! that rests elsewhere after it. That is no slow end.

use rand::RngExt;
use rand_distr::StandardNormal;
use servoid_identification::results::FrequencyResponse;
use servoid_identification::{Options, Record, Run, identify};
use servoid_test_support::loggers::Logger;
use servoid_test_support::plants::random;

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

/// Three runs of 12 s whose gains scatter by 0.8 %, under levels that change every 20 ms at most, as pulses do.
fn under_pulses(seed: u64) -> Record<'static> {
    let mut random = random(seed);
    let mut normal = move || random.sample::<f64, _>(StandardNormal);
    let runs = (0..3).map(|_| {
        let (gain, offset) = (1.0 + 0.008 * normal(), 0.1 * normal());
        let mut input = vec![0.0; 500];
        while input.len() < 6000 {
            let hold = 10 * (18.0 + 6.0 * normal()).clamp(6.0, 30.0) as usize;
            input.extend(vec![5.0 * normal(); hold]);
        }
        input.truncate(6000);
        let (mut angle, mut speed) = (0.0, 0.0);
        let late = std::iter::repeat_n(0.0, 7).chain(input.iter().copied());
        let move_on = |u: f64| {
            for _ in 0..10 {
                speed += 2e-4 * (1600.0 * (u - angle) - 64.0 * speed);
                angle += 2e-4 * speed;
            }
            gain * angle + offset + 0.05 * normal()
        };
        let output: Vec<f64> = late.take(6000).map(move_on).collect();
        Run::new(input, output).unwrap()
    });
    Record::new(0.002, runs.collect()).unwrap()
}

#[test]
fn runs_whose_gains_differ_determine_their_response_all_the_same() {
    // In the common fit, commands to come explained the outputs of these, as where they do not separate the lags.
    for seed in [250, 488] {
        let found = identify(&under_pulses(seed), &Options::default()).unwrap();
        assert_eq!(found.bounds.withdrawn(), None, "{seed}");
    }
}

/// With the normal quantile in the place of Student's of two degrees of freedom, the servo's own response had a quarter of the width.
#[test]
fn the_servos_own_response_counts_few_runs_as_that_of_its_samples_does() {
    let found = identify(&under_pulses(250), &Options::default()).unwrap();
    let of_samples = found.frequency.clone().freed_of_hold(found.timing());
    let at: Vec<f64> = of_samples
        .omega_rad_s
        .iter()
        .map(|omega| 1.0001 * omega)
        .collect();
    let own = found.servo_response(&at).unwrap();
    let widths = |response: &FrequencyResponse| -> Vec<f64> {
        let bounds = response.bounds.valid().unwrap();
        let pairs = bounds
            .magnitude_db_lower
            .iter()
            .zip(&bounds.magnitude_db_upper);
        pairs.map(|(lower, upper)| upper - lower).collect()
    };
    for ((omega, own), of_samples) in at.iter().zip(widths(&own)).zip(widths(&of_samples)) {
        // Up to the bandwidth, above which noise and folding are most of it. Between two frequencies the larger widening counts.
        if *omega < 30.0 {
            assert!(
                (0.99..1.3).contains(&(own / of_samples)),
                "{omega}: {own} {of_samples}"
            );
        }
    }
}

/// Four runs of 12 s, at rest in the middle before strokes of 16. After the first one, of 8, the servo rests 0.22 short, as in a dead band; a `slow` part of the
/// response has a time constant of 0.4 s.
fn from_neutral(seed: u64, slow: f64) -> Record<'static> {
    let mut random = random(seed);
    let runs = (0..4).map(|_| {
        let (mut level, mut input) = (8.0, vec![0.0; 250]);
        while input.len() < 6000 {
            input.extend(vec![level; random.random_range(150..300)]);
            level = -level;
        }
        input.truncate(6000);
        let first = input.iter().rposition(|u| *u == 0.0).unwrap();
        let first = first..first + input[first + 1..].iter().position(|u| *u < 0.0).unwrap();
        let (mut stages, mut creep) = ([0.0; 2], 0.0);
        let output = input.iter().enumerate().map(|(k, u)| {
            let edge = if first.contains(&k) { 0.22 } else { 0.0 };
            stages[0] += 0.1 * (u - edge - stages[0]);
            stages[1] += 0.1 * (stages[0] - stages[1]);
            creep += (u - creep) / 200.0;
            stages[1] + slow * creep + 0.07 * random.sample::<f64, _>(StandardNormal)
        });
        let output: Vec<f64> = output.collect();
        Run::new(input, output).unwrap()
    });
    Record::new(0.002, runs.collect()).unwrap()
}

#[test]
fn a_first_stroke_that_rests_elsewhere_is_no_slow_end() {
    for seed in [1, 2, 3] {
        let found = identify(&from_neutral(seed, 0.0), &Options::default()).unwrap();
        assert_eq!(found.bounds.withdrawn(), None, "{seed}");
        assert!(found.structure.settling_samples < 250, "{seed}");
    }
    let creeping = identify(&from_neutral(4, 0.05), &Options::default()).unwrap();
    assert!(creeping.structure.settling_samples > 500);
}
