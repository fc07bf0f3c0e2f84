//! Runs between which a servo changed are distinguished from runs of one servo that has something the model lacks.

use super::{PERIOD_S, point, response, strokes, value};
use crate::data::{Record, Run};
use crate::results::Reason;
use crate::servo_model::descent::coordinates::{Coordinate, Terms};
use crate::servo_model::{ServoModel, ServoModelOptions, fit};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Three runs of a servo whose stiffness and top speed are `apart` from run to run, as a share, seen behind a linkage that adds `bend` times the square of the angle.
fn found(apart: f64, bend: f64) -> ServoModel {
    let terms = Terms {
        limit: true,
        ..Terms::default()
    };
    let run = |number: u8| {
        let change = apart * (f64::from(number) - 1.0);
        let servo = point(terms, |at| match at {
            Coordinate::LnStiffness | Coordinate::LnTopSpeed => value(at) + change,
            _ => value(at),
        });
        let mut input = strokes(2400);
        // Levels in another order each.
        input.rotate_left(800 * usize::from(number));
        let mut random = ChaCha8Rng::seed_from_u64(40 + u64::from(number));
        let shaft = response(&servo, &input, 1e-4);
        let output = shaft.into_iter().map(|y| {
            let noise: f64 = StandardNormal.sample(&mut random);
            y + bend * y * y + 0.03 * noise
        });
        let output: Vec<f64> = output.collect();
        Run::new(input, output).unwrap()
    };
    let record = Record::new(PERIOD_S, (0..3).map(run).collect()).unwrap();
    fit(&record, &ServoModelOptions::default()).unwrap()
}

#[test]
fn a_servo_that_changed_is_distinguished_from_one_behind_a_linkage() {
    let changed = found(0.2, 0.0);
    let said = (changed.covariance.withdrawn(), changed.fit.servo_changed);
    assert_eq!(said, (Some(Reason::ErrorsNotNoise), true));
    let behind_linkage = found(0.0, 0.01);
    assert!(behind_linkage.covariance.withdrawn().is_some() && !behind_linkage.fit.servo_changed);
    let same = found(0.0, 0.0);
    assert!(same.covariance.valid().is_some() && !same.fit.servo_changed);
}
