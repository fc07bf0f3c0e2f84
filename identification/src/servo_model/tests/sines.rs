//! The response to a sine of one size, against the motion of the true servo in steps of 0.1 ms.

use std::f64::consts::TAU;

use super::{PERIOD_S, noisy, point, strokes, value};
use crate::data::Record;
use crate::servo_model::descent::coordinates::{Point, Terms};
use crate::servo_model::{ServoModelOptions, fit};
use servoid_dynamics::{Grid, Start, simulate};

/// Gain and phase \[degrees\] of the first harmonic, over four periods behind two seconds of the same.
fn truth(servo: &Point, hertz: f64, amplitude: f64, middle: f64) -> [f64; 2] {
    let step_s = 1e-4;
    let period = (1.0 / (hertz * step_s)).round() as usize;
    let count = period * ((2.0 * hertz).ceil() as usize + 4);
    let angle = |k: usize| TAU * k as f64 / period as f64;
    let input: Vec<f64> = (0..count)
        .map(|k| middle + amplitude * angle(k).sin())
        .collect();
    let physics = servo.physics(0, |_, value| value);
    let start = Start::at_rest(physics.resting_output(input[0]), Some(input[0]));
    let (mut re, mut im) = (0.0, 0.0);
    simulate(
        &physics,
        &Grid::new(step_s, 0.0, step_s),
        &start,
        &input,
        |k, y| {
            if k + 4 * period >= count {
                re += y * angle(k).cos();
                im -= y * angle(k).sin();
            }
        },
    );
    // A sine is -j A/2 for each step, and its holds are half a step late.
    let size = 2.0 / (amplitude * (4 * period) as f64);
    let late = 180.0 * hertz * step_s;
    [re.hypot(im) * size, im.atan2(re).to_degrees() + 90.0 + late]
}

#[test]
fn gain_and_phase_of_a_limited_servo_are_those_of_each_size() {
    let terms = Terms {
        limit: true,
        two_speeds: true,
        ..Terms::default()
    };
    let (servo, input) = (point(terms, value), strokes(2000));
    for seed in [31, 32, 33] {
        let record = Record::of_run(PERIOD_S, &input, noisy(&servo, &input, seed)).unwrap();
        let found = fit(&record, &ServoModelOptions::default()).unwrap();
        let middle = found.commands.unwrap().middle();
        let mut gains = Vec::new();
        for (hertz, amplitude) in [(2.0, 4.0), (8.0, 1.0), (8.0, 5.0)] {
            let response = found.respond_to_sine(hertz, amplitude, 0);
            let [gain, phase] = response.bounds.into_valid().unwrap();
            let [true_gain, true_phase] = truth(&servo, hertz, amplitude, middle);
            let turns = ((response.phase_deg - true_phase) / 360.0).round();
            let true_phase = true_phase + 360.0 * turns;
            assert!(
                gain.contains(true_gain),
                "{hertz} {amplitude}: {true_gain} {gain:?}"
            );
            assert!(
                phase.contains(true_phase),
                "{hertz} {amplitude}: {true_phase} {phase:?}"
            );
            // Known to a fifth in sines that are as small as this: an interval that holds anything would pass.
            assert!(gain.upper.unwrap() < 1.2 * gain.lower.unwrap(), "{gain:?}");
            gains.push(response.gain);
        }
        // The limit makes less of a large sine.
        assert!(gains[2] < 0.9 * gains[1], "{gains:?}");
    }
}
