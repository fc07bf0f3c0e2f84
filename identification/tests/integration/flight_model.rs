//! Parameters of known servos, through the flight model.

use rayon::prelude::*;
use servoid_identification::flight_model::{FlightModel, FlightModelOptions, fit, of_model};
use servoid_identification::results::{Model, Reason};
use servoid_identification::{Frequencies, Options, Record, Run, Settling, identify};

use servoid_test_support::servos::{Limit, Linear, PERIOD, limited, measured, staircase};

fn flight(
    clean: &[f64],
    settling: usize,
    frequencies: Frequencies,
    phase: f64,
    seed: u64,
) -> FlightModel {
    with_response(clean, settling, frequencies, phase, seed).1
}

/// The response that is fitted beside it.
fn with_response(
    clean: &[f64],
    settling: usize,
    frequencies: Frequencies,
    phase: f64,
    seed: u64,
) -> (Model, FlightModel) {
    let record = Record::of_run(PERIOD, staircase(), measured(clean, 1.0, seed))
        .unwrap()
        .with_sample_phase(phase);
    let options = Options {
        settling: Settling::Samples(settling),
        frequencies,
        level: 0.9,
        ..Options::default()
    };
    let model = identify(&record, &options).unwrap();
    let options = FlightModelOptions {
        frame_period_s: Some(0.02),
        ..FlightModelOptions::default()
    };
    let found = fit(&record, &model, &options).unwrap();
    (model, found)
}

#[test]
fn parameters_are_held_by_their_intervals_even_where_the_bank_is_small_and_short() {
    let servo = Linear::second_order(0.97, 0.0255, 0.5, 60.0);
    for (settling, frequencies) in [(151, Frequencies::Auto), (100, Frequencies::Count(23))] {
        let phase = 0.0005;
        let clean = servo.respond(&staircase(), -5.0, phase);
        let runs = 30;
        let held: Vec<[bool; 5]> = (0..runs)
            .into_par_iter()
            .map(|seed| {
                let found = flight(&clean, settling, frequencies, phase, seed);
                let (omega, damping) = (found.omega_rad_s.unwrap(), found.damping.unwrap());
                assert!(found.lag_s.is_none() || found.order == 3);
                [
                    found.gain.contains(0.97),
                    found.delay_s.contains(0.0255),
                    omega.contains(60.0),
                    damping.contains(0.5),
                    found.order == 2 && !found.approximation,
                ]
            })
            .collect();
        for (k, name) in ["gain", "delay", "omega", "damping", "order"]
            .iter()
            .enumerate()
        {
            let share = held.iter().filter(|run| run[k]).count() as f64 / runs as f64;
            // 30 runs at 90 %: three standard deviations of 5.5 % below.
            assert!(share > 0.73, "{name}, N = {settling}: {share}");
        }
    }
}

#[test]
fn without_the_record_a_complete_bank_gives_the_same_model() {
    let servo = Linear::second_order(0.97, 0.0255, 0.5, 60.0);
    let clean = servo.respond(&staircase(), -5.0, 0.0005);
    let record = Record::of_run(PERIOD, staircase(), measured(&clean, 1.0, 7))
        .unwrap()
        .with_sample_phase(0.0005);
    let model = identify(&record, &Options::default()).unwrap();
    let options = FlightModelOptions::default();
    let with = fit(&record, &model, &options).unwrap();
    let without = of_model(&model, &options).unwrap();
    assert_eq!((with.order, without.order), (2, 2));
    assert!(without.is_consistent());
    for (a, b) in [
        (with.gain, without.gain),
        (with.delay_s, without.delay_s),
        (with.omega_rad_s.unwrap(), without.omega_rad_s.unwrap()),
        (with.damping.unwrap(), without.damping.unwrap()),
    ] {
        // What is left of the response after N samples is less than a tenth of what noise does.
        let width = a.upper.unwrap() - a.lower.unwrap();
        let difference = (a.value.unwrap() - b.value.unwrap()).abs();
        assert!(difference < 0.1 * width, "{a:?} {b:?}");
    }
}

#[test]
fn the_order_is_that_of_the_servo() {
    let first = Linear::second_order(1.0, 0.0255, 1.0 + 1e-9, 1e4).with_lag(0.015);
    let third = Linear::second_order(1.0, 0.0255, 0.6, 70.0).with_lag(0.008);
    let second = Linear::second_order(1.0, 0.0255, 0.9, 60.0);
    // From the fit of second order, which takes lag and pair for two real poles, the search goes astray.
    let slow_lag = Linear::second_order(1.0, 0.0055, 0.5, 80.0).with_lag(0.04);
    for (servo, order) in [(first, 1), (second, 2), (third, 3), (slow_lag, 3)] {
        let clean = servo.respond(&staircase(), -5.0, 0.0);
        let found = flight(&clean, 151, Frequencies::Auto, 0.0, 5);
        assert_eq!(found.order, order, "{:?}", found.tried);
        assert!(!found.approximation);
        assert!(found.largest_error_percent < 1.0);
    }
}

#[test]
fn a_nonlinear_servo_gives_an_approximation_that_says_so() {
    let clean = limited(0.5, 60.0, Limit::Rate(180.0, 180.0), &staircase(), -5.0);
    let (model, found) = with_response(&clean, 151, Frequencies::Auto, 0.0, 5);
    assert!(found.approximation && found.inflation > 10.0);
    assert!(found.statement.contains("approximation") && found.statement.contains("20.0 ms"));
    // It rests where the response does, whatever shape is fitted to the way there.
    assert_eq!(Some(found.transfer.gain), model.metrics.dc_gain.value);
    assert_eq!(found.gain.value, model.metrics.dc_gain.value);
    assert!(found.largest_error_percent > 0.5);
    // By how much its parameters are off, nothing shows.
    assert_eq!(found.bounds.withdrawn(), Some(Reason::OrderRejected));
    assert_eq!(found.delay_s.lower.or(found.delay_s.upper), None);
    let json = serde_json::to_string(&found).unwrap();
    assert_eq!(
        serde_json::from_str::<FlightModel>(&json).unwrap().order,
        found.order
    );
}

/// Of a servo that no order fits, the third has a lag of a fraction of a microsecond, and is the second.
#[test]
fn no_pole_is_so_fast_that_no_sample_shows_it() {
    let limit = Limit::Rate(120.0, 120.0);
    let clean = limited(1.5, 60.0, limit, &staircase(), -5.0);
    let record = Record::of_run(PERIOD, staircase(), measured(&clean, 1.0, 5)).unwrap();
    let options = Options {
        settling: Settling::Samples(201),
        ..Options::default()
    };
    let model = identify(&record, &options).unwrap();
    // None is good enough, so that the last one is taken.
    let options = FlightModelOptions {
        largest_error_percent: 0.0,
        ..FlightModelOptions::default()
    };
    for found in [fit(&record, &model, &options), of_model(&model, &options)] {
        let found = found.unwrap();
        let second = found.order == 2 && found.lag_s.is_none();
        assert!(second && found.is_consistent(), "{:?}", found.transfer);
    }
}

/// A lag of 5 ms that noise hides looks like a delay that is longer by as much, and the order without it has other poles, too.
#[test]
fn intervals_hold_a_servo_whose_last_pole_does_not_show() {
    let servo = Linear::second_order(1.0, 0.0105, 0.8, 60.0).with_lag(0.005);
    let clean = servo.respond(&staircase(), -5.0, 0.0);
    let of_seed = |seed: u64| {
        let record = Record::of_run(PERIOD, staircase(), measured(&clean, 8.0, seed)).unwrap();
        let options = Options {
            settling: Settling::Samples(151),
            ..Options::default()
        };
        let model = identify(&record, &options).unwrap();
        fit(&record, &model, &FlightModelOptions::default()).unwrap()
    };
    let all: Vec<FlightModel> = (0..24).into_par_iter().map(of_seed).collect();
    let lower: Vec<_> = all
        .iter()
        .filter(|found| found.order == 2 && !found.approximation)
        .collect();
    assert!(lower.len() >= 12, "{}", lower.len());
    for found in &lower {
        assert!(
            found
                .statement
                .contains("does not distinguish it from a servo of more poles")
        );
    }
    let missed = |found: &&FlightModel| {
        let known = found.delay_s.upper.is_some();
        known && !(found.delay_s.contains(0.0105) && found.gain.contains(1.0))
    };
    let missed = lower.iter().copied().filter(missed).count();
    assert!(missed <= 1, "{missed} of {}", lower.len());
    let known = lower.iter().filter(|found| found.delay_s.upper.is_some());
    assert!(known.count() >= lower.len() / 2);
}

/// Student's t for two degrees of freedom at 99 % is 9.92. The order takes its gain from all of the response, and averages noise there, and not the gains of the runs.
#[test]
fn the_gain_of_an_order_is_no_surer_than_the_gains_of_its_runs() {
    let gains = [0.94, 0.97, 1.0];
    let runs = gains.iter().zip(0..).map(|(gain, seed)| {
        let clean = Linear::second_order(*gain, 0.0255, 0.5, 60.0).respond(&staircase(), -5.0, 0.0);
        Run::new(staircase(), measured(&clean, 0.3, seed)).unwrap()
    });
    let record = Record::new(PERIOD, runs.collect()).unwrap();
    let model = identify(&record, &Options::default()).unwrap();
    let options = FlightModelOptions::default();
    let of_scatter = 9.92 * 0.03 / 3f64.sqrt();
    for found in [fit(&record, &model, &options), of_model(&model, &options)] {
        let gain = found.unwrap().gain;
        let half = (gain.upper.unwrap() - gain.lower.unwrap()) / 2.0;
        assert!(
            half > 0.97 * of_scatter,
            "{half}, {of_scatter} by the gains"
        );
    }
}
