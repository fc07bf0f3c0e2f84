//! References that repeat themselves, under which a servo that is not linear and rests in each hold passes for a slow linear one.

use servoid_identification::results::{Check, Reason};
use servoid_identification::{Identification, Options, Record, identify_explained};

use rand::RngExt;
use servoid_test_support::plants::{Noise, normal, random};
use servoid_test_support::servos::{Limit, Linear, PERIOD, limited};

/// Rows of 2 ms from row to row: 12 ms.
const EVERY: usize = 6;

/// Rows of a hold, of 0.48 s.
const HOLD: usize = 40;

/// Levels that are held, over and over for 26 s, after and before rest at 0.
fn repeated(levels: &[f64]) -> Vec<f64> {
    let rest = || std::iter::repeat_n(0.0, 50);
    let held = levels.iter().cycle().take(54);
    let held = held.flat_map(|level| std::iter::repeat_n(*level, HOLD));
    rest().chain(held).chain(rest()).collect()
}

/// A servo of 50 rad/s under `input` with noise of 0.03 degrees, and a `disturbance` of rows.
fn identified(
    input: &[f64],
    limit: Limit,
    seed: u64,
    disturbance: impl Fn(usize) -> f64,
) -> Identification {
    let fine: Vec<f64> = (input.iter())
        .flat_map(|level| std::iter::repeat_n(*level, EVERY))
        .collect();
    let mut random = random(seed);
    let clean = limited(0.8, 50.0, limit, &fine, 0.0);
    let output: Vec<f64> = (clean.iter().step_by(EVERY).enumerate())
        .map(|(k, angle)| angle + 0.03 * normal(&mut random) + disturbance(k))
        .collect();
    let record = Record::of_run(EVERY as f64 * PERIOD, input, output).unwrap();
    identify_explained(&record, &Options::default()).unwrap()
}

fn undisturbed(_: usize) -> f64 {
    0.0
}

/// The half of their period is the negative of the other one.
fn stairs() -> Vec<f64> {
    repeated(&[2.0, 6.0, 10.0, 6.0, 2.0, -2.0, -6.0, -10.0, -6.0, -2.0])
}

fn square() -> Vec<f64> {
    repeated(&[20.0, -20.0])
}

/// A response of half the period, which is 2.4 s, described them, with gains of 0.87 to 0.90 and an end that was not reached.
#[test]
fn no_response_outlasts_holds_in_which_a_servo_with_play_rests() {
    for seed in 0..3 {
        let found = identified(&stairs(), Limit::Play(1.5), seed, undisturbed);
        let model = &found.model;
        assert!(!model.linear && model.bounds.withdrawn().is_some());
        assert!(model.structure.settling_samples <= HOLD, "{seed}");
        let gain = model.metrics.dc_gain.value.unwrap();
        assert!((0.97..1.03).contains(&gain), "seed {seed}: {gain}");
        assert!(found.explanation.taken_out.is_empty());
    }
}

/// Nothing repeats itself, so that a response of several holds is no description of the holds: it is one of the steps before, after which play leaves
/// the servo elsewhere. It moved until 0.8 s and said so of the settling time.
#[test]
fn a_servo_with_play_settles_when_it_rests_where_holds_differ() {
    let up_and_down = [-20.0, -10.0, 0.0, 10.0, 20.0, 10.0, 0.0, -10.0];
    let levels = up_and_down.into_iter().cycle().take(49);
    let held = levels.enumerate().flat_map(|(hold, level)| {
        let rows = HOLD + 11 + 7 * hold % 17;
        std::iter::repeat_n(level, rows)
    });
    let input: Vec<f64> = held.collect();
    for seed in 0..3 {
        for play in [0.6, 1.0] {
            let found = identified(&input, Limit::Play(play), seed, undisturbed);
            let model = &found.model;
            assert!(!model.linear, "play of {play}, seed {seed}");
            let mut advice = model.advice.iter();
            let said = advice.any(|advice| advice.finding.contains("but the output is at rest"));
            let is_withdrawn = model.bounds.withdrawn().is_some();
            assert!(
                said || is_withdrawn,
                "play of {play}, seed {seed}: {:?}",
                model.advice
            );
            // A lag of 25 ms, which is over after 100 ms, and the row before it.
            let settling = model.metrics.settling_time_s.value;
            let is_right = settling.map_or(is_withdrawn, |seconds| seconds < 0.12);
            assert!(is_right, "play of {play}, seed {seed}: {settling:?} s");
        }
    }
}

/// A linear servo whose last half or whole percent creeps, every second one, under stairs of holds that differ.
fn creeping(seed: u64) -> Identification {
    let mut random = random(seed);
    let (omega, zeta) = (
        random.random_range(30.0..80.0),
        random.random_range(0.6..1.0),
    );
    let share = [0.0, 0.005, 0.0, 0.01][seed as usize % 4];
    let lag_s = random.random_range(0.3..3.0);
    let levels = [-20.0, -10.0, 0.0, 10.0, 20.0, 10.0, 0.0, -10.0];
    let input: Vec<f64> = (levels.into_iter().cycle().take(25))
        .flat_map(|level| std::iter::repeat_n(level, random.random_range(320..420)))
        .collect();
    let quick = Linear::second_order(1.0 - share, 0.0, zeta, omega);
    let slow = Linear::first_order(share, 0.0, lag_s);
    let [quick, slow] = [quick, slow].map(|part| part.respond(&input, input[0], 0.0));
    let noise = match seed % 8 < 4 {
        true => Noise::White,
        false => Noise::Ar1,
    };
    let noise = noise.samples(&mut random, input.len());
    let output = quick.iter().zip(&slow).zip(noise);
    let output: Vec<f64> = output
        .map(|((quick, slow), noise)| quick + slow + noise)
        .collect();
    let record = Record::of_run(PERIOD, input, output).unwrap();
    identify_explained(&record, &Options::default()).unwrap()
}

/// Whether N is that of all lags. A creep that outlasts N takes the bounds, for its own reason.
fn is_kept(seed: u64) -> bool {
    let found = creeping(seed);
    let withdrawn = found.model.bounds.withdrawn();
    let is_cut_off = found.explanation.settling.unwrap().within_holds;
    let has_reason = withdrawn.is_none_or(|reason| reason == Reason::ResponseNotOver);
    found.model.linear && !is_cut_off && has_reason
}

/// What creeps moves after the hold, too, and ever slower.
#[test]
fn linear_servos_that_creep_are_not_cut_off() {
    for seed in 0..4 {
        assert!(is_kept(seed), "{seed}");
    }
}

/// The figure in docs/assumptions.md.
#[test]
#[ignore = "two minutes: cargo test --release -p servoid-identification --test integration -- --ignored three_hundred"]
fn three_hundred_linear_servos_are_not_cut_off() {
    let cut_off: Vec<u64> = (100..400).filter(|seed| !is_kept(*seed)).collect();
    assert!(cut_off.is_empty(), "{cut_off:?}");
}

#[test]
fn linear_servos_that_rest_keep_their_bounds() {
    for seed in 0..3 {
        for input in [stairs(), square()] {
            let found = identified(&input, Limit::Play(0.0), seed, undisturbed);
            let model = &found.model;
            assert!(model.linear, "seed {seed}: {:?}", model.advice);
            assert_eq!(model.bounds.withdrawn(), None);
        }
    }
}

/// The first and the last stroke of the square wave are half as large, and end before those at full speed would.
#[test]
fn strokes_of_another_size_that_disagree_are_no_glitches() {
    for seed in 0..3 {
        let limit = Limit::Rate(250.0, 250.0);
        let found = identified(&square(), limit, seed, undisturbed);
        let model = &found.model;
        assert!(!model.linear, "seed {seed}: {:?}", model.advice);
        let taken_out = &found.explanation.taken_out;
        assert!(taken_out.iter().any(|found| found.other_stroke));
        let mut advice = model.advice.iter();
        let said = advice.find(|advice| advice.check == Check::Linearity);
        let said = &said.unwrap().finding;
        assert!(
            said.contains("a step of 20 at 0.600 s is not answered as the steps of 40"),
            "{said}"
        );
        let glitches =
            |advice: &&servoid_identification::results::Advice| advice.check == Check::Outliers;
        assert_eq!(model.advice.iter().find(glitches), None, "seed {seed}");
    }
}

/// A short record from the middle has a single half stroke, and no other stretch of outlying samples. Its beginning is more than a hundredth
/// of the record, and the history of the model may hide a part of it.
#[test]
fn a_single_half_stroke_that_disagrees_is_no_glitch() {
    for (seed, rest) in (0..).zip([50, 80]) {
        let full = [20.0, -20.0].into_iter().cycle().take(20);
        let full = full.flat_map(|level| std::iter::repeat_n(level, HOLD));
        let input: Vec<f64> = std::iter::repeat_n(0.0, rest).chain(full).collect();
        let found = identified(&input, Limit::Rate(250.0, 250.0), seed, undisturbed);
        let taken_out = &found.explanation.taken_out;
        assert!(!found.model.linear, "{rest}: {taken_out:?}");
    }
}

#[test]
fn a_burst_among_strokes_of_one_size_is_a_glitch() {
    for (seed, start) in (0..).zip([70, 600, 615, 1207]) {
        let burst = |k: usize| match (start..start + 6).contains(&k) {
            true => 2.0,
            false => 0.0,
        };
        let found = identified(&square(), Limit::Play(0.0), seed, burst);
        let places = found.explanation.taken_out.iter();
        let samples: usize = places.map(|found| found.samples).sum();
        assert!(samples >= 6, "{start}: {samples}");
        assert!(found.model.linear, "{start}: {:?}", found.model.advice);
    }
}

/// At rest, two of three readings are the same. The median of such errors is none, and up to 3 % of the samples were outlying.
#[test]
fn steps_of_the_sensor_that_noise_hardly_dithers_are_no_outliers() {
    const STEP: f64 = 0.0879;
    for seed in 0..3 {
        let mut random = random(seed);
        let (mut angle, mut noise) = (0.0, 0.0);
        let input: Vec<f64> = (0..4000)
            .map(|k| 5.0 * [0.0, 1.0, 2.0, 1.0, 3.0][k / 60 % 5])
            .collect();
        let output: Vec<f64> = (input.iter())
            .map(|level| {
                noise = 0.9 * noise + 0.022 * normal(&mut random);
                let seen: f64 = angle + noise;
                angle += 0.2 * (level - angle);
                (seen / STEP).round() * STEP
            })
            .collect();
        let record = Record::of_run(0.005, input, output).unwrap();
        let found = identify_explained(&record, &Options::default()).unwrap();
        let taken_out = &found.explanation.taken_out;
        assert!(taken_out.len() <= 1, "seed {seed}: {taken_out:?}");
    }
}
