//! Where the servo rests under command 0, and what it is in each run.

use super::{PERIOD_S, noisy, point, require_intervals, strokes, value};
use crate::data::{Record, Run};
use crate::servo_model::descent::coordinates::{Coordinate, LoadKind, Point, Terms};
use crate::servo_model::{ServoModelOptions, fit, quantities};

#[test]
fn the_offset_of_a_loaded_servo_is_where_it_rests() {
    let loaded = Terms {
        limit: true,
        load: LoadKind::Constant,
        ..Terms::default()
    };
    let with = |terms, load: f64| {
        point(terms, |at| match at {
            Coordinate::DeadBand => 0.6,
            Coordinate::LnDownToUp => 0.5f64.ln(),
            Coordinate::ConstantLoad => load,
            other => value(other),
        })
    };
    let dead_band = Terms {
        dead_band: true,
        ..loaded
    };
    let unequal = Terms {
        two_speeds: true,
        ..loaded
    };
    // Beyond the edge of the dead band, and against the weaker side of the drive; all times the gain of 1.1.
    for (servo, rest) in [
        (with(dead_band, 0.8), 0.3 - 1.1 * (0.6 + 0.8)),
        (with(unequal, -0.72), 0.3 + 1.1 * (0.72 / 0.5)),
    ] {
        let physics = servo.physics(0, |_, value| value);
        assert!((physics.resting_output(0.0) - rest).abs() < 1e-9);
        require_intervals(&servo, &["offset"], 31);
    }
}

/// Three runs of a limited servo, whose sensor's zero is `offsets` further up in each.
fn runs_with(offsets: [f64; 3]) -> (Point, Record<'static>) {
    let terms = Terms {
        limit: true,
        two_speeds: true,
        ..Terms::default()
    };
    let servo = point(terms, value);
    let input = strokes(2400);
    let run = |(index, offset): (usize, f64)| {
        let input = [&[0.0; 40][..], &input[800 * index..800 * (index + 1)]].concat();
        let output = noisy(&servo, &input, 20 + index as u64);
        Run::new(
            input,
            output.into_iter().map(|y| y + offset).collect::<Vec<_>>(),
        )
        .unwrap()
    };
    let runs = offsets.into_iter().enumerate().map(run).collect();
    (servo, Record::new(PERIOD_S, runs).unwrap())
}

#[test]
fn the_zero_of_the_sensor_may_move_between_runs() {
    let offsets = [0.5, -0.25, 2.0];
    let mean = offsets.iter().sum::<f64>() / 3.0;
    let (mut servo, record) = runs_with(offsets);
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    for (found, own) in found.run_offsets.iter().zip(offsets) {
        assert!((found - (own - mean)).abs() < 0.01, "{found} {own}");
    }
    let common = servo.get(Coordinate::Offset).unwrap();
    servo.set(Coordinate::Offset, common + mean);
    for (name, truth) in quantities::values(&servo, 0.0) {
        let mut named = found.quantities.iter().filter(|found| found.name == name);
        let quantity = named.next().unwrap();
        let interval = quantity.interval.valid().unwrap();
        assert!(interval.contains(truth), "{name}: {truth} {interval:?}");
        // As wide as noise of 0.03 in 840 samples of each run makes it, not as wide as the offsets.
        assert!(
            name != "offset" || interval.upper.unwrap() - interval.lower.unwrap() < 0.04,
            "{interval:?}"
        );
    }
    // The zero of another run is found from that run.
    let (_, other) = runs_with([-1.0, 0.0, 4.0]);
    let fit_percent = found.validate(&other, &[]).unwrap().fit_percent;
    assert!(fit_percent > 98.0, "{fit_percent}");
}

#[test]
fn runs_that_do_not_differ_have_one_offset() {
    let (_, record) = runs_with([0.0; 3]);
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    assert!(found.run_offsets.is_empty(), "{:?}", found.run_offsets);
}
