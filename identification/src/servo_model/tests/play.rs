//! Play behind the servo's own sensor is a term with a width of its own, beside friction and a dead band, and wherever in it a run begins.

use super::{PERIOD_S, in_noise, point, require_held, strokes, value};
use crate::data::Record;
use crate::servo_model::descent::coordinates::{Point, Terms};
use crate::servo_model::{QuantityKind, ServoModelOptions, fit};
use servoid_dynamics::{Grid, Start, simulate};

/// What the sensor shows of a servo that begins at rest under the first command, the shaft at this place in its play.
fn seen(servo: &Point, input: &[f64], in_play: f64) -> Vec<f64> {
    let physics = servo.physics(0, |_, value| value);
    let shown = physics.resting_angle(input[0]) - in_play * physics.half_play();
    let start = Start {
        in_play,
        ..Start::at_rest(shown * physics.gain + physics.offset, Some(input[0]))
    };
    let mut output = Vec::new();
    let grid = Grid::new(PERIOD_S, 0.0, 1e-4);
    simulate(&physics, &grid, &start, input, |_, y| output.push(y));
    output
}

fn limited(dead_band: bool, friction: bool) -> Terms {
    Terms {
        limit: true,
        dead_band,
        play: true,
        friction,
        ..Terms::default()
    }
}

#[test]
fn play_is_found_beside_what_else_holds_the_shaft_off_its_command() {
    for (seed, (dead_band, friction)) in (1..).zip([(false, false), (true, false), (false, true)]) {
        let (servo, input) = (point(limited(dead_band, friction), value), strokes(3000));
        let output = in_noise(seen(&servo, &input, 0.0), 0.03, seed);
        let record = Record::of_run(PERIOD_S, &input, output).unwrap();
        let found = fit(&record, &ServoModelOptions::default()).unwrap();
        let names = [
            "delay",
            "gain",
            "top speed upwards",
            "error of full drive",
            QuantityKind::Play.name(),
        ];
        require_held(&found, &servo, &names);
        let play = found.quantity(QuantityKind::Play).unwrap();
        let interval = play.interval.valid().unwrap();
        assert!(
            play.determined && interval.lower.unwrap() > 0.0,
            "{interval:?}"
        );
    }
}

/// At either end of its play a servo answers the first command at once, or when all of the play is crossed. A band from rest holds both.
#[test]
fn a_run_may_begin_anywhere_in_its_play() {
    let (servo, input) = (point(limited(false, false), value), strokes(3000));
    for (seed, in_play) in [(11, 1.0), (12, -1.0)] {
        let output = in_noise(seen(&servo, &input, in_play), 0.03, seed);
        let record = Record::of_run(PERIOD_S, &input, output).unwrap();
        let found = fit(&record, &ServoModelOptions::default()).unwrap();
        require_held(&found, &servo, &["delay", QuantityKind::Play.name()]);
        let new = [vec![0.0; 20], vec![3.0; 200]].concat();
        let predicted = found.respond(&new, 0);
        for from in [1.0, -1.0] {
            let truth = seen(&servo, &new, from);
            let halves = predicted.half_width.valid().unwrap();
            for ((value, half), truth) in predicted.value.iter().zip(halves).zip(truth) {
                assert!(
                    (value - truth).abs() <= half + 1e-6,
                    "from {from}: {value} {half} {truth}"
                );
            }
        }
    }
}
