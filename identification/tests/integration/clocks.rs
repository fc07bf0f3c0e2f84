//! Records whose times are not what they are taken for, or in which the servo runs into a stop, have no bounds, and a reason. The table
//! "Times that are not what they seem, and stops" of docs/assumptions.md has more of them.

use rand::RngExt;
use servoid_identification::results::Reason;
use servoid_identification::{Options, Record, Run, identify};
use servoid_test_support::loggers::Logger;
use servoid_test_support::plants::{normal, random};
use servoid_test_support::servos::{Limit, limited_in_steps};

#[test]
fn clocks_that_differ_slow_sensors_and_stops_take_the_level() {
    let sound = Logger::default();
    let loggers = [
        (sound, None),
        // 2 to 12 ms over 12 s.
        (
            Logger {
                drift: 0.0002,
                ..sound
            },
            Some(Reason::LagDrift),
        ),
        (
            Logger {
                drift: -0.0005,
                ..sound
            },
            Some(Reason::LagDrift),
        ),
        (
            Logger {
                drift: 0.001,
                ..sound
            },
            Some(Reason::LagDrift),
        ),
        (
            Logger {
                weaker: 0.3,
                ..sound
            },
            Some(Reason::LagDrift),
        ),
        (
            Logger {
                refresh: 5,
                ..sound
            },
            Some(Reason::HeldOutput),
        ),
        (Logger { late: 12, ..sound }, Some(Reason::EarlyMotion)),
        // A few strokes end there, and some.
        (Logger { stop: 8.0, ..sound }, Some(Reason::TravelEnd)),
        (Logger { stop: 6.0, ..sound }, Some(Reason::TravelEnd)),
        // One of five levels lies beyond it: a load may do that, too.
        (
            Logger {
                stop: 9.7,
                levels: 5,
                ..sound
            },
            Some(Reason::TravelEndOpen),
        ),
        (Logger { levels: 5, ..sound }, None),
    ];
    for (logger, expected) in loggers {
        for seed in 1..3 {
            let found = identify(&logger.record(seed), &Options::default()).unwrap();
            assert_eq!(found.bounds.withdrawn(), expected, "{logger:?}, {seed}");
        }
    }
}

/// Times of the end from 40 to 80 % of a run, where the servo stands in the middle of a stroke or between two. Every recording must lose its
/// bounds: that is no matter of chance, as the output stands still for more than two seconds, and eight strokes.
#[test]
fn a_servo_that_dies_takes_the_level_wherever_it_does() {
    for seed in 1..7 {
        let jams = 0.4 + 0.4 * (seed as f64 - 1.0) / 5.0;
        let logger = Logger {
            jams,
            ..Logger::default()
        };
        let found = identify(&logger.record(seed), &Options::default()).unwrap();
        assert_eq!(
            found.bounds.withdrawn(),
            Some(Reason::ServoStopped),
            "{seed}"
        );
        let at_s = found.advice[0].value;
        assert_eq!(found.advice.len(), 1, "{:?}", found.advice);
        // Of 12 s; what is left of a rest before is not seen.
        assert!(
            (12.0 * jams - 0.5..12.0 * jams + 0.1).contains(&at_s),
            "{seed}: {at_s}"
        );
    }
}

/// The farthest that the output was is then that of its drift.
#[test]
fn a_drift_is_no_stop() {
    for seed in 0..10 {
        let record = Logger::default().record(seed);
        let run = &record.runs()[0];
        let share = |k: usize| k as f64 / run.len() as f64;
        let drifting = run.output().iter().enumerate();
        let drifting: Vec<f64> = drifting.map(|(k, y)| y + 0.5 * share(k)).collect();
        let record = Record::of_run(record.sample_period_s(), run.input(), drifting).unwrap();
        let model = identify(&record, &Options::default()).unwrap();
        assert_ne!(
            model.bounds.withdrawn(),
            Some(Reason::TravelEnd),
            "seed {seed}"
        );
    }
}

/// A square wave of ±30, 64 holds of 0.6 s of which the last is longer, at 5 ms, behind a servo whose speed is limited. The response to strokes of 60
/// goes beyond 30 at some times, where the first stroke of 30 has not; it rests below.
#[test]
fn a_square_wave_into_a_limited_speed_is_no_stop() {
    const STEP_S: f64 = 0.0005;
    let command = |k: usize| match (k.checked_sub(120).map(|k| (k / 120).min(63)), k < 7880) {
        (Some(hold), true) => 30.0 - 60.0 * (hold % 2) as f64,
        _ => 0.0,
    };
    for seed in 1..3 {
        let mut random = random(seed);
        let (mut angle, mut speed) = (0.0, 0.0);
        let mut output = Vec::new();
        for k in 0..8000usize {
            output.push(angle + 0.05 * normal(&mut random));
            // A delay of two samples.
            let sent = command(k.saturating_sub(2));
            for _ in 0..10 {
                speed += STEP_S * (2500.0 * (sent - angle) - 80.0 * speed);
                speed = f64::clamp(speed, -300.0, 300.0);
                angle += STEP_S * speed;
            }
        }
        let input: Vec<f64> = (0..8000).map(command).collect();
        let record = Record::of_run(0.005, input, output).unwrap();
        let found = identify(&record, &Options::default()).unwrap();
        assert_ne!(
            found.bounds.withdrawn(),
            Some(Reason::TravelEnd),
            "seed {seed}"
        );
    }
}

/// A servo whose speed is limited answers the stroke from its neutral position, with which each run begins, and that back to it sooner than the longer ones
/// between them.
#[test]
fn shorter_strokes_at_the_ends_of_runs_are_no_drift() {
    for seed in 0..3 {
        let mut random = random(seed);
        let mut run = || {
            let mut input = vec![0.0; 60];
            for stroke in 0..12 {
                let level = [34.0, -20.0][stroke % 2];
                input.extend(std::iter::repeat_n(level, random.random_range(40..80)));
            }
            input.extend([0.0; 60]);
            let limit = Limit::Rate(480.0, 480.0);
            let output = limited_in_steps(0.9, 60.0, limit, &input, 0.0, (2e-4, 50, 50));
            let output: Vec<f64> = output
                .iter()
                .map(|y| y + 0.05 * normal(&mut random))
                .collect();
            Run::new(input, output).unwrap()
        };
        let runs = (0..9).map(|_| run()).collect();
        let model = identify(&Record::new(0.01, runs).unwrap(), &Options::default()).unwrap();
        assert_ne!(model.bounds.withdrawn(), Some(Reason::LagDrift), "{seed}");
    }
}
