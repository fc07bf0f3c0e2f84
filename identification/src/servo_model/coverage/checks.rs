//! The truths against what is known of them: nothing else would show a mistake there from one of the fit.

use super::references::{PERIOD_S, Reference};
use super::servos::{Kind, servo};
use super::truth::{Beyond, Truth};
use crate::servo_model::quantities;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use servoid_dynamics::{Grid, ServoParameters, Start, simulate};

/// A servo without two speeds, dead band and load, and without friction unless the kind has it.
const PLAIN: u64 = 0;

fn physics(truth: &Truth) -> ServoParameters {
    truth.point.physics(0, |_, value| value)
}

/// The angle of rest under each of `commands`, given for 0.8 s one after the other.
fn rests(truth: &Truth, commands: &[f64]) -> Vec<f64> {
    let hold = (0.8 / PERIOD_S) as usize;
    let held = |command: &f64| std::iter::repeat_n(*command, hold);
    let input: Vec<f64> = commands.iter().flat_map(held).collect();
    let output = truth.response(&input, PERIOD_S);
    let p = physics(truth);
    let ends = output.chunks(hold).map(|part| part[hold - 1]);
    ends.map(|y| (y - p.offset) / p.gain).collect()
}

/// Two schemes give the same motion.
#[test]
fn within_the_class_the_truth_is_the_equation() {
    let in_class = (0..12).map(|seed| (Kind::InClass, seed));
    for (kind, seed) in in_class.chain((0..6).map(|seed| (Kind::CutOffSpeed, seed))) {
        let truth = servo(kind, seed);
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let input = Reference::RandomLevels.command(&mut random, 1000);
        let physics = physics(&truth);
        let grid = Grid::new(PERIOD_S, 0.0, 1e-5);
        let start = Start::at_rest(physics.resting_output(input[0]), Some(input[0]));
        let theirs = truth.response(&input, PERIOD_S);
        let mut worst: f64 = 0.0;
        simulate(&physics, &grid, &start, &input, |k, y| {
            worst = worst.max((y - theirs[k]).abs());
        });
        // 0.0007 degrees measured, where friction stops the shaft a step earlier or later.
        assert!(worst < 0.002, "{kind} {seed}: {worst}");
    }
}

#[test]
fn a_long_stroke_reaches_the_top_speed_of_the_equation() {
    for seed in 0..6 {
        let truth = servo(Kind::InClass, seed);
        let formula = quantities::values(&truth.point, 0.0);
        for (name, speed) in formula {
            if let Some(upwards) = match name {
                "top speed upwards" => Some(true),
                "top speed downwards" => Some(false),
                _ => None,
            } {
                let found = truth.top_speed(upwards);
                // The formula takes friction in motion; at top speed 1/401 of what friction at rest has more is left.
                assert!(
                    (found / speed - 1.0).abs() < 1e-3,
                    "servo {seed}, {name}: {found} {speed}"
                );
            }
        }
    }
}

#[test]
fn play_lies_between_rests_from_below_and_above() {
    let overdamped = |truth: &Truth| {
        let p = physics(truth);
        p.damping > 2.1 * p.stiffness.sqrt() && p.dead_band.is_none() && p.friction.is_none()
    };
    let mut drawn = (0..).map(|seed| servo(Kind::Play, seed));
    let truth = drawn.find(overdamped).expect("endless");
    let width = physics(&truth).play.unwrap();
    // Small strokes, so that no limit of the drive lets the shaft overshoot, and larger ones than the play.
    let end = 0.3 + width;
    let found = rests(&truth, &[-end, 0.0, end, 0.0]);
    // What is left of the stroke after 0.8 s at 25 rad/s or more.
    assert!(
        (found[3] - found[1] - width).abs() < 1e-4,
        "{found:?} {width}"
    );
}

#[test]
fn stiction_holds_what_coulomb_friction_would_not() {
    let truth = servo(Kind::Stiction, PLAIN);
    let Beyond::Stiction { excess, .. } = truth.beyond else {
        unreachable!("kind")
    };
    let p = physics(&truth);
    let coulomb = p.friction.unwrap().coulomb / p.stiffness;
    let at = |share: f64| rests(&truth, &[0.0, coulomb * (1.0 + share * excess)])[1];
    assert_eq!(at(0.9), 0.0);
    assert!(at(1.1) > 0.0);
}

#[test]
fn the_current_limits_the_acceleration_at_low_speed() {
    let truth = servo(Kind::CurrentLimit, PLAIN);
    let Beyond::CurrentLimit { share } = truth.beyond else {
        unreachable!("kind")
    };
    let p = physics(&truth);
    let input: Vec<f64> = (0..100).map(|k| if k == 0 { 0.0 } else { 100.0 }).collect();
    let late = (p.delay_s / PERIOD_S).ceil() as usize + 3;
    let moved = (truth.response(&input, PERIOD_S)[late] - p.offset) / p.gain;
    let time_s = (late - 1) as f64 * PERIOD_S - p.delay_s;
    let constant = 0.5 * share * p.limit.unwrap().up * time_s * time_s;
    assert!((moved / constant - 1.0).abs() < 1e-6, "{moved} {constant}");
}

#[test]
fn a_quantised_drive_does_not_answer_half_a_step() {
    let truth = servo(Kind::QuantisedDrive, PLAIN);
    let Beyond::QuantisedDrive { step } = truth.beyond else {
        unreachable!("kind")
    };
    let p = physics(&truth);
    let whole = step * p.limit.unwrap().up / p.stiffness;
    assert_eq!(rests(&truth, &[0.0, 0.49 * whole])[1], 0.0);
    assert!(rests(&truth, &[0.0, 0.51 * whole])[1] > 0.0);
}
