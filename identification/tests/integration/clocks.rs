//! Records whose times are not what they are taken for, or in which the servo runs into a stop, have no bounds, and a reason. The table
//! "Times that are not what they seem, and stops" of docs/method.md has more of them.

use servoid_identification::results::Reason;
use servoid_identification::{Options, identify};
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
        for seed in 1..4 {
            let found = identify(&logger.record(seed), &Options::default()).unwrap();
            assert_eq!(found.bounds.withdrawn(), expected, "{logger:?}, {seed}");
        }
    }
}
