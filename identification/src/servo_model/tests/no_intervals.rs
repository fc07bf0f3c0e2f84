//! Recordings that leave the servo open have no intervals.

use super::{PERIOD_S, noisy, point, quantities, strokes, value, with_noise};
use crate::data::Record;
use crate::results::{Bounds, Interval, Reason};
use crate::servo_model::descent::coordinates::{Coordinate, Terms};
use crate::servo_model::{Alternative, ServoModel, ServoModelOptions, Spread, fit};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// A shaft that is held has no gain, and a model of it has errors that are noise.
#[test]
fn a_servo_that_does_not_move_has_no_intervals() {
    let servo = point(Terms::default(), value);
    let output = noisy(&servo, &[0.0; 2000], 4);
    let record = Record::of_run(PERIOD_S, strokes(2000), output).unwrap();
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    assert_eq!(found.covariance.withdrawn(), Some(Reason::MotionInNoise));
}

/// A dead band between two levels is a smaller gain, wherever the servo began.
#[test]
fn two_levels_behind_a_third_have_no_intervals() {
    let terms = Terms {
        limit: true,
        dead_band: true,
        ..Terms::default()
    };
    let unlimited = |at: Coordinate| match at {
        Coordinate::LnDamping => 100f64.ln(),
        Coordinate::LnTopSpeed => 1e5f64.ln(),
        Coordinate::DeadBand => 0.4,
        other => value(other),
    };
    let servo = point(terms, unlimited);
    let level = |k: usize| match (k / 150, k / 150 % 2) {
        (0, _) => 0.0,
        (_, 0) => -5.0,
        _ => 5.0,
    };
    let input: Vec<f64> = (0..4000).map(level).collect();
    let record = Record::of_run(PERIOD_S, &input, noisy(&servo, &input, 5)).unwrap();
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    assert_eq!(found.covariance.withdrawn(), Some(Reason::FewLevels));
}

/// A controller whose drive ends sooner downwards, at one stiffness: beside a dead band that is no load, which pushes there too, and the equation has it neither.
#[test]
fn unequal_limits_beside_a_dead_band_have_no_intervals() {
    const STEP_S: f64 = 1e-4;
    let (stiffness, damping, motor, limit) = (2000.0, 70.0, 27.0, 9000.0);
    let input = strokes(6000);
    let output = |down_to_up: f64| {
        let (mut angle, mut speed) = (input[0], 0.0);
        let moved = input.iter().map(|command| {
            let now = angle;
            for _ in 0..(PERIOD_S / STEP_S).round() as usize {
                let error: f64 = command - angle;
                let beyond = error - error.clamp(-0.3, 0.3);
                let drive = stiffness * beyond - (damping - motor) * speed;
                speed += STEP_S * (drive.clamp(-down_to_up * limit, limit) - motor * speed);
                angle += STEP_S * speed;
            }
            now
        });
        moved.collect::<Vec<f64>>()
    };
    let servo = |down_to_up: f64| {
        let mut random = ChaCha8Rng::seed_from_u64(6);
        let mut noise = move || -> f64 {
            let standard: f64 = StandardNormal.sample(&mut random);
            0.03 * standard
        };
        let output = output(down_to_up)
            .iter()
            .map(|y| y + noise())
            .collect::<Vec<f64>>();
        let record = Record::of_run(PERIOD_S, &input, output).unwrap();
        fit(&record, &ServoModelOptions::default()).unwrap()
    };
    assert!(servo(1.0).covariance.valid().is_some());
    let withdrawn = servo(0.96).covariance.withdrawn();
    assert_eq!(withdrawn, Some(Reason::ErrorsNotNoise));
}

/// Beside friction, too, with a dead band that a fit takes for more of it: under a load it needs less of one.
#[test]
fn unequal_limits_beside_a_dead_band_and_friction_have_no_intervals_that_miss() {
    let terms = Terms {
        limit: true,
        two_speeds: true,
        one_stiffness: true,
        dead_band: true,
        friction: true,
        ..Terms::default()
    };
    let at = |coordinate: Coordinate| match coordinate {
        Coordinate::LnDownToUp => 0.91f64.ln(),
        Coordinate::DeadBand => 0.1,
        Coordinate::Friction => 0.08,
        Coordinate::FrictionAtRest => 0.0,
        other => value(other),
    };
    let servo = point(terms, at);
    let input = strokes(8000);
    let middle = 0.5 * (input.iter().fold(0.0, |most: f64, u| most.max(*u)) - 5.0);
    for seed in 1..=3 {
        let output = with_noise(&servo, &input, 0.02, seed);
        let record = Record::of_run(PERIOD_S, &input, output).unwrap();
        let found = fit(&record, &ServoModelOptions::default()).unwrap();
        for (name, truth) in quantities::values(&servo, middle) {
            let mut named = found.quantities.iter().filter(|found| found.name == name);
            let Some(Bounds::Valid(interval)) = named.next().map(|found| found.interval) else {
                continue;
            };
            assert!(
                interval.contains(truth),
                "{seed}, {name}: {truth} {interval:?}"
            );
        }
    }
}

/// Two levels of the command leave friction, gain and offset open between them.
#[test]
fn two_levels_have_no_intervals() {
    let terms = Terms {
        limit: true,
        friction: true,
        ..Terms::default()
    };
    let servo = point(terms, value);
    let input: Vec<f64> = (0..2000)
        .map(|k| if k / 150 % 2 == 0 { -5.0 } else { 5.0 })
        .collect();
    let record = Record::of_run(PERIOD_S, &input, noisy(&servo, &input, 3)).unwrap();
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    assert_eq!(found.covariance.withdrawn(), Some(Reason::FewLevels));
    for quantity in &found.quantities {
        assert!(quantity.interval.withdrawn().is_some());
        let Spread { least, most } = quantity.other_fits.unwrap();
        assert!(least <= quantity.value && quantity.value <= most);
    }
    // Between two levels fits to parts of the record agree on the time, and not on friction.
    let spread = |name: &str| {
        let mut named = found.quantities.iter().filter(|found| found.name == name);
        named.next().and_then(|found| found.other_fits).unwrap()
    };
    let delay = spread("delay");
    assert!(delay.most - delay.least < 2e-3, "{delay:?}");
    assert!(
        found.alternatives.is_empty() && found.respond(&[0.0, 1.0], 0).half_width.valid().is_none()
    );
    assert_eq!(found.fit.discrepancy, None);
    require_one_validity(&found);
}

/// Steps of a sensor that are larger than the noise leave errors that stand still with the servo: they are none of the servo's.
#[test]
fn steps_of_the_sensor_that_hide_the_servo_are_the_reason() {
    const STEP: f64 = 0.35;
    let servo = point(Terms::default(), value);
    let round = |y: f64| (y / STEP).round() * STEP;
    let output: Vec<f64> = (noisy(&servo, &strokes(3000), 5).into_iter())
        .map(round)
        .collect();
    let record = Record::of_run(PERIOD_S, strokes(3000), output).unwrap();
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    assert_eq!(
        found.covariance.withdrawn(),
        Some(Reason::QuantisationAboveNoise)
    );
    require_one_validity(&found);
}

/// A document that has bounds in one part and none in another is refused.
fn require_one_validity(withdrawn: &ServoModel) {
    assert!(withdrawn.is_consistent());
    let mut with_interval = withdrawn.clone();
    let quantity = &mut with_interval.quantities[0];
    quantity.interval = Bounds::Valid(Interval::new(quantity.value, 0.0, 1.0));
    assert!(!with_interval.is_consistent());
    let mut for_another_reason = withdrawn.clone();
    for_another_reason.quantities[0].interval = Bounds::Withdrawn(Reason::ErrorsNotNoise);
    assert!(!for_another_reason.is_consistent());
    let mut with_alternative = withdrawn.clone();
    let count = withdrawn.values.len();
    with_alternative.alternatives.push(Alternative {
        terms: withdrawn.terms,
        coordinates: withdrawn.coordinates.clone(),
        values: withdrawn.values.clone(),
        friction_speed_share: 0.1,
        covariance: vec![vec![0.0; count]; count],
    });
    assert!(!with_alternative.is_consistent());
}
