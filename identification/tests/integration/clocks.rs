//! Records whose times are not what they are taken for, or in which the servo runs into a stop, have no bounds, and a reason. The table
//! "Times that are not what they seem, and stops" of docs/method.md has more of them.

use servoid_identification::results::Reason;
use servoid_identification::{Options, Record, identify};
use servoid_test_support::loggers::Logger;

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
        (Logger { stop: 9.0, ..sound }, Some(Reason::TravelEnd)),
        (Logger { stop: 6.0, ..sound }, Some(Reason::TravelEnd)),
        // One of five levels lies beyond it.
        (
            Logger {
                stop: 9.7,
                levels: 5,
                ..sound
            },
            Some(Reason::TravelEnd),
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
