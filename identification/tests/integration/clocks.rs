//! Records whose times are not what they are taken for have no bounds, and a reason. The table "Times that are not what they seem" of
//! docs/method.md has more of them.

use servoid_identification::results::Reason;
use servoid_identification::{Options, identify};
use servoid_test_support::loggers::Logger;

#[test]
fn clocks_that_differ_and_sensors_that_are_slow_take_the_level() {
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
    ];
    for (logger, expected) in loggers {
        for seed in 1..3 {
            let found = identify(&logger.record(seed), &Options::default()).unwrap();
            assert_eq!(found.bounds.withdrawn(), expected, "{logger:?}, {seed}");
        }
    }
}
