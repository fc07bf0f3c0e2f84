//! Outputs that drift, and outputs that have no end.

use rand::RngExt;
use rand_distr::StandardNormal;
use servoid_identification::comparison::{ComparisonOptions, compare};
use servoid_identification::results::{Check, Model, Reason, Withheld};
use servoid_identification::{Detrend, Error, Options, Record, Run, identify, identify_explained};
use servoid_test_support::drifting_servos::{Beside, Command, Course, DriftingServo, Motion};
use servoid_test_support::plants::{Noise, PERIOD, Plant, random, simulate, staircase};

fn options(detrend: Detrend) -> Options {
    Options {
        longest_settling: Some(301),
        detrend,
        ..Options::default()
    }
}

/// A recording whose output drifts by `change` from its beginning to its end.
fn drifting(change: f64, noise: Noise, seed: u64) -> Record<'static> {
    let input = staircase();
    let output = simulate(Plant::A, noise, &input, 1.0, &mut random(seed));
    let samples = output.len() as f64;
    let output: Vec<f64> = (0..)
        .zip(output)
        .map(|(k, y)| y + change * f64::from(k) / samples)
        .collect();
    Record::of_run(PERIOD, input, output).unwrap()
}

fn holds(model: &Model) -> bool {
    let whole = &model.step.bounds.valid().unwrap().simultaneous;
    let truth = Plant::A.step(whole.lower.len());
    (whole.lower.iter().zip(&whole.upper).zip(&truth)).all(|((l, u), t)| l <= t && t <= u)
}

#[test]
fn a_drift_is_taken_out_and_named_and_bounds_hold() {
    let mut inside = 0;
    for (seed, change) in (20..).zip([1.0, 3.0, 10.0, -5.0]) {
        for noise in [Noise::White, Noise::Ar2] {
            let found = identify_explained(&drifting(change, noise, seed), &options(Detrend::Auto))
                .unwrap();
            let [drift] = found.explanation.drift[..] else {
                panic!("{change} {noise:?}: {:?}", found.explanation.drift);
            };
            // The slope's standard deviation over the run is below 0.02 in these noises.
            assert!((drift - change).abs() < 0.1, "{drift} of {change}");
            let advice = &found.model.advice;
            assert!(advice.iter().any(|found| found.check == Check::Drift));
            assert!(!advice.iter().any(|found| found.check == Check::ModelError));
            inside += usize::from(holds(&found.model));
        }
    }
    // Eight curves at 99 %: two outside happen once in 400 times.
    assert!(inside >= 7, "{inside} of 8");
}

/// The rests of such sides differ for their drift alone.
#[test]
fn a_comparison_names_the_drift_of_a_side() {
    let sides = [3.0, -3.0].map(|change| drifting(change, Noise::White, 27));
    let found = compare(&sides[0], &sides[1], &ComparisonOptions::default()).unwrap();
    let drifts = found
        .advice
        .iter()
        .filter(|found| found.check == Check::Drift);
    assert_eq!(drifts.count(), 2);
}

/// Runs that drift each in its own way are known as well as those that drift alike.
#[test]
fn each_run_has_a_slope_of_its_own() {
    let identified = |changes: [f64; 3]| {
        let runs = (25..).zip(changes.into_iter().zip([0.0, 5.0, -7.0]));
        let runs = runs.map(|(seed, (change, offset))| {
            let record = drifting(change, Noise::White, seed);
            let run = &record.runs()[0];
            let output: Vec<f64> = run.output().iter().map(|y| y + offset).collect();
            Run::new(run.input().to_vec(), output).unwrap()
        });
        let record = Record::new(PERIOD, runs.collect()).unwrap();
        identify_explained(&record, &options(Detrend::Auto)).unwrap()
    };
    let (unlike, alike) = (identified([3.0, -4.0, 6.0]), identified([3.0; 3]));
    for (found, change) in unlike.explanation.drift.iter().zip([3.0, -4.0, 6.0]) {
        // As above, with an offset beside each slope.
        assert!((found - change).abs() < 0.1, "{found} of {change}");
    }
    let half = |model: &Model| {
        let whole = &model.step.bounds.valid().unwrap().simultaneous;
        let halves = whole.upper.iter().zip(&whole.lower).map(|(u, l)| u - l);
        halves.fold(0.0, f64::max)
    };
    // The noise is the same; slopes that are not all taken out would widen the bounds threefold.
    let (unlike, alike) = (&unlike.model, &alike.model);
    assert!(half(unlike) < 1.1 * half(alike));
    assert!(holds(unlike));
    let checks: Vec<&Check> = unlike.advice.iter().map(|found| &found.check).collect();
    assert!(!checks.contains(&&Check::Whiteness), "{checks:?}");
}

#[test]
fn nothing_is_taken_out_where_nothing_drifts_or_nothing_may() {
    for seed in 30..36 {
        let noise = [Noise::White, Noise::Ar1, Noise::Ar2][seed as usize % 3];
        let record = drifting(0.0, noise, seed);
        let found = identify_explained(&record, &options(Detrend::Auto)).unwrap();
        assert!(found.explanation.drift.is_empty(), "{seed}");
    }
    let record = drifting(3.0, Noise::White, 40);
    let found = identify_explained(&record, &options(Detrend::None)).unwrap();
    assert!(found.explanation.drift.is_empty());
    let found = identify_explained(&drifting(0.0, Noise::White, 41), &options(Detrend::Linear));
    let found = found.unwrap();
    assert!(found.explanation.drift[0].abs() < 0.1);
    assert!(holds(&found.model));
}

#[test]
fn an_integrator_is_named() {
    let input = staircase();
    let mut sum = 0.0;
    let speed = simulate(Plant::A, Noise::White, &input, 0.1, &mut random(50));
    let output: Vec<f64> = speed
        .iter()
        .map(|v| {
            sum += 0.02 * v;
            sum
        })
        .collect();
    let record = Record::of_run(PERIOD, input, output).unwrap();
    let model = identify(&record, &options(Detrend::Auto)).unwrap();
    let checks: Vec<&Check> = model.advice.iter().map(|found| &found.check).collect();
    assert_eq!(checks[0], &Check::SlowServo, "{checks:?}");
    assert_eq!(model.bounds.withdrawn(), Some(Reason::ResponseNotOver));
    assert!(model.metrics.dc_gain.value.is_none());
}

/// A gain that falls evenly, or at once; and one that does not change, beside noise that does.
#[test]
fn a_gain_that_changes_along_the_record_takes_the_level() {
    let sound = DriftingServo::default();
    let falls = |change, course| DriftingServo {
        change,
        course,
        ..sound
    };
    let louder = DriftingServo {
        beside: Beside::LateNoise(10.0),
        ..sound
    };
    for (servo, reason) in [
        (falls(-0.04, Course::Evenly), Some(Reason::GainDrift)),
        (falls(-0.05, Course::AtOnce(0.6)), Some(Reason::GainDrift)),
        (sound, None),
        (louder, None),
    ] {
        for seed in 70..73 {
            let model = identify(&servo.record(seed), &Options::default()).unwrap();
            assert_eq!(model.bounds.withdrawn(), reason, "{:?}", model.advice);
            assert!(reason.is_none() || model.advice[0].check == Check::GainDrift);
        }
    }
}

/// A lag of four seconds, under levels of two seconds, in rows of which the settling time has three seconds.
#[test]
fn a_slow_servo_is_named_with_its_time_constant() {
    let servo = DriftingServo {
        motion: Motion::Lag(4.0),
        command: Command::Levels(5.0),
        ..DriftingServo::default()
    };
    let record = servo.record(80);
    let model = identify(&record, &Options::default()).unwrap();
    assert_eq!(model.bounds.withdrawn(), Some(Reason::ResponseNotOver));
    assert_eq!(model.advice[0].check, Check::SlowServo);
    let said = &model.advice[0].finding;
    assert!(
        ["3.8 s", "3.9 s", "4.0 s", "4.1 s", "4.2 s"]
            .iter()
            .any(|seconds| said.contains(seconds)),
        "{said}"
    );
    assert_eq!(model.metrics.withheld, Some(Withheld::ResponseNotOver));
}

#[test]
fn swapped_columns_are_refused() {
    let input = staircase();
    let output = simulate(Plant::A, Noise::White, &input, 1.0, &mut random(60));
    let swapped = Record::of_run(PERIOD, output, input).unwrap();
    assert!(matches!(
        identify(&swapped, &Options::default()),
        Err(Error::Swapped { levels: 3 })
    ));
}

/// An encoder of one degree under a sine.
#[test]
fn a_coarse_sensor_is_not_taken_for_a_reference() {
    let input: Vec<f64> = (0..2000)
        .map(|k| 1.2 * (0.02 * f64::from(k)).sin())
        .collect();
    let output: Vec<f64> = input.iter().map(|u| u.round()).collect();
    let record = Record::of_run(PERIOD, input, output).unwrap();
    let found = identify(&record, &options(Detrend::Auto));
    assert!(!matches!(found, Err(Error::Swapped { .. })), "{found:?}");
}

/// Squares of such a motion are zero, so nothing can be computed from it.
#[test]
fn a_motion_near_the_smallest_number_is_none() {
    for scale in [1e-20, 1e-160, 1e-200, 1e-300] {
        let input = staircase();
        let output: Vec<f64> = simulate(Plant::A, Noise::White, &input, 1.0, &mut random(40))
            .into_iter()
            .map(|y| scale * y)
            .collect();
        let refused = Record::of_run(PERIOD, input, output).unwrap_err();
        assert_eq!(refused, Error::ConstantOutput { value: 0.0 }, "{scale}");
    }
}

/// A line is no remedy for a load that changes at one time, nor where it is taken out already.
#[test]
fn a_load_that_changes_once_splits_the_recording_and_asks_for_no_line_that_is_taken_out() {
    let mut random = random(3);
    let levels: Vec<f64> = (0..100).map(|_| random.random_range(-5.0..5.0)).collect();
    let input: Vec<f64> = (0..6000).map(|k| levels[k / 60]).collect();
    let mut lags = [0.0; 2];
    let output: Vec<f64> = (input.iter().zip(0..))
        .map(|(u, k): (&f64, u32)| {
            lags[0] += 0.2 * (u - lags[0]);
            lags[1] += 0.2 * (lags[0] - lags[1]);
            let noise = 0.05 * random.sample::<f64, _>(StandardNormal);
            lags[1] + noise + if k > 2600 { 1.0 } else { 0.0 }
        })
        .collect();
    let record = Record::of_run(0.005, input, output).unwrap();
    let found = identify_explained(&record, &Options::default()).unwrap();
    assert_eq!(found.explanation.drift.len(), 1);
    let advice = &found.model.advice;
    let of = |check: Check| advice.iter().find(|found| found.check == check);
    let errors = of(Check::ModelError).expect("errors that are not noise");
    assert!(
        errors.remedy.starts_with("Look for the drift, and record"),
        "{errors:?}"
    );
    let outliers = of(Check::Outliers).expect("a stretch that is taken out");
    assert!(
        outliers.remedy.contains("Split the recording at 13.0"),
        "{outliers:?}"
    );
}
