//! The figures of exactly known servos.

use approx::assert_abs_diff_eq;
use servoid_identification::results::Model;
use servoid_identification::{Options, Record, Settling, identify};

use servoid_test_support::metrics_coverage::{Case, NAMES, run};
use servoid_test_support::servos::{Linear, PERIOD, staircase};

fn servo(zeta: f64) -> Linear {
    Linear::second_order(0.97, 0.0255, zeta, 60.0)
}

/// Identified without noise: what is left is how the figures are read.
fn noise_free(servo: &Linear, phase: f64) -> Model {
    let input = staircase();
    let record = Record::of_run(PERIOD, &input, servo.respond(&input, -5.0, phase))
        .unwrap()
        .with_sample_phase(phase);
    let options = Options {
        settling: Settling::Samples(201),
        ..Options::default()
    };
    identify(&record, &options).unwrap()
}

#[test]
fn figures_are_those_of_the_servo_whatever_the_phase_of_the_samples() {
    let exact = servo(0.5).figures();
    for phase in [0.0, 0.0005, 0.0013] {
        let found = noise_free(&servo(0.5), phase).metrics;
        let value = |interval: servoid_identification::results::Interval| interval.value.unwrap();
        // Samples are 2 ms apart, and cubics between them leave less than 20 us where the motion
        // starts with a jump of acceleration (5 and 10 %), a few elsewhere.
        assert_abs_diff_eq!(value(found.delay_s), exact.delay_s, epsilon = 3e-5);
        assert_abs_diff_eq!(value(found.t50_s), exact.t50_s, epsilon = 5e-6);
        assert_abs_diff_eq!(value(found.rise_time_s), exact.rise_s, epsilon = 3e-5);
        assert_abs_diff_eq!(
            value(found.settling_time_s),
            exact.settling_s,
            epsilon = 1e-4
        );
        assert_abs_diff_eq!(
            value(found.overshoot_percent),
            exact.overshoot_percent,
            epsilon = 0.02
        );
        // What is left of the response after 201 samples is 2e-5, and so are aliases.
        let relative = |found: f64, exact: f64| found / exact - 1.0;
        assert_abs_diff_eq!(
            relative(value(found.bandwidth_rad_s), exact.bandwidth_rad_s),
            0.0,
            epsilon = 1e-3
        );
        assert_abs_diff_eq!(
            relative(
                value(found.phase_minus_90_rad_s),
                exact.phase_minus_90_rad_s
            ),
            0.0,
            epsilon = 1e-3
        );
    }
}

#[test]
fn the_response_at_any_frequency_is_that_of_the_servo() {
    let model = noise_free(&servo(0.5), 0.0005);
    for omega in [10.0, 60.0, 100.0, 200.0] {
        let response = model.servo_response(&[omega]).unwrap();
        let exact = servo(0.5).response(omega).arg().to_degrees();
        assert_abs_diff_eq!(response.phase_deg[0], exact, epsilon = 0.2);
        let (re, im) = (servo(0.5).response(omega).re, servo(0.5).response(omega).im);
        assert_abs_diff_eq!(response.re[0], re, epsilon = 1e-3);
        assert_abs_diff_eq!(response.im[0], im, epsilon = 1e-3);
    }
}

#[test]
fn intervals_hold_the_exact_figures() {
    require_held(&[(0.5, 1.0)]);
}

#[test]
#[ignore = "many seeds: cargo test -p servoid-identification --test integration -- --ignored metrics"]
fn intervals_hold_the_exact_figures_of_other_servos_and_in_loud_noise() {
    require_held(&[(0.78, 1.0), (0.9, 10.0)]);
}

/// Of servos with these damping ratios in noise of these sizes.
fn require_held(cases: &[(f64, f64)]) {
    let mut short = Vec::new();
    for &(zeta, noise) in cases {
        let case = Case {
            servo: servo(zeta),
            sample_phase_s: 0.0005,
            noise,
            settling: Settling::Samples(151),
            level: 0.9,
        };
        let found = run(&case, 40, 1000);
        for (name, coverage) in NAMES.iter().zip(found) {
            // 40 runs at 90 % have a standard deviation of 4.7 %: three of them below.
            if coverage.share < 0.76 {
                short.push(format!("{name}, zeta {zeta}, noise {noise}: {coverage:?}"));
            }
        }
    }
    assert!(short.is_empty(), "{short:#?}");
}
