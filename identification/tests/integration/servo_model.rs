//! Linear models beside the servo model, on parts of the record that each has not seen.

use servoid_identification::nonlinear::split_by_direction;
use servoid_identification::results::{Model, Reason};
use servoid_identification::servo_model::{
    LinearKind, QuantityKind, ServoModel, ServoModelOptions, Terms, fit, fit_beside,
};
use servoid_identification::{Frequencies, NoiseOrder, Options, Record, Run, Settling, identify};
use servoid_test_support::servos::{Limit, Linear, PERIOD, limited, measured, sizes};

/// Strokes of five sizes, with holds of 240 ms.
fn command() -> Vec<f64> {
    sizes(1.0, 120)
}

fn both(record: &Record) -> (Model, ServoModel) {
    let linear = identify(record, &Options::default()).unwrap();
    let servo = fit_beside(record, &linear, &ServoModelOptions::default(), &()).unwrap();
    (linear, servo)
}

/// What a linear model beside `servo` predicts \[%\].
fn percent(servo: &ServoModel, kind: LinearKind) -> f64 {
    let found = servo.linear_models.as_ref().unwrap();
    let model = found.models.iter().find(|model| model.kind == kind);
    model.unwrap().held_out_percent
}

/// A linear servo of second order, which had stood at 0.
fn second_order() -> Record<'static> {
    let servo = Linear::second_order(0.97, 0.0213, 0.7, 50.0);
    let input = command();
    let output = measured(&servo.respond(&input, 0.0, 0.0), 1.0, 1);
    let run = Run::new(input, output).unwrap().with_input_at_rest(0.0);
    Record::new(PERIOD, vec![run]).unwrap()
}

#[test]
fn a_linear_servo_is_predicted_as_well_by_the_linear_model() {
    let (_, servo) = both(&second_order());
    let found = servo.linear_models.as_ref().unwrap();
    let rung = servo
        .ladder
        .iter()
        .find(|rung| rung.terms == Terms::default());
    let rung = rung.unwrap().held_out_percent;
    // The linear model has many more parameters, whose noise costs a little.
    assert!(
        percent(&servo, LinearKind::Linear) > rung - 1.0,
        "{found:?}"
    );
    assert_eq!(found.samples_used, servo.fit.samples_used);
    // The ladder takes one step from the fit to the whole record, and the comparison fits again.
    assert!(
        (found.servo_model_percent - servo.fit.held_out_percent).abs() < 0.05,
        "{found:?}"
    );
    assert_eq!(servo.better_linear_percent(), None);
}

/// The folds as `docs/servo-model.md` has them, the linear model by the whole identification, and one sum over all samples.
#[test]
fn what_the_linear_model_has_not_seen_is_left_out_in_fact() {
    let record = second_order();
    let (linear, servo) = both(&record);
    let run = &record.runs()[0];
    let output = run.output();
    let length = output.len().div_ceil(output.len() / (output.len() / 32));
    let fold = |k: usize| {
        let block = k / length;
        (block % 4 + block / 4 % 4 + block / 16 % 4) % 4
    };
    let structure = linear.structure;
    let options = Options {
        settling: Settling::Samples(structure.settling_samples),
        frequencies: Frequencies::Count(structure.frequencies),
        noise_order: NoiseOrder::Order(structure.noise_order),
        ..Options::default()
    };
    let mean = output.iter().sum::<f64>() / output.len() as f64;
    let spread: f64 = output.iter().map(|y| (y - mean).powi(2)).sum();
    let clip = 0.5 * (spread / output.len() as f64).sqrt();
    let mut error = 0.0;
    for left_out in 0..4 {
        let seen: Vec<f64> = (0..output.len())
            .map(|k| {
                if fold(k) == left_out {
                    f64::NAN
                } else {
                    output[k]
                }
            })
            .collect();
        let left = Run::new(run.input(), seen).unwrap().with_input_at_rest(0.0);
        let left = identify(&Record::new(PERIOD, vec![left]).unwrap(), &options).unwrap();
        assert_eq!(left.structure.noise_order, structure.noise_order);
        let predicted = left.simulate(run);
        for k in (0..output.len()).filter(|k| fold(*k) == left_out) {
            let e = output[k] - predicted[k];
            assert!(e.abs() < clip, "no error of a linear servo is clipped");
            error += e * e;
        }
    }
    let slow = 100.0 * (1.0 - (error / spread).sqrt());
    let found = percent(&servo, LinearKind::Linear);
    // The noise model comes to rest within a thousandth of its standard deviation, from another start.
    assert!((found - slow).abs() < 1e-3, "{found} {slow}");
}

/// Beside it, a run that is not said to begin at rest, but does.
#[test]
fn a_limited_servo_is_predicted_better_by_the_servo_model() {
    let input = command();
    let clean = limited(0.7, 60.0, Limit::Rate(150.0, 100.0), &input, 0.0);
    let record = Record::of_run(PERIOD, input, measured(&clean, 1.0, 2)).unwrap();
    let (_, servo) = both(&record);
    let found = servo.linear_models.as_ref().unwrap();
    assert_eq!(found.samples_used, servo.fit.samples_used);
    let [linear, split] =
        [LinearKind::Linear, LinearKind::DirectionSplit].map(|kind| percent(&servo, kind));
    // Two directions are half of what this servo is; the sizes of the strokes are the other half.
    assert!(
        linear < split && split < found.servo_model_percent,
        "{found:?}"
    );
    assert_eq!(servo.better_linear_percent(), None);
}

/// A lag in series that the equation of the servo model lacks; the record begins in the middle of a stroke.
#[test]
fn a_servo_that_the_equation_lacks_is_better_described_by_the_linear_model() {
    let servo = Linear::second_order(0.97, 0.0213, 0.3, 60.0).with_lag(0.03);
    let input = command();
    let output = measured(&servo.respond(&input, 0.0, 0.0), 0.3, 3);
    let from = 120 + 30;
    let record = Record::of_run(PERIOD, &input[from..], &output[from..]).unwrap();
    let (linear, servo) = both(&record);
    let found = servo.linear_models.as_ref().unwrap();
    let better = servo.better_linear_percent();
    assert_eq!(
        better,
        Some(percent(&servo, LinearKind::Linear)),
        "{found:?}"
    );
    // The direction-split model needs the input before its history, to know its change.
    let history = linear.structure.settling_samples;
    assert_eq!(found.samples_used, servo.fit.samples_used - history);
}

#[test]
fn the_direction_split_model_simulates_as_it_was_fitted() {
    let record = second_order();
    let linear = identify(&record, &Options::default()).unwrap();
    let split = split_by_direction(&record, &linear).unwrap();
    let run = &record.runs()[0];
    let simulated = split.simulate(run);
    // The fit has rows from the ninth sample on: noise of order 8 at the most.
    let (y, simulated) = (&run.output()[8..], &simulated[8..]);
    let mean = y.iter().sum::<f64>() / y.len() as f64;
    let spread: f64 = y.iter().map(|y| (y - mean).powi(2)).sum();
    let error: f64 = y.iter().zip(simulated).map(|(y, s)| (y - s).powi(2)).sum();
    let percent = 100.0 * (1.0 - (error / spread).sqrt());
    // Sums of squares and of products differ by rounding.
    assert!(
        (percent - split.simulation_percent).abs() < 1e-6,
        "{percent}"
    );
}

/// A servo of second order with 50 rad/s and a damping ratio of 0.7, 21.3 ms late, whose shaft stops at `stop` and stands there until it is driven back.
fn up_to(stop: f64, command: &[f64]) -> Vec<f64> {
    const STEPS: usize = 40;
    let step_s = PERIOD / STEPS as f64;
    let late = (0.0213 / step_s).round() as usize;
    let (mut angle, mut speed, mut output) = (0.0, 0.0, Vec::new());
    for step in 0..command.len() * STEPS {
        if step % STEPS == 0 {
            output.push(angle);
        }
        let command = step
            .checked_sub(late)
            .map_or(0.0, |since| command[since / STEPS]);
        speed += step_s * (2500.0 * (command - angle) - 70.0 * speed);
        angle += step_s * speed;
        if angle > stop {
            (angle, speed) = (stop, 0.0);
        }
    }
    output
}

/// Three runs of unlike length, whose sensor's zeros are 0.4, -0.5 and 1.6 further up: the mean is 0.5, each run once; by samples it would be -0.01. The
/// servo stops at `stop` where the zero is 0.
fn runs_of_unlike_length(stop: f64) -> Record<'static> {
    let run = |(index, (repeats, zero)): (u64, (usize, f64))| {
        let command = sizes(1.0, 60).repeat(repeats);
        let output: Vec<f64> = up_to(stop, &command).iter().map(|y| y + zero).collect();
        let output = measured(&output, 1.0, 40 + index);
        Run::new(command, output).unwrap().with_input_at_rest(0.0)
    };
    let runs = (0..).zip([(1, 0.4), (3, -0.5), (1, 1.6)]).map(run);
    Record::new(PERIOD, runs.collect()).unwrap()
}

#[test]
fn linear_model_servo_model_and_stop_have_one_common_offset() {
    let (linear, servo) = both(&runs_of_unlike_length(f64::INFINITY));
    assert!((linear.offset - 0.5).abs() < 0.02, "{}", linear.offset);
    let offset = servo.quantity(QuantityKind::Offset).unwrap().value;
    assert!((offset - 0.5).abs() < 0.02, "{offset}");
    for (found, zero) in servo.run_offsets.iter().zip([0.4, -0.5, 1.6]) {
        assert!((found - (zero - 0.5)).abs() < 0.02, "{found} {zero}");
    }
    let (linear, servo) = both(&runs_of_unlike_length(3.0));
    assert!((linear.stops[0] - 3.5).abs() < 0.05, "{:?}", linear.stops);
    // Apart by rounding alone: the linear model has the offsets of the runs taken out before.
    let apart = servo.stops.upper.unwrap() - linear.stops[0];
    assert!(apart.abs() < 1e-9, "{apart}");
    for (found, zero) in servo.run_offsets.iter().zip([0.4, -0.5, 1.6]) {
        assert!((found - (zero - 0.5)).abs() < 0.05, "{found} {zero}");
    }
}

/// A motion that never rests: nothing shows the stop but that crests under different commands are level.
#[test]
fn a_stop_is_found_where_the_servo_never_rests() {
    let wave = |t: f64| (9.0 * t).sin() + (13.7 * t + 1.0).sin() + (5.3 * t).sin();
    let command: Vec<f64> = (0..4000)
        .map(|k| 3.0 * wave(f64::from(k) * PERIOD))
        .collect();
    let found = |stop: f64| {
        let output = measured(&up_to(stop, &command), 1.0, 7);
        let run = Run::new(command.clone(), output)
            .unwrap()
            .with_input_at_rest(0.0);
        let record = Record::new(PERIOD, vec![run]).unwrap();
        fit(&record, &ServoModelOptions::default()).unwrap()
    };
    let stopped = found(4.0);
    // To a step of the sensor.
    assert!(
        (stopped.stops.upper.unwrap() - 4.0).abs() < 150.0 / 4096.0,
        "{:?}",
        stopped.stops
    );
    assert_eq!(stopped.stops.lower, None);
    assert_eq!(stopped.covariance.withdrawn(), Some(Reason::TravelEnd));
    let delay = stopped.quantity(QuantityKind::Delay).unwrap().value;
    assert!((delay - 0.0213).abs() < 0.002, "{delay}");
    assert!(found(f64::INFINITY).stops.are_none());
}
