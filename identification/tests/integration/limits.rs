//! No limit is found in a linear servo; those that are there are found.

use rand::RngExt;
use rayon::prelude::*;
use servoid_identification::nonlinear::{Limits, RateVerdict};
use servoid_identification::results::Check;
use servoid_identification::{Options, Record, Run, Settling, identify};

use servoid_test_support::plants::random;
use servoid_test_support::servos::{
    Limit, Linear, PERIOD, limited, measured, sizes, staircase, stairs,
};

fn limits_of(input: &[f64], clean: &[f64], settling: usize, seed: u64) -> Limits {
    let record = Record::of_run(PERIOD, input, measured(clean, 1.0, seed)).unwrap();
    let options = Options {
        settling: Settling::Samples(settling),
        ..Options::default()
    };
    Limits::of(
        &record,
        &identify(&record, &options).unwrap(),
        options.level,
    )
}

/// Up and down from -6 to 6 by 2, three times.
fn up_and_down() -> Vec<f64> {
    let levels: Vec<f64> = (-3..=3).map(|k| 2.0 * f64::from(k)).collect();
    stairs(&levels, 3, 150)
}

/// What is said of a stop under levels of up to 6: of the travel's end, and of the high end with its limits.
fn stopped(stop: f64, noise: f64) -> (String, Option<String>) {
    let input = up_and_down();
    let clean = limited(0.7, 60.0, Limit::Clip(-20.0, stop), &input, -6.0);
    let record = Record::of_run(PERIOD, &input, measured(&clean, noise, 5)).unwrap();
    let model = identify(&record, &Options::default()).unwrap();
    let mut advice = model.advice.iter();
    let named = advice.find(|advice| advice.check == Check::TravelEnd);
    let ends = Limits::of(&record, &model, 0.99).ends;
    (
        named.unwrap().finding.clone(),
        ends.map(|[_, high]| high.statement),
    )
}

#[test]
fn a_stop_is_not_claimed_of_one_command() {
    for (stop, noise, end) in [
        (4.6, 0.2, "softens"),
        (4.1, 0.02, "falls short of one command, as at a hard stop"),
    ] {
        let (travel_end, high) = stopped(stop, noise);
        let said = "falls short of one command";
        assert!(travel_end.contains(said), "{travel_end}");
        assert!(!travel_end.contains("The output stops"));
        assert!(high.as_ref().unwrap().contains(end), "{high:?}");
    }
}

/// Three runs of random levels, which end after 0.15 to 0.45 s while a servo rings about where it comes to rest.
fn of_one_that_rings(seed: u64) -> Record<'static> {
    let mut random = random(seed);
    let mut input = vec![0.0; 200];
    while input.len() < 4000 {
        let level = 0.1 * f64::from(random.random_range(-100..=100));
        input.extend(std::iter::repeat_n(level, random.random_range(76..226)));
    }
    let servo = Linear::second_order(1.02, 0.007, 0.45, 55.0);
    let clean = servo.respond(&input, 0.0, 0.0);
    let run = |run: u64| Run::new(input.clone(), measured(&clean, 1.0, 3 * seed + run)).unwrap();
    Record::new(PERIOD, (0..3).map(run).collect()).unwrap()
}

/// A hold that ends early leaves the output as far from its rest as a stop would.
#[test]
fn a_linear_servo_that_rings_is_not_said_to_stop() {
    let stops: Vec<u64> = (0..16)
        .into_par_iter()
        .filter(|seed| {
            let model = identify(&of_one_that_rings(*seed), &Options::default()).unwrap();
            let mut advice = model.advice.iter();
            advice.any(|advice| advice.check == Check::TravelEnd)
        })
        .collect();
    assert!(stops.is_empty(), "{stops:?}");
}

/// The output does not move between 4 and 6: it rests there, though it goes no way.
#[test]
fn two_commands_beyond_a_stop_are_counted() {
    for stop in [3.5, 2.5] {
        let (travel_end, _) = stopped(stop, 0.2);
        let said = "commands from 4 to 6 all end about there (2 of them)";
        assert!(travel_end.contains(said), "{travel_end}");
    }
}

#[test]
fn linear_servos_raise_no_alarm() {
    require_no_alarm(0..2);
}

#[test]
#[ignore = "many seeds: cargo test -p servoid-identification --test integration -- --ignored limits"]
fn linear_servos_raise_no_alarm_with_many_seeds() {
    require_no_alarm(2..8);
}

fn require_no_alarm(seeds: std::ops::Range<u64>) {
    let servos = [
        Linear::second_order(0.97, 0.0255, 0.5, 60.0),
        Linear::second_order(0.97, 0.0255, 0.9, 40.0),
        Linear::second_order(0.97, 0.0255, 0.3, 80.0),
        Linear::second_order(0.97, 0.0255, 0.6, 70.0).with_lag(0.008),
    ];
    let alarms: Vec<String> = servos
        .par_iter()
        .flat_map_iter(|servo| seeds.clone().map(move |seed| (servo, seed)))
        .flat_map_iter(|(servo, seed)| {
            let of = |input: &[f64], rest: f64| {
                limits_of(input, &servo.respond(input, rest, 0.0), 111, seed)
            };
            let strokes = of(&sizes(1.0, 150), 0.0);
            let levels = of(&up_and_down(), -6.0);
            let mut alarms = Vec::new();
            for rate in [strokes.rate_up, strokes.rate_down] {
                if rate.verdict != RateVerdict::Proportional {
                    alarms.push(rate.statement);
                }
            }
            if levels.hysteresis.found != Some(false) {
                alarms.push(levels.hysteresis.statement);
            }
            for end in levels.ends.unwrap() {
                if end.softens != Some(false) {
                    alarms.push(end.statement);
                }
            }
            alarms
        })
        .collect();
    assert!(alarms.is_empty(), "{alarms:#?}");
}

#[test]
fn a_rate_limit_is_found_with_its_figure_for_each_direction() {
    let input = sizes(1.0, 150);
    let limits = limits_of(
        &input,
        &limited(0.5, 60.0, Limit::Rate(150.0, 100.0), &input, 0.0),
        111,
        7,
    );
    for (rate, exact) in [(limits.rate_up, 150.0), (limits.rate_down, 100.0)] {
        assert_eq!(rate.verdict, RateVerdict::Limited, "{}", rate.statement);
        let (lower, upper) = (rate.speed.lower.unwrap(), rate.speed.upper.unwrap());
        // The smallest strokes above the knee spend part of 35-65 % speeding up.
        assert!(
            lower - 0.02 * exact < exact && exact < upper + 0.03 * exact,
            "{lower}..{upper}"
        );
    }
}

#[test]
fn play_is_found_with_its_size_and_stops_with_their_level() {
    let input = up_and_down();
    let play = limits_of(
        &input,
        &limited(0.9, 60.0, Limit::Play(0.3), &input, -6.0),
        111,
        3,
    );
    assert_eq!(play.hysteresis.found, Some(true));
    assert!((play.hysteresis.size.value.unwrap() - 0.3).abs() < 0.02);
    assert!(
        play.ends
            .unwrap()
            .iter()
            .all(|end| end.softens == Some(false))
    );

    let clip = limits_of(
        &input,
        &limited(0.5, 60.0, Limit::Clip(-4.5, 5.0), &input, -6.0),
        111,
        3,
    );
    let [low, high] = clip.ends.unwrap();
    for (end, exact) in [(low, -4.5), (high, 5.0)] {
        assert_eq!(end.softens, Some(true), "{}", end.statement);
        assert!(end.reached.contains(exact), "{:?}", end.reached);
    }
    assert_eq!(
        clip.hysteresis.found,
        Some(false),
        "{}",
        clip.hysteresis.statement
    );
}

#[test]
fn two_levels_do_not_determine_limits_and_say_what_to_record() {
    let input = staircase();
    let limits = limits_of(
        &input,
        &limited(0.5, 60.0, Limit::Play(0.5), &input, -5.0),
        111,
        1,
    );
    assert_eq!(limits.rate_up.verdict, RateVerdict::CannotTell);
    assert_eq!(limits.hysteresis.found, None);
    assert!(
        limits
            .ends
            .as_ref()
            .unwrap()
            .iter()
            .all(|end| end.softens.is_none())
    );
    let of_ends = limits.ends.iter().flatten().map(|end| &end.statement);
    let others = [
        &limits.rate_up.statement,
        &limits.rate_down.statement,
        &limits.hysteresis.statement,
    ];
    for statement in of_ends.chain(others) {
        assert!(statement.contains("does not determine"), "{statement}");
    }
}

/// Each end is reached from one side alone, and its neighbour from both.
#[test]
fn play_makes_no_end_fall_short() {
    let input = up_and_down();
    for seed in 0..2 {
        let clean = limited(0.8, 60.0, Limit::Play(0.5), &input, -6.0);
        let limits = limits_of(&input, &clean, 111, seed);
        assert_eq!(
            limits.hysteresis.found,
            Some(true),
            "{}",
            limits.hysteresis.statement
        );
        for end in limits.ends.unwrap() {
            assert!(end.statement.starts_with("No stop"), "{}", end.statement);
        }
    }
}

/// Of a limited servo the linear model is none, nor is its settling time: the cells have the rests that were measured.
#[test]
fn what_is_reached_is_the_rest_that_was_measured() {
    let levels: Vec<f64> = [-30.0, 30.0, -10.0, 10.0, -30.0, 30.0, -20.0, 20.0].repeat(3);
    let input: Vec<f64> = levels.iter().flat_map(|level| [*level; 100]).collect();
    let mut y = -30.0;
    let clean: Vec<f64> = (input.iter())
        .map(|u| {
            y += (0.2 * (u - y)).clamp(-1.0, 1.0);
            y
        })
        .collect();
    let limits = limits_of(&input, &clean, 111, 3);
    let [low, high] = limits.ends.unwrap();
    for end in [low, high] {
        let reached = end.reached.value.unwrap();
        // Coloured noise of 0.05 over 25 samples in each of three visits, and a converter with steps of 0.037.
        assert!((reached - end.command).abs() < 0.1, "{}", end.statement);
        assert!(end.statement.starts_with("No stop"), "{}", end.statement);
    }
}
