//! Servos of each kind are found again, with intervals that hold.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::{PERIOD_S, in_noise, noisy, point, require_held, response, strokes, value, with_noise};
use crate::data::Record;
use crate::servo_model::descent::coordinates::{Coordinate, FRICTION_SPEED_SHARE, Point, Terms};
use crate::servo_model::{
    Alternative, QuantityKind, ServoModel, ServoModelOptions, fit, quantities,
};
use servoid_dynamics::{Grid, Start, simulate};

#[test]
fn a_limited_servo_is_found_again() {
    let terms = Terms {
        limit: true,
        two_speeds: true,
        ..Terms::default()
    };
    let (servo, input) = (point(terms, value), strokes(2000));
    let record = Record::of_run(PERIOD_S, &input, noisy(&servo, &input, 1)).unwrap();
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    assert_eq!(found.terms, terms);
    assert!(found.fit.held_out_percent > 98.5, "{:?}", found.fit);
    for (name, truth) in quantities::values(&servo, 0.0) {
        let quantity = found
            .quantities
            .iter()
            .find(|quantity| quantity.name == name)
            .unwrap();
        assert_eq!(quantity.other_fits, None);
        let interval = quantity.interval.valid().unwrap();
        assert!(interval.contains(truth), "{name}: {truth} {interval:?}");
        assert!(quantity.determined, "{name}: {quantity:?}");
    }
    let new = [vec![0.0; 20], vec![3.0; 200]].concat();
    let (predicted, truth) = (found.respond(&new, 0), response(&servo, &new, 1e-4));
    for ((value, half), truth) in predicted
        .value
        .iter()
        .zip(predicted.half_width.valid().unwrap())
        .zip(truth)
    {
        assert!(
            (value - truth).abs() <= half + 1e-6,
            "{value} {half} {truth}"
        );
    }
}

/// The motor has next to no damping of its own: full drive ends in no speed.
#[test]
fn a_servo_whose_acceleration_alone_is_limited_is_found_again() {
    let full_drive = 2500.0;
    let undamped = |at: Coordinate| match at {
        Coordinate::LnDamping => 60f64.ln(),
        Coordinate::LnStiffness => 3600f64.ln(),
        Coordinate::MotorShare => 1e-4,
        Coordinate::LnTopSpeed => (full_drive / (1e-4 * 60f64)).ln(),
        other => value(other),
    };
    let terms = Terms {
        limit: true,
        ..Terms::default()
    };
    let servo = point(terms, undamped);
    // Held twice as long, until it rests.
    let input: Vec<f64> = (strokes(4000).into_iter())
        .flat_map(|level| [level; 2])
        .collect();
    let record = Record::of_run(PERIOD_S, &input, noisy(&servo, &input, 1)).unwrap();
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    assert_eq!(found.terms, terms);
    for kind in [
        QuantityKind::Bandwidth,
        QuantityKind::DampingRatio,
        QuantityKind::ErrorOfFullDrive,
        QuantityKind::AccelerationUpwards,
        QuantityKind::TopSpeedUpwards,
    ] {
        let mut all = quantities::values(&servo, 0.0).into_iter();
        let (_, truth) = all.find(|(name, _)| *name == kind.name()).unwrap();
        let interval = found.quantity(kind).unwrap().interval;
        assert!(
            interval.valid().unwrap().contains(truth),
            "{kind:?}: {truth} {interval:?}"
        );
    }
}

/// A position that follows the command by so much in a second at the most, up and down, and is otherwise there at once.
#[test]
fn a_servo_whose_speed_alone_is_limited_is_found_again() {
    const STEPS: usize = 100;
    let (delay_s, [up, down]) = (0.02, [40.0, 30.0]);
    let input = strokes(2400);
    let step_s = PERIOD_S / STEPS as f64;
    let late = (delay_s / step_s).round() as usize;
    let mut random = ChaCha8Rng::seed_from_u64(6);
    let mut position = input[0];
    let mut output = Vec::new();
    for step in 0..input.len() * STEPS {
        if step % STEPS == 0 {
            let v: f64 = StandardNormal.sample(&mut random);
            output.push(position + 0.03 * v);
        }
        let command = input[step.saturating_sub(late) / STEPS];
        position += (command - position).clamp(-down * step_s, up * step_s);
    }
    let record = Record::of_run(PERIOD_S, &input, &output).unwrap();
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    for (name, truth) in [
        ("delay", delay_s),
        ("gain", 1.0),
        ("top speed upwards", up),
        ("top speed downwards", down),
    ] {
        let mut named = found.quantities.iter().filter(|found| found.name == name);
        let quantity = named.next().unwrap();
        let interval = quantity.interval.valid().unwrap();
        assert!(
            quantity.determined && interval.contains(truth),
            "{name}: {truth} {quantity:?}"
        );
    }
    // Nothing shows how fast it would get there.
    let accelerations = found.quantities.iter();
    for quantity in accelerations.filter(|found| found.name.starts_with("acceleration")) {
        assert!(!quantity.determined, "{quantity:?}");
    }
}

/// Friction beside a limit explains most of what a dead band leaves at rest, so both are tried before anything is added to either.
#[test]
fn a_dead_band_is_not_taken_for_friction() {
    let unlimited = |at: Coordinate| match at {
        Coordinate::Delay => 0.006,
        Coordinate::LnStiffness => 5155f64.ln(),
        Coordinate::LnDamping => 112f64.ln(),
        Coordinate::LnTopSpeed => 1e5f64.ln(),
        Coordinate::DeadBand => 0.4,
        other => value(other),
    };
    let terms = Terms {
        limit: true,
        dead_band: true,
        ..Terms::default()
    };
    let servo = point(terms, unlimited);
    for seed in 1..4 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut input = vec![0.0; 250];
        while input.len() < 20_000 {
            let size = 4.0 * [0.3, 0.6, 1.0][random.random_range(0..3)];
            let hold = random.random_range(75..150);
            for level in [size, -size, 0.0, 0.0] {
                input.extend(std::iter::repeat_n(level, hold));
            }
        }
        let output = with_noise(&servo, &input, 0.2, seed);
        let record = Record::of_run(PERIOD_S, &input, output).unwrap();
        let found = fit(&record, &ServoModelOptions::default()).unwrap();
        assert_eq!(found.terms, terms, "seed {seed}");
        for (name, truth) in [("delay", 0.006), ("dead band, to each side", 0.4)] {
            let mut named = found.quantities.iter().filter(|found| found.name == name);
            let interval = named.next().unwrap().interval.valid().unwrap();
            assert!(interval.contains(truth), "seed {seed}: {name} {interval:?}");
        }
        require_band_from_all_rests(&servo, &found);
    }
}

/// Friction alone rests alike and predicts as well, though less of it is friction: sines are later by two degrees. A small dead band beside all of that friction is in another
/// valley than the true one.
#[test]
fn the_dead_band_is_possible_where_friction_alone_predicts_as_well() {
    let limited = |at: Coordinate| match at {
        Coordinate::Delay => 0.0075,
        Coordinate::LnStiffness => 1823f64.ln(),
        Coordinate::LnDamping => 67.7f64.ln(),
        Coordinate::LnTopSpeed => 437.6f64.ln(),
        Coordinate::MotorShare => 0.37,
        Coordinate::DeadBand => 0.3,
        Coordinate::Friction => 0.24,
        Coordinate::FrictionAtRest => 0.0,
        other => value(other),
    };
    let terms = Terms {
        limit: true,
        dead_band: true,
        friction: true,
        ..Terms::default()
    };
    let servo = point(terms, limited);
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut input = vec![0.0; 100];
    while input.len() < 16_000 {
        let hold = 10 * random.random_range(12..31);
        input.extend(std::iter::repeat_n(random.random_range(-16.0..16.0), hold));
    }
    let record = Record::of_run(PERIOD_S, &input, with_noise(&servo, &input, 0.06, 5)).unwrap();
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    require_held(&found, &servo, &["resting error by friction"]);
    let dead_band = |other: &Alternative| {
        let all = other.coordinates.iter().zip(&other.values);
        let mut named = all.filter(|(at, _)| **at == Coordinate::DeadBand);
        named.next().map_or(0.0, |(_, value)| *value)
    };
    let all: Vec<f64> = found.alternatives.iter().map(dead_band).collect();
    assert!(all.iter().any(|width| *width > 0.2), "{all:?}");
}

/// With half of it gone at 5 % of the top speed as of other servos, errors are left that are no noise.
#[test]
fn friction_at_rest_may_be_gone_at_a_low_speed() {
    let terms = Terms {
        limit: true,
        friction: true,
        ..Terms::default()
    };
    let sticking = |at: Coordinate| match at {
        Coordinate::Friction => 0.25,
        Coordinate::FrictionAtRest => 1.0,
        other => value(other),
    };
    let mut random = ChaCha8Rng::seed_from_u64(9);
    let mut input = vec![0.0; 100];
    while input.len() < 5000 {
        let hold = random.random_range(50..200);
        input.extend(std::iter::repeat_n(random.random_range(-5.0..5.0), hold));
    }
    for friction_speed_share in [FRICTION_SPEED_SHARE, 0.008] {
        let servo = Point {
            friction_speed_share,
            ..point(terms, sticking)
        };
        let output = with_noise(&servo, &input, 0.02, 3);
        let record = Record::of_run(PERIOD_S, &input, output).unwrap();
        let found = fit(&record, &ServoModelOptions::default()).unwrap();
        let own = found.own_friction_speed_share();
        let is_usual = friction_speed_share == FRICTION_SPEED_SHARE;
        assert_eq!(own.is_none(), is_usual, "{own:?}");
        let names = [
            "delay",
            "gain",
            "damping ratio",
            "resting error by friction",
        ];
        require_held(&found, &servo, &names);
        let offset = found.quantity(QuantityKind::Offset).unwrap();
        assert_eq!(offset.determined, is_usual);
    }
}

/// Play delays the output where the motion turns round: it is seen, or in the interval.
#[test]
fn a_small_play_gives_no_false_delay() {
    let terms = Terms {
        limit: true,
        friction: true,
        ..Terms::default()
    };
    let quick = |at: Coordinate| match at {
        Coordinate::Delay => 0.0035,
        Coordinate::LnStiffness => 5600f64.ln(),
        Coordinate::LnDamping => 105f64.ln(),
        Coordinate::LnTopSpeed => 620f64.ln(),
        Coordinate::MotorShare => 0.6,
        Coordinate::Friction => 0.1,
        Coordinate::FrictionAtRest => 0.3,
        other => value(other),
    };
    let servo = point(terms, quick);
    let levels = [-15.0, -7.5, 0.0, 7.5, 15.0, 7.5, 0.0, -7.5];
    let stairs = levels.repeat(4).into_iter();
    let input: Vec<f64> = stairs
        .flat_map(|level| std::iter::repeat_n(level, 250))
        .collect();
    let mut behind: Option<f64> = None;
    let through_play = |y: f64| {
        let held = behind.unwrap_or(y).clamp(y - 0.04, y + 0.04);
        behind = Some(held);
        held
    };
    let output: Vec<f64> = response(&servo, &input, 1e-4)
        .into_iter()
        .map(through_play)
        .collect();
    for seed in 1..7 {
        let measured = in_noise(output.clone(), 0.06, seed);
        let record = Record::of_run(PERIOD_S, &input, measured).unwrap();
        let found = fit(&record, &ServoModelOptions::default()).unwrap();
        if found.covariance.valid().is_some() {
            require_held(&found, &servo, &["delay"]);
        }
    }
}

/// The band of a stroke holds the servo from either edge of where it may have rested before.
fn require_band_from_all_rests(servo: &Point, found: &ServoModel) {
    let stroke = [vec![0.0; 20], vec![4.0; 200]].concat();
    let predicted = found.respond(&stroke, 0);
    let half_width = predicted.half_width.valid().unwrap();
    let physics = servo.physics(0, |_, value| value);
    for angle in physics.staying_angles(0.0) {
        let start = Start::at_rest(angle * physics.gain + physics.offset, Some(0.0));
        let grid = Grid::new(PERIOD_S, 0.0, 1e-4);
        simulate(&physics, &grid, &start, &stroke, |k, truth| {
            let (value, half) = (predicted.value[k], half_width[k]);
            assert!(
                (value - truth).abs() <= half + 1e-6,
                "{k}: {value} {half} {truth}"
            );
        });
    }
    // The edges are 0.4 of the unit from the middle, by the gain; where the stroke has ended, the start is forgotten.
    let (first, last) = (half_width[0], half_width[219]);
    assert!(first > 0.4 && last < 0.5 * first, "{first} {last}");
}

#[test]
fn a_linear_servo_stays_linear() {
    let (servo, input) = (point(Terms::default(), value), strokes(2000));
    let record = Record::of_run(PERIOD_S, &input, noisy(&servo, &input, 2)).unwrap();
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    assert!(found.is_linear(), "{:?}", found.terms);
}
