//! The equation against exact answers, and the fit against servos that are known.

mod arm;
mod changed_servo;
mod directions;
mod equation;
mod no_intervals;
mod offsets;
mod play;
mod poor_recordings;
mod pulse_end;
mod recovery;
mod sines;
mod speed_limit;
mod stops;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use servoid_dynamics::{Grid, Start, Stops, simulate};

use super::{ServoModel, ServoModelOptions, fit, quantities};
use crate::data::Record;
use crate::servo_model::descent::coordinates::{
    ArmTurn, Coordinate, FRICTION_SPEED_SHARE, Point, Terms,
};

const PERIOD_S: f64 = 0.002;

fn point(terms: Terms, value: impl Fn(Coordinate) -> f64) -> Point {
    let coordinates = terms.coordinates(1);
    Point {
        terms,
        values: coordinates.iter().map(|at| value(*at)).collect(),
        coordinates,
        arm: ArmTurn::OfCommand(1f64.to_radians()),
        friction_speed_share: FRICTION_SPEED_SHARE,
        run_offsets: Vec::new(),
        stops: Stops::default(),
        pulse_end: None,
    }
}

/// 50 rad/s, damping ratio 0.7, 21.3 ms late; full drive beyond 2 degrees.
fn value(at: Coordinate) -> f64 {
    match at {
        Coordinate::Delay => 0.0213,
        Coordinate::LnStiffness => 2500f64.ln(),
        Coordinate::LnDamping => 70f64.ln(),
        Coordinate::Gain => 1.1,
        Coordinate::Offset => 0.3,
        Coordinate::LnTopSpeed => 178.6f64.ln(),
        Coordinate::MotorShare => 0.4,
        Coordinate::LnDownToUp => 0.3,
        Coordinate::LnSpeedLimit => 150f64.ln(),
        Coordinate::LnAcceleration => 5000f64.ln(),
        Coordinate::DeadBand => 0.11,
        Coordinate::Play => 0.17,
        Coordinate::Friction => 0.13,
        Coordinate::FrictionAtRest => 0.7,
        Coordinate::FrictionOfGears => 0.1,
        Coordinate::ConstantLoad => 0.2,
        Coordinate::Spring => 0.05,
        Coordinate::Gravity => 0.4,
        Coordinate::GravityFrom => 40.0,
        Coordinate::AirStiffening => 0.02,
        Coordinate::AirFrom => -2.0,
        Coordinate::LnOwnStiffness(_) => 0.0,
    }
}

/// Strokes of several sizes, with holds of 80 to 240 ms.
fn strokes(samples: usize) -> Vec<f64> {
    let levels = [0.0, 5.0, -5.0, 2.0, -3.0, 4.0, -1.0, 5.0, 1.0, -4.0];
    let mut input = Vec::new();
    for number in 0.. {
        if input.len() >= samples {
            break;
        }
        let hold = 40 + 20 * (number * 7 % 5);
        input.extend(std::iter::repeat_n(levels[number % levels.len()], hold));
    }
    input.truncate(samples);
    input
}

fn response(point: &Point, input: &[f64], longest_step_s: f64) -> Vec<f64> {
    let physics = point.physics(0, |_, value| value);
    let start = Start::at_rest(physics.resting_output(input[0]), Some(input[0]));
    let mut output = Vec::new();
    let grid = Grid::new(PERIOD_S, 0.0, longest_step_s);
    simulate(&physics, &grid, &start, input, |_, y| output.push(y));
    output
}

fn noisy(point: &Point, input: &[f64], seed: u64) -> Vec<f64> {
    with_noise(point, input, 0.03, seed)
}

/// The response in white noise of this standard deviation.
fn with_noise(point: &Point, input: &[f64], sd: f64, seed: u64) -> Vec<f64> {
    in_noise(response(point, input, 1e-4), sd, seed)
}

/// An output in white noise of this standard deviation.
fn in_noise(output: Vec<f64>, sd: f64, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let noise = |y: f64| -> f64 {
        let v: f64 = StandardNormal.sample(&mut random);
        y + sd * v
    };
    output.into_iter().map(noise).collect()
}

/// Intervals of what follows from how the shaft rests and how fast it turns, by name.
fn require_intervals(servo: &Point, names: &[&str], seed: u64) {
    let input = strokes(3000);
    let record = Record::of_run(PERIOD_S, &input, noisy(servo, &input, seed)).unwrap();
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    require_held(&found, servo, names);
}

/// What the model `found` says of the `servo` by these names.
fn require_held(found: &ServoModel, servo: &Point, names: &[&str]) {
    for (name, truth) in quantities::values(servo, 0.0) {
        let mut named = found.quantities.iter().filter(|found| found.name == name);
        if !names.contains(&name) {
            continue;
        }
        let interval = named.next().unwrap().interval.valid().unwrap();
        assert!(interval.contains(truth), "{name}: {truth} {interval:?}");
    }
}
