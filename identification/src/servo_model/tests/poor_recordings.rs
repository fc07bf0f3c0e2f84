//! Recordings of poor quality, and those that no servo model is of.

use super::{PERIOD_S, noisy, point, strokes, value};
use crate::data::{Record, Run};
use crate::servo_model::descent::coordinates::Terms;
use crate::servo_model::{ServoModelOptions, fit};

/// Missing samples, a stop in the middle of the travel, a servo that is switched off half-way, a single stroke, a glitch: numbers
/// stay finite.
#[test]
fn recordings_of_poor_quality_give_finite_numbers() {
    let terms = Terms {
        limit: true,
        ..Terms::default()
    };
    let (servo, input) = (point(terms, value), strokes(800));
    let good = noisy(&servo, &input, 4);
    let changed = |of: &dyn Fn(usize, f64) -> f64| -> Vec<f64> {
        good.iter().enumerate().map(|(k, y)| of(k, *y)).collect()
    };
    let outputs = [
        changed(&|k, y| {
            if k % 17 == 3 || (300..340).contains(&k) {
                f64::NAN
            } else {
                y
            }
        }),
        changed(&|_, y| y.min(2.0)),
        changed(&|k, y| if k > 400 { 0.0 } else { y }),
        changed(&|k, y| if k == 200 { 1e6 } else { y }),
    ];
    let mut records: Vec<Record> = outputs
        .iter()
        .map(|output| Record::of_run(PERIOD_S, &input, output).unwrap())
        .collect();
    let gaps: Vec<f64> = input
        .iter()
        .enumerate()
        .map(|(k, u)| if k % 211 == 7 { f64::NAN } else { *u })
        .collect();
    records.push(Record::of_run(PERIOD_S, gaps, good).unwrap());
    let single = [vec![0.0; 40], vec![5.0; 100]].concat();
    records.push(Record::of_run(PERIOD_S, &single, noisy(&servo, &single, 5)).unwrap());
    for (number, record) in records.iter().enumerate() {
        let found = fit(record, &ServoModelOptions::default()).unwrap();
        assert!(
            found.values.iter().all(|value| value.is_finite()),
            "{number}: {found:?}"
        );
        assert!(
            found.fit.rmse.is_finite() && found.is_consistent(),
            "{number}: {found:?}"
        );
    }
}

#[test]
fn what_cannot_be_fitted_is_refused_with_a_sentence() {
    let short = Record::of_run(PERIOD_S, strokes(60), strokes(60)).unwrap();
    assert!(fit(&short, &ServoModelOptions::default()).is_err());
    let input = strokes(400);
    let runs: Vec<Run> = (0..40)
        .map(|_| Run::new(input.clone(), input.clone()).unwrap())
        .collect();
    let many = Record::new(PERIOD_S, runs).unwrap();
    let options = ServoModelOptions {
        controllers: (0..40).collect(),
        ..ServoModelOptions::default()
    };
    let error = fit(&many, &options).unwrap_err().to_string();
    assert!(error.contains("40 controllers"), "{error}");
}

#[test]
fn samples_too_far_apart_for_a_servo_are_refused_before_the_search() {
    let input = strokes(600);
    let record = Record::of_run(5.0, &input, &input).unwrap();
    let refused = fit(&record, &ServoModelOptions::default()).unwrap_err();
    assert!(refused.to_string().contains("5 s apart"), "{refused}");
}
