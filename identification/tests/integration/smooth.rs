//! Inputs without steps: results that they determine, and results that are withheld.

use std::f64::consts::TAU;

use servoid_identification::{Error, Frequencies, Options, Record, Settling, identify};

use servoid_test_support::servos::{Linear, PERIOD, measured};

const SAMPLES: usize = 1200;

/// A servo of two lags, 52 and 8 ms, at the sum of sines of these amplitudes and frequencies \[Hz\].
fn under_sines(sines: &[(f64, f64)]) -> Record<'static> {
    let servo = Linear::second_order(1.0, 0.0, 1.5, 50.0);
    let input: Vec<f64> = (0..SAMPLES)
        .map(|k| {
            let t = k as f64 * PERIOD;
            sines.iter().map(|(a, hz)| a * (TAU * hz * t).sin()).sum()
        })
        .collect();
    let clean = servo.respond(&input, 0.0, 0.0);
    Record::of_run(PERIOD, input, measured(&clean, 1.0, 7)).unwrap()
}

#[test]
fn a_single_sine_is_no_step_response() {
    let refused = identify(&under_sines(&[(5.0, 3.0)]), &Options::default());
    assert!(matches!(refused, Err(Error::NoDetail)), "{refused:?}");
}

#[test]
fn two_sines_get_bounds_without_a_level() {
    let model = identify(&under_sines(&[(5.0, 3.0), (2.0, 7.0)]), &Options::default()).unwrap();
    assert!(model.bounds.valid().is_none(), "{:?}", model.advice);
}

#[test]
fn a_bank_of_the_gain_alone_determines_no_bandwidth() {
    let options = Options {
        settling: Settling::Samples(31),
        frequencies: Frequencies::Count(1),
        ..Options::default()
    };
    let model = identify(&under_sines(&[(5.0, 0.3)]), &options).unwrap();
    assert_eq!(model.metrics.bandwidth_rad_s.value, None);
    assert_eq!(model.metrics.phase_minus_90_rad_s.value, None);
    assert!(
        model
            .metrics
            .rise_time_s
            .lower
            .is_none_or(|rise| rise >= 0.0)
    );
}
