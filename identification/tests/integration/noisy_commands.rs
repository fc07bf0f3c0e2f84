//! Commands whose column has noise that the servo was sent, or was not.

use rayon::prelude::*;
use servoid_identification::results::{Advice, Check, Model, Reason};
use servoid_identification::{Options, Record, Run, identify};
use servoid_test_support::noisy_commands::{Command, CommandNoise, NoisyCommand};
use servoid_test_support::plants::{PERIOD, Plant};

const HELD: NoisyCommand = NoisyCommand {
    command: Command::Levels,
    plant: Plant::A,
    noise: CommandNoise::White(0.01),
    is_sent: false,
    samples: 10_000,
};

fn model(record: &Record) -> Model {
    identify(record, &Options::default()).unwrap()
}

fn noise(model: &Model) -> Option<&Advice> {
    let mut findings = model.advice.iter();
    findings.find(|found| found.check == Check::CommandNoise)
}

/// Whether the whole exact response is within the bounds of a recording, if it has some.
fn is_within_bounds(case: &NoisyCommand, seed: u64) -> bool {
    let trial = case.trial(seed);
    let model = model(&trial.record);
    let Some(bounds) = model.step.bounds.valid() else {
        return true;
    };
    let band = &bounds.simultaneous;
    let last = band.lower.len() - 1;
    let truth = trial.truth[..last].iter().chain([&1.0]);
    let mut points = band.lower.iter().zip(&band.upper).zip(truth);
    points.all(|((lower, upper), truth)| (lower..=upper).contains(&truth))
}

/// Half width of the whole curve's band, on average.
fn width(model: &Model) -> f64 {
    let (_, whole) = model.step.bounds.valid().unwrap().mean_half_widths();
    whole
}

const STAIRS: NoisyCommand = NoisyCommand {
    command: Command::Stairs,
    plant: Plant::D,
    noise: CommandNoise::White(0.03),
    ..HELD
};

const SQUARE: NoisyCommand = NoisyCommand {
    command: Command::Square,
    plant: Plant::C,
    noise: CommandNoise::White(0.003),
    ..HELD
};

/// Where bounds knew nothing of the noise, hardly one of these held its curve.
#[test]
fn bounds_hold_where_a_held_command_was_measured_with_noise() {
    let long = NoisyCommand {
        samples: 60_000,
        noise: CommandNoise::White(0.01),
        ..STAIRS
    };
    let trials = [(STAIRS, 6), (long, 2)];
    let trials: Vec<(NoisyCommand, u64)> = (trials.into_iter())
        .flat_map(|(case, count)| (0..count).map(move |seed| (case, 300 + seed)))
        .collect();
    let missed = (trials.par_iter()).filter(|(case, seed)| !is_within_bounds(case, *seed));
    assert_eq!(missed.count(), 0);
}

/// Lags that are a period apart differ by the noise alone.
#[test]
fn a_square_wave_with_noise_has_no_bounds_by_its_noise() {
    let record = SQUARE.trial(2).record;
    let model = model(&record);
    assert_eq!(model.step.bounds.withdrawn(), Some(Reason::InputUnexcited));
    let excitation = model
        .advice
        .iter()
        .find(|of| of.check == Check::CommandErrors);
    let excitation = excitation.unwrap();
    assert!(
        excitation.finding.contains("has noise of up to 0.030"),
        "{excitation:?}"
    );
    let noise = noise(&model).unwrap();
    assert!(noise.finding.contains("deviation of 0.030"), "{noise:?}");
}

#[test]
fn a_command_that_is_stated_to_be_exact_has_no_noise_and_narrower_bounds() {
    let case = NoisyCommand {
        is_sent: true,
        ..HELD
    };
    let record = case.trial(3).record;
    let runs = record.runs().iter().cloned().map(Run::with_exact_input);
    let exact = model(&Record::new(PERIOD, runs.collect()).unwrap());
    let unknown = model(&record);
    assert!(noise(&unknown).is_some() && noise(&exact).is_none());
    assert!(width(&unknown) > 1.02 * width(&exact));
}

#[test]
fn noise_of_a_command_that_is_not_held_is_not_named() {
    for command in [Command::Multisine, Command::Stick] {
        let case = NoisyCommand {
            command,
            is_sent: true,
            ..HELD
        };
        assert_eq!(noise(&model(&case.trial(4).record)), None, "{command:?}");
    }
}
