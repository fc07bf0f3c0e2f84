//! Servos that are not linear are distinguished from those that are, and the bounds follow.

use rand::RngExt;
use rayon::prelude::*;
use servoid_dynamics::{DriveLimit, Friction, Grid, ServoParameters, Start, simulate};
use servoid_identification::results::{Advice, Check, Model, Reason};
use servoid_identification::thresholds::MISFIT_SIGNIFICANCE;
use servoid_identification::{Options, Record, Run, Settling, identify};

use servoid_test_support::plants::{normal, random};
use servoid_test_support::servos::{
    Limit, Linear, PERIOD, limited, measured, sizes, staircase, stairs,
};

fn identified(input: &[f64], clean: &[f64], seed: u64) -> Model {
    let record = Record::of_run(PERIOD, input, measured(clean, 1.0, seed)).unwrap();
    identify(&record, &Options::default()).unwrap()
}

/// Random levels, each held for `hold` samples, 3600 samples in all. `level` makes them of numbers from 0 to 1: the high bits of a
/// linear congruential generator (Knuth's MMIX).
fn random_levels(hold: usize, level: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut state = 11u64;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        level((state >> 32) as f64 / f64::from(u32::MAX))
    };
    (0..3600 / hold)
        .flat_map(|_| std::iter::repeat_n(next(), hold))
        .collect()
}

/// Of ±5.
fn random_steps(hold: usize) -> Vec<f64> {
    random_levels(hold, |uniform| if uniform > 0.5 { 5.0 } else { -5.0 })
}

#[test]
#[ignore = "many seeds: cargo test -p servoid-identification --test integration -- --ignored linearity"]
fn linear_servos_pass_as_often_as_the_level_says() {
    let servo = Linear::second_order(0.97, 0.0255, 0.5, 60.0);
    let inputs = [
        staircase(),
        random_steps(10),
        stairs(&[-6.0, -2.0, 2.0, 6.0], 3, 150),
    ];
    let p: Vec<f64> = inputs
        .par_iter()
        .flat_map_iter(|input| (0..16u64).map(move |seed| (input, seed)))
        .map(|(input, seed)| {
            let model = identified(input, &servo.respond(input, input[0], 0.0), seed);
            let withdrawn = model.bounds.withdrawn();
            assert!(
                withdrawn.is_none() && model.linear,
                "{seed}: {withdrawn:?}, {:?}",
                model.advice
            );
            model.residuals.linearity_p.unwrap()
        })
        .collect();
    let below = |level: f64| p.iter().filter(|p| **p < level).count();
    // Of 48 runs, 4.8 should be below 0.1 and 24 below 0.5 at most, and, as p is twice the smaller of two that go together, half as many at
    // least: three standard deviations, 2.1, 3.5 and 3, to each side.
    assert!(below(0.1) <= 11, "{} below 0.1", below(0.1));
    assert!((3..=34).contains(&below(0.5)), "{} below 0.5", below(0.5));
    assert_eq!(below(MISFIT_SIGNIFICANCE), 0);
}

#[test]
fn a_limited_speed_under_held_steps_is_said_and_bounds_keep_their_level() {
    let (input, limit) = (sizes(1.0, 150), Limit::Rate(100.0, 100.0));
    let model = identified(&input, &limited(0.7, 60.0, limit, &input, input[0]), 3);
    assert!(!model.linear, "{:?} {:?}", model.residuals, model.advice);
    let withdrawn = model.bounds.withdrawn();
    assert!(withdrawn.is_none(), "{withdrawn:?}");
    // Not longer than a hold: later is the answer to the next step.
    assert!(model.structure.settling_samples <= 150);
}

#[test]
fn a_stop_that_one_outer_level_of_stairs_lies_beyond_takes_the_level_and_is_open() {
    let input = stairs(&[-6.0, -3.0, 0.0, 3.0, 6.0], 4, 150);
    let limit = Limit::Clip(-4.5, 6.5);
    let model = identified(&input, &limited(0.7, 60.0, limit, &input, input[0]), 3);
    assert!(!model.linear);
    assert_eq!(model.bounds.withdrawn(), Some(Reason::TravelEndOpen));
}

/// The speed of such a servo over one row of 2 ms is what the noise has left in the response: p was above 1 % in three of these four.
#[test]
fn a_limited_speed_is_seen_in_noise_of_three_percent_of_the_strokes() {
    for seed in 0..4 {
        let mut random = random(seed);
        let levels: Vec<f64> = (0..40).map(|_| random.random_range(-5.0..5.0)).collect();
        let input: Vec<f64> = levels.iter().flat_map(|level| [*level; 150]).collect();
        let limit = Limit::Rate(80.0, 80.0);
        let clean = limited(0.9, 46.0, limit, &input, input[0]);
        let output: Vec<f64> = clean
            .iter()
            .map(|y| y + 0.3 * normal(&mut random))
            .collect();
        let record = Record::of_run(PERIOD, &input, output).unwrap();
        let model = identify(&record, &Options::default()).unwrap();
        let residuals = &model.residuals;
        assert!(!model.linear, "{seed}: {residuals:?}");
    }
}

/// A servo of 45 rad/s that friction holds up to `resting_error` degrees off its target.
fn with_friction(resting_error: f64, input: &[f64]) -> Vec<f64> {
    let stiffness = 45.0 * 45.0;
    let servo = ServoParameters {
        delay_s: 0.012,
        friction: Some(Friction {
            coulomb: resting_error * stiffness,
            of_gears: 0.0,
            at_rest: None,
        }),
        ..ServoParameters::linear(stiffness, 72.0)
    };
    let (grid, start) = (
        Grid::new(PERIOD, 0.0, 1e-4),
        Start::at_rest(input[0], Some(input[0])),
    );
    let mut output = Vec::new();
    simulate(&servo, &grid, &start, input, |_, y| output.push(y));
    output
}

/// A motor that comes to 156 degrees a second by and by, under levels that change before it has come to them: a noise model of the highest order predicts its errors, and
/// behind that no function of the motion shows in the noise of the sensor. More than half of such records were called linear.
#[test]
fn a_limited_speed_that_the_noise_model_hides_takes_the_level() {
    let servo = ServoParameters {
        delay_s: 0.0224,
        limit: Some(DriveLimit {
            up: 3271.0,
            down_to_up: 1.0,
            motor_damping: 20.9,
            at_one_stiffness: false,
        }),
        ..ServoParameters::linear(1563.0, 61.8)
    };
    (0..6u64).into_par_iter().for_each(|seed| {
        let mut random = random(seed);
        let mut input = vec![0.0; 300];
        while input.len() < 6000 {
            let hold = random.random_range(55..165);
            let level = random.random_range(-40.0..40.0);
            input.extend(std::iter::repeat_n(level, hold));
        }
        input.truncate(6000);
        let (grid, start) = (Grid::new(PERIOD, 0.0, 1e-4), Start::at_rest(0.0, Some(0.0)));
        let mut output = Vec::new();
        simulate(&servo, &grid, &start, &input, |_, y| output.push(y));
        for y in &mut output {
            *y += 0.089 * normal(&mut random);
        }
        let record = Record::of_run(PERIOD, &input, output).unwrap();
        let model = identify(&record, &Options::default()).unwrap();
        let withdrawn = model.bounds.withdrawn();
        assert!(!model.linear, "{seed}: {:?}", model.residuals);
        assert_eq!(withdrawn, Some(Reason::ErrorsNotNoise), "{seed}");
    });
}

/// A noise model takes the error at rest for drift, unless it is shown which way the servo came.
#[test]
fn friction_under_strokes_of_many_sizes_is_seen() {
    let input = random_levels(120, |uniform| 40.0 * uniform - 20.0);
    let model = identified(&input, &with_friction(0.3, &input), 5);
    assert!(!model.linear, "{:?} {:?}", model.residuals, model.advice);
    let frictionless = identified(&input, &with_friction(0.0, &input), 5);
    assert!(frictionless.linear, "{:?}", frictionless.residuals);
}

#[test]
#[ignore = "many seeds: cargo test -p servoid-identification --test integration -- --ignored linearity"]
fn a_limited_servo_under_short_random_steps_gets_no_level() {
    let input = random_steps(10);
    let clean = limited(0.7, 60.0, Limit::Rate(100.0, 100.0), &input, input[0]);
    for seed in 0..4 {
        let model = identified(&input, &clean, seed);
        assert!(
            model.bounds.valid().is_none(),
            "{:?} {:?}",
            model.fit,
            model.residuals
        );
    }
}

/// Stairs of equal holds over `levels`, again and again, 6000 samples in all.
fn equal_holds(levels: &[f64], hold: usize) -> Vec<f64> {
    let held = levels
        .iter()
        .flat_map(|level| std::iter::repeat_n(*level, hold));
    held.cycle().take(6000).collect()
}

/// The motion of a servo behind gears with this much play.
fn behind_play(motion: &[f64], play: f64) -> Vec<f64> {
    let mut output = motion[0];
    let mut follow = |angle: &f64| {
        output = output.clamp(angle - play / 2.0, angle + play / 2.0);
        output
    };
    motion.iter().map(&mut follow).collect()
}

#[test]
fn play_under_equal_holds_is_no_late_part_of_the_response() {
    let servo = Linear::second_order(1.0, 0.012, 0.8, 40.0);
    let up_and_down = [0.0, 1.0, 2.0, 1.0, 0.0, -1.0, -2.0, -1.0].map(|level| 10.0 * level);
    for hold in [200, 300] {
        let input = equal_holds(&up_and_down, hold);
        let motion = servo.respond(&input, input[0], 0.0);
        let linear = identified(&input, &motion, 1);
        assert!(
            linear.linear && linear.bounds.valid().is_some(),
            "{:?}",
            linear.advice
        );
        for play in [0.9, 1.2, 2.0] {
            let model = identified(&input, &behind_play(&motion, play), 2);
            let withdrawn = model.bounds.withdrawn();
            assert_eq!(withdrawn, Some(Reason::ErrorsNotNoise), "{hold} {play}");
            let says =
                (model.advice.iter()).any(|advice| advice.finding.contains("moves again by"));
            assert!(says, "{hold} {play}: {:?}", model.advice);
            assert!(model.structure.settling_samples <= hold);
        }
    }
}

/// Five runs of one order repeat what a linear model lacks, which then passes for a late part of the response.
#[test]
fn a_stated_settling_time_beyond_the_holds_of_a_limited_servo_gets_no_level() {
    let (input, hold) = (sizes(1.0, 150), 150);
    let of = |clean: &[f64], settling: usize| {
        let run = |seed| {
            Run::new(input.clone(), measured(clean, 1.0, seed))
                .map(|run| run.with_input_at_rest(input[0]))
        };
        let runs = (0..5).map(|seed| run(seed).unwrap()).collect();
        let record = Record::new(PERIOD, runs).unwrap();
        let settling = Settling::Samples(settling);
        identify(
            &record,
            &Options {
                settling,
                ..Options::default()
            },
        )
        .unwrap()
    };
    let limit = Limit::Rate(100.0, 100.0);
    let clean = limited(0.7, 60.0, limit, &input, input[0]);
    let within = of(&clean, hold - 1);
    assert!(!within.linear && within.bounds.valid().is_some());
    let beyond = of(&clean, 401);
    assert_eq!(beyond.bounds.withdrawn(), Some(Reason::ErrorsNotNoise));
    let says = |advice: &Advice| advice.finding.contains("401 samples that was stated");
    assert!(beyond.advice.iter().any(says), "{:?}", beyond.advice);
    let linear = Linear::second_order(1.0, 0.012, 0.8, 40.0);
    let linear = of(&linear.respond(&input, input[0], 0.0), 401);
    assert!(linear.linear && linear.bounds.valid().is_some());
}

/// These holds end while the servo rings, and after them there is more motion than before.
#[test]
fn a_response_under_way_at_the_end_of_a_hold_does_not_move_again() {
    for (seed, damping, hold) in [(0, 0.2, 50), (3, 0.35, 30), (4, 0.4, 60)] {
        let mut random = random(seed);
        let mut level = || if random.random_bool(0.5) { 5.0 } else { -5.0 };
        let input: Vec<f64> = (0..9000 / hold)
            .flat_map(|_| std::iter::repeat_n(level(), hold))
            .collect();
        let servo = Linear::second_order(1.0, 0.008, damping, 42.5);
        let model = identified(&input, &servo.respond(&input, input[0], 0.0), seed);
        assert!(model.linear, "{damping}, {hold}: {:?}", model.advice);
        assert_eq!(model.bounds.withdrawn(), None, "{damping}, {hold}");
    }
}

/// Strokes upwards take longer than downwards, and all holds are equal: the errors have the rate of the holds, where the reference has no
/// line. They are the servo's, and no hum.
#[test]
fn errors_at_the_rate_of_equal_holds_are_no_hum() {
    for seed in 0..3 {
        let mut random = random(seed);
        let levels = [0.0, 10.0, 20.0, 10.0, 0.0, -10.0, -20.0, -10.0];
        let input: Vec<f64> = (0..4000).map(|k| levels[k / 80 % 8]).collect();
        let mut angle = 0.0;
        let output: Vec<f64> = input
            .iter()
            .map(|command| {
                let seen = angle + 0.02 * normal(&mut random);
                angle += (command - angle) / if *command > angle { 9.0 } else { 5.0 };
                seen
            })
            .collect();
        let record = Record::of_run(0.01, input, output).unwrap();
        let model = identify(&record, &Options::default()).unwrap();
        let is_hum = |item: &Advice| item.check == Check::Hum;
        assert!(
            !model.advice.iter().any(is_hum),
            "seed {seed}: {:?}",
            model.advice
        );
        assert!(!model.linear, "seed {seed}: {:?}", model.residuals);
    }
}
