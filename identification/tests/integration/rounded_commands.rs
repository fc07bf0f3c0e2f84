//! Commands of a stick and of a sweep that were rounded where they were written, while the servo got them as they were.

use rand::RngExt;
use servoid_identification::flight_model::{self, FlightModelOptions};
use servoid_identification::results::{Advice, Check, Model, Reason, Withheld};
use servoid_identification::{Error, Options, Record, Run, identify};
use servoid_test_support::plants::{normal, random};
use std::f64::consts::TAU;

const PERIOD_S: f64 = 0.01;
const SAMPLES: usize = 3000;

/// Of the servo behind its dead time of a sample.
const LAG_S: f64 = 0.04;

/// Steps in which commands within ±10 are written \[deg\].
const STEP: f64 = 0.3;

/// Of the sensor \[deg\]: far below the rounding; and such that it may hide it, where errors do not show that there is none.
const SMALL_NOISE: f64 = 0.01;
const NOISE: f64 = 0.1;

/// Levels within ±10 of 0.1 to 0.6 s, behind a lag of 50 ms: a hand.
fn stick(seed: u64) -> Vec<f64> {
    let mut random = random(seed);
    let (mut at, mut level, mut left) = (0.0, 0.0, 0);
    let next = |_| {
        if left == 0 {
            left = random.random_range(10..60);
            level = random.random_range(-10.0..10.0);
        }
        left -= 1;
        at += (1.0 - (-PERIOD_S / 0.05_f64).exp()) * (level - at);
        at
    };
    (0..SAMPLES).map(next).collect()
}

/// A sweep of ±10 from 0.2 to 6 Hz.
fn sweep() -> Vec<f64> {
    let duration = SAMPLES as f64 * PERIOD_S;
    let at = |k: usize| {
        let time = k as f64 * PERIOD_S;
        10.0 * (TAU * (0.2 * time + 5.8 * time * time / 2.0 / duration)).sin()
    };
    (0..SAMPLES).map(at).collect()
}

/// As they are written.
fn rounded(commands: &[f64]) -> Vec<f64> {
    commands.iter().map(|u| (u / STEP).round() * STEP).collect()
}

/// The servo's angle at each sample.
fn motion(commands: &[f64]) -> Vec<f64> {
    let share = 1.0 - (-PERIOD_S / LAG_S).exp();
    let mut at = 0.0;
    let next = |command: &f64| {
        let before = at;
        at += share * (command - at);
        before
    };
    commands.iter().map(next).collect()
}

/// The run of a servo that was sent `sent`, with `written` in its column.
fn run(sent: &[f64], written: Vec<f64>, noise: f64, seed: u64) -> Run<'static> {
    let mut random = random(1000 + seed);
    let output: Vec<f64> = (motion(sent).iter())
        .map(|angle| angle + noise * normal(&mut random))
        .collect();
    Run::new(written, output).unwrap()
}

fn model(runs: Vec<Run<'static>>) -> Model {
    identify(&Record::new(PERIOD_S, runs).unwrap(), &Options::default()).unwrap()
}

/// Half width of the whole curve's band, on average.
fn width(model: &Model) -> f64 {
    let (_, whole) = model.step.bounds.valid().unwrap().mean_half_widths();
    whole
}

/// Whether the whole step response is inside its band.
fn holds(seed: u64) -> bool {
    let sent = stick(seed);
    let model = model(vec![run(&sent, rounded(&sent), SMALL_NOISE, seed)]);
    let Some(bounds) = model.step.bounds.valid() else {
        return true;
    };
    let band = &bounds.simultaneous;
    let truth = motion(&vec![1.0; band.lower.len()]);
    let mut points = band.lower.iter().zip(&band.upper).zip(&truth);
    points.all(|((low, high), truth)| low <= truth && truth <= high)
}

/// One in a hundred may miss: of 20 more than two with a chance of 0.1 %.
#[test]
fn bounds_hold_where_the_commands_of_a_stick_were_rounded() {
    let missed = (0..20).filter(|seed| !holds(*seed)).count();
    assert!(missed <= 2, "{missed} missed");
}

fn on_command_errors(model: &Model) -> &Advice {
    let mut advice = model.advice.iter();
    let found = advice.find(|of| of.check == Check::CommandErrors);
    found.unwrap()
}

/// What excites the high frequencies is then the rounding, which the servo did not get.
#[test]
fn a_sweep_that_was_rounded_has_no_level_as_one_that_was_not() {
    let sent = sweep();
    for written in [sent.clone(), rounded(&sent)] {
        let model = model(vec![run(&sent, written, NOISE, 1)]);
        assert_eq!(model.step.bounds.withdrawn(), Some(Reason::InputUnexcited));
    }
    let model = model(vec![run(&sent, rounded(&sent), NOISE, 1)]);
    let said = on_command_errors(&model);
    assert!(said.finding.contains("in steps of 0.3,"), "{said:?}");
    assert!(said.remedy.contains("all their digits"), "{said:?}");
}

/// Held for two rows, a sweep has power up to half of their rate, but only some of it is the sweep's.
#[test]
fn a_sweep_in_frames_that_was_rounded_has_no_gain_and_no_model_of_low_order() {
    // Of ±100 us from 0.2 to 8 Hz, in whole microseconds.
    let pulse = |k: usize| {
        let turns = 4.0 / 40f64.ln() * (40f64.powf(k as f64 / 2000.0) - 1.0);
        (100.0 * (TAU * turns).sin()).round()
    };
    let sent: Vec<f64> = (0..2000).map(|k| pulse(k / 2 * 2)).collect();
    let model = model(vec![run(&sent, sent.clone(), 0.3, 1)]);
    assert_eq!(model.bounds.withdrawn(), Some(Reason::InputUnexcited));
    let said = on_command_errors(&model);
    assert!(said.finding.contains("rest on their rounding"), "{said:?}");
    assert!(!said.finding.contains("Hz"), "{said:?}");
    assert_eq!(model.metrics.withheld, Some(Withheld::InputUnexcited));
    assert_eq!(model.metrics.dc_gain.value, None);
    let fitted = flight_model::of_model(&model, &FlightModelOptions::default());
    assert_eq!(
        fitted.unwrap_err(),
        Error::ResponseOpen(Reason::InputUnexcited.because())
    );
}

/// A grid costs its bounds where it may be one of rounding: not where it is stated to be exact, nor beside a column without a grid.
#[test]
fn commands_that_are_exact_cost_no_width() {
    let grid = rounded(&stick(3));
    // Off any grid, by next to nothing.
    let off = |(k, u): (usize, &f64)| u + 1e-5 * (k as f64 * 0.618_034).fract();
    let off: Vec<f64> = grid.iter().enumerate().map(off).collect();
    let once = |written: &[f64]| run(&grid, written.to_vec(), NOISE, 3);
    let exact = width(&model(vec![once(&grid).with_exact_input()]));
    let without = width(&model(vec![once(&off)]));
    let unknown = width(&model(vec![once(&grid)]));
    assert!((exact / without - 1.0).abs() < 1e-3, "{exact} {without}");
    assert!(unknown > 1.1 * exact, "{unknown} {exact}");
}

/// Where one of two runs is exact, half of the rounding is left.
#[test]
fn each_run_states_whether_its_commands_are_exact() {
    let grid = rounded(&stick(4));
    let first = || run(&grid, grid.clone(), NOISE, 4);
    let second = || run(&grid, grid.clone(), NOISE, 5);
    let both = width(&model(vec![
        first().with_exact_input(),
        second().with_exact_input(),
    ]));
    let one = width(&model(vec![first().with_exact_input(), second()]));
    let none = width(&model(vec![first(), second()]));
    assert!(both < one && one < none, "{both} {one} {none}");
}

/// Levels that are farther apart than rounding would leave them were meant.
#[test]
fn random_commands_of_a_dozen_levels_are_exact() {
    let mut random = random(6);
    let levels: Vec<f64> = (0..SAMPLES / 3)
        .map(|_| 2.0 * f64::from(random.random_range(-6..6_i32)))
        .collect();
    let sent: Vec<f64> = levels.iter().flat_map(|level| [*level; 3]).collect();
    let once = || run(&sent, sent.clone(), NOISE, 6);
    let (exact, unknown) = (model(vec![once().with_exact_input()]), model(vec![once()]));
    assert_eq!(width(&exact), width(&unknown));
}
