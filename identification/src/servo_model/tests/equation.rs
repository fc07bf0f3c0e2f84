//! The equation and its derivatives against formulas and differences.

use servoid_dynamics::{Dual, Grid, Scalar, Start, simulate};

use super::{PERIOD_S, point, response, strokes, value};
use crate::servo_model::descent::coordinates::{LoadKind, Terms};
use crate::servo_model::descent::step::MOST;

fn largest(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()))
}

/// 1 - e^(-ζωt) (cos ω_d t + ζω/ω_d sin ω_d t), from the delayed edge on.
#[test]
fn a_linear_servo_has_the_step_response_of_the_textbook() {
    let servo = point(Terms::default(), value);
    let mut input = vec![0.0; 10];
    input.extend([1.0; 200]);
    let found = response(&servo, &input, 1e-3);
    let (decay, damped) = (35f64, (2500f64 - 35.0 * 35.0).sqrt());
    for (k, y) in found.iter().enumerate() {
        let t = (k as f64 * PERIOD_S - 0.02 - 0.0213).max(0.0);
        let rest = (-decay * t).exp() * ((damped * t).cos() + decay / damped * (damped * t).sin());
        let exact = 1.1 * (1.0 - rest) + 0.3;
        // The scheme is of second order: about (ωh)² = 0.0025 of the stroke.
        assert!((y - exact).abs() < 0.0025, "{k}: {y} {exact}");
    }
}

#[test]
fn half_the_step_has_a_quarter_of_the_error() {
    let terms = Terms {
        limit: true,
        two_speeds: true,
        load: LoadKind::Pendulum,
        ..Terms::default()
    };
    let (servo, input) = (point(terms, value), strokes(1500));
    let exact = response(&servo, &input, 2e-5);
    let [coarse, fine] = [1e-3, 5e-4].map(|step| largest(&response(&servo, &input, step), &exact));
    // A little more than a quarter where the drive leaves its limit within a step.
    assert!(coarse < 0.02 && fine < 0.35 * coarse, "{coarse} {fine}");
}

#[test]
fn derivatives_of_the_motion_are_those_of_differences() {
    for load in [LoadKind::Spring, LoadKind::TiltedPendulum, LoadKind::Air] {
        let terms = Terms {
            limit: true,
            two_speeds: true,
            one_stiffness: false,
            speed_limit: false,
            dead_band: true,
            play: true,
            friction: true,
            friction_of_gears: true,
            load,
        };
        let (servo, input) = (point(terms, value), strokes(600));
        let physics = servo.physics(0, |i, value| Dual::<MOST>::variable(value, i));
        let grid = Grid::new(PERIOD_S, 0.0, 1e-3);
        let mut slopes = Vec::new();
        let start = Start::at_rest(0.3, Some(0.0));
        let constants = Start {
            output: Dual::constant(start.output),
            rate: Dual::constant(start.rate),
            command_before: start.command_before.map(Dual::constant),
            in_play: start.in_play,
        };
        simulate(&physics, &grid, &constants, &input, |_, y| {
            slopes.push(y.slope)
        });
        for (i, coordinate) in servo.coordinates.iter().enumerate() {
            let moved = |change: f64| {
                let mut other = servo.clone();
                other.values[i] += change;
                let mut output = Vec::new();
                let physics = other.physics(0, |_, value| value);
                simulate(&physics, &grid, &start, &input, |_, y| output.push(y));
                output
            };
            // Small, so that the shaft hardly ever comes to rest one step of the integration earlier on one side.
            let step = 1e-8 * servo.values[i].abs().max(0.1);
            let (above, below) = (moved(step), moved(-step));
            let scale = slopes
                .iter()
                .fold(1e-9, |most: f64, s| most.max(s[i].abs()));
            let close = |(k, slope): (usize, &[f64; MOST])| {
                ((above[k] - below[k]) / (2.0 * step) - slope[i]).abs() < 1e-3 * scale
            };
            let right = slopes
                .iter()
                .enumerate()
                .filter(|pair| close(*pair))
                .count();
            assert!(right > 590, "{coordinate:?}: {right} of 600");
        }
    }
}
