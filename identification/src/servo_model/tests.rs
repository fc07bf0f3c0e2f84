//! The equation against exact answers, and the fit against servos that are known.

use super::coordinates::{Coordinate, FRICTION_SPEED_SHARE, LoadKind, Point, Terms};
use super::{Alternative, QuantityKind, ServoModel, ServoModelOptions, Spread, fit};
use crate::data::{Record, Run};
use crate::results::{Bounds, Interval, Reason};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use servoid_dynamics::{Dual, Grid, Scalar, Start, Stops, simulate};

const PERIOD_S: f64 = 0.002;

fn point(terms: Terms, value: impl Fn(Coordinate) -> f64) -> Point {
    let coordinates = terms.coordinates(1);
    Point {
        terms,
        values: coordinates.iter().map(|at| value(*at)).collect(),
        coordinates,
        radians: 1f64.to_radians(),
        friction_speed_share: FRICTION_SPEED_SHARE,
        run_offsets: Vec::new(),
        stops: Stops::default(),
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
        Coordinate::DeadBand => 0.11,
        Coordinate::Friction => 0.13,
        Coordinate::FrictionAtRest => 0.7,
        Coordinate::FrictionOfGears => 0.1,
        Coordinate::ConstantLoad => 0.2,
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
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let noise = |y: f64| -> f64 {
        let v: f64 = StandardNormal.sample(&mut random);
        y + 0.03 * v
    };
    response(point, input, 1e-4)
        .into_iter()
        .map(noise)
        .collect()
}

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
    for load in [LoadKind::TiltedPendulum, LoadKind::Air] {
        let terms = Terms {
            limit: true,
            two_speeds: true,
            dead_band: true,
            friction: true,
            friction_of_gears: true,
            load,
        };
        let (servo, input) = (point(terms, value), strokes(600));
        let physics = servo.physics(0, |i, value| Dual::<16>::variable(value, i));
        let grid = Grid::new(PERIOD_S, 0.0, 1e-3);
        let mut slopes = Vec::new();
        let start = Start::at_rest(0.3, Some(0.0));
        let constants = Start {
            output: Dual::constant(start.output),
            rate: Dual::constant(start.rate),
            command_before: start.command_before.map(Dual::constant),
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
            let close = |(k, slope): (usize, &[f64; 16])| {
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

#[test]
fn a_limited_servo_is_found_again() {
    let terms = Terms {
        limit: true,
        two_speeds: true,
        ..Terms::default()
    };
    let (servo, input) = (point(terms, value), strokes(2000));
    let record = Record::of_run(PERIOD_S, &input, noisy(&servo, &input, 1)).unwrap();
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    assert_eq!(found.terms, terms);
    assert!(found.fit.held_out_percent > 98.5, "{:?}", found.fit);
    for (name, truth) in super::quantities::values(&servo) {
        let quantity = found
            .quantities
            .iter()
            .find(|quantity| quantity.name == name)
            .unwrap();
        assert_eq!(quantity.other_fits, None);
        let interval = quantity.interval.valid().unwrap();
        assert!(interval.contains(truth), "{name}: {truth} {interval:?}");
        assert!(quantity.determined, "{name}: {quantity:?}");
    }
    let new = [vec![0.0; 20], vec![3.0; 200]].concat();
    let (predicted, truth) = (found.respond(&new, 0), response(&servo, &new, 1e-4));
    for ((value, half), truth) in predicted
        .value
        .iter()
        .zip(predicted.half_width.valid().unwrap())
        .zip(truth)
    {
        assert!(
            (value - truth).abs() <= half + 1e-6,
            "{value} {half} {truth}"
        );
    }
}

/// The motor has next to no damping of its own: full drive ends in no speed.
#[test]
fn a_servo_whose_acceleration_alone_is_limited_is_found_again() {
    let full_drive = 2500.0;
    let undamped = |at: Coordinate| match at {
        Coordinate::LnDamping => 60f64.ln(),
        Coordinate::LnStiffness => 3600f64.ln(),
        Coordinate::MotorShare => 1e-4,
        Coordinate::LnTopSpeed => (full_drive / (1e-4 * 60f64)).ln(),
        other => value(other),
    };
    let terms = Terms {
        limit: true,
        ..Terms::default()
    };
    let servo = point(terms, undamped);
    // Held twice as long, until it rests.
    let input: Vec<f64> = (strokes(4000).into_iter())
        .flat_map(|level| [level; 2])
        .collect();
    let record = Record::of_run(PERIOD_S, &input, noisy(&servo, &input, 1)).unwrap();
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    assert_eq!(found.terms, terms);
    for kind in [
        QuantityKind::Bandwidth,
        QuantityKind::DampingRatio,
        QuantityKind::ErrorOfFullDrive,
        QuantityKind::AccelerationUpwards,
        QuantityKind::TopSpeedUpwards,
    ] {
        let mut all = super::quantities::values(&servo).into_iter();
        let (_, truth) = all.find(|(name, _)| *name == kind.name()).unwrap();
        let interval = found.quantity(kind).unwrap().interval;
        assert!(
            interval.valid().unwrap().contains(truth),
            "{kind:?}: {truth} {interval:?}"
        );
    }
}

/// A position that follows the command by so much in a second at the most, up and down, and is otherwise there at once.
#[test]
fn a_servo_whose_speed_alone_is_limited_is_found_again() {
    const STEPS: usize = 100;
    let (delay_s, [up, down]) = (0.02, [40.0, 30.0]);
    let input = strokes(2400);
    let step_s = PERIOD_S / STEPS as f64;
    let late = (delay_s / step_s).round() as usize;
    let mut random = ChaCha8Rng::seed_from_u64(6);
    let mut position = input[0];
    let mut output = Vec::new();
    for step in 0..input.len() * STEPS {
        if step % STEPS == 0 {
            let v: f64 = StandardNormal.sample(&mut random);
            output.push(position + 0.03 * v);
        }
        let command = input[step.saturating_sub(late) / STEPS];
        position += (command - position).clamp(-down * step_s, up * step_s);
    }
    let record = Record::of_run(PERIOD_S, &input, &output).unwrap();
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    for (name, truth) in [
        ("delay", delay_s),
        ("gain", 1.0),
        ("top speed upwards", up),
        ("top speed downwards", down),
    ] {
        let mut named = found.quantities.iter().filter(|found| found.name == name);
        let quantity = named.next().unwrap();
        let interval = quantity.interval.valid().unwrap();
        assert!(
            quantity.determined && interval.contains(truth),
            "{name}: {truth} {quantity:?}"
        );
    }
    // Nothing shows how fast it would get there.
    let accelerations = found.quantities.iter();
    for quantity in accelerations.filter(|found| found.name.starts_with("acceleration")) {
        assert!(!quantity.determined, "{quantity:?}");
    }
}

/// Intervals of what follows from how the shaft rests and how fast it turns, by name.
fn require_intervals(servo: &Point, names: &[&str], seed: u64) {
    let input = strokes(3000);
    let record = Record::of_run(PERIOD_S, &input, noisy(servo, &input, seed)).unwrap();
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    for (name, truth) in super::quantities::values(servo) {
        let mut named = found.quantities.iter().filter(|found| found.name == name);
        if !names.contains(&name) {
            continue;
        }
        let interval = named.next().unwrap().interval.valid().unwrap();
        assert!(interval.contains(truth), "{name}: {truth} {interval:?}");
    }
}

#[test]
fn the_offset_of_a_loaded_servo_is_where_it_rests() {
    let loaded = Terms {
        limit: true,
        load: LoadKind::Constant,
        ..Terms::default()
    };
    let with = |terms, load: f64| {
        point(terms, |at| match at {
            Coordinate::DeadBand => 0.6,
            Coordinate::LnDownToUp => 0.5f64.ln(),
            Coordinate::ConstantLoad => load,
            other => value(other),
        })
    };
    let dead_band = Terms {
        dead_band: true,
        ..loaded
    };
    let unequal = Terms {
        two_speeds: true,
        ..loaded
    };
    // Beyond the edge of the dead band, and against the weaker side of the drive; all times the gain of 1.1.
    for (servo, rest) in [
        (with(dead_band, 0.8), 0.3 - 1.1 * (0.6 + 0.8)),
        (with(unequal, -0.72), 0.3 + 1.1 * (0.72 / 0.5)),
    ] {
        let physics = servo.physics(0, |_, value| value);
        assert!((physics.resting_output(0.0) - rest).abs() < 1e-9);
        require_intervals(&servo, &["offset"], 31);
    }
}

#[test]
fn upwards_is_where_the_output_grows() {
    let terms = Terms {
        limit: true,
        two_speeds: true,
        ..Terms::default()
    };
    let servo = point(terms, |at| match at {
        Coordinate::Gain => -1.1,
        other => value(other),
    });
    let input = [vec![0.0; 20], vec![100.0; 150], vec![-100.0; 300]].concat();
    let output = response(&servo, &input, 1e-4);
    let fastest = |sign: f64| {
        let speeds = output
            .windows(2)
            .map(|pair| sign * (pair[1] - pair[0]) / PERIOD_S);
        speeds.fold(0.0, f64::max)
    };
    let stated = super::quantities::values(&servo);
    let of = |name: &str| stated.iter().find(|(found, _)| *found == name).unwrap().1;
    for (name, sign) in [("upwards", 1.0), ("downwards", -1.0)] {
        let reached = fastest(sign) / of(&format!("top speed {name}"));
        assert!((0.95..1.0).contains(&reached), "{name}: {reached}");
    }
    assert!(of("acceleration upwards") > of("acceleration downwards"));
    let names = [
        "top speed upwards",
        "top speed downwards",
        "acceleration upwards",
    ];
    require_intervals(&servo, &names, 32);
}

/// 46 sines up to 4.6 Hz between two rests, of 20 degrees at the most. The controller is the same in both directions, which the equation does not
/// have, and the drive is not: 350 a second upwards, of which it reaches two thirds, and 225 downwards, which it reaches. Phases by draws.
fn unequal_drives(seed: u64) -> Record<'static> {
    const SAMPLES: usize = 4000;
    const STEPS: usize = 50;
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let phases: [f64; 46] =
        std::array::from_fn(|_| random.random_range(0.0..std::f64::consts::TAU));
    let sum = |k: usize| -> f64 {
        let t = 0.2 * std::f64::consts::PI * PERIOD_S * k as f64;
        let sines = phases.iter().zip(1..);
        sines
            .map(|(phase, n)| (f64::from(n) * t + phase).sin())
            .sum()
    };
    let moving = 300..SAMPLES - 300;
    let most = moving.clone().map(|k| sum(k).abs()).fold(0.0, f64::max);
    let command = |k: usize| match moving.contains(&k) {
        true => 20.0 * sum(k) / most,
        false => 0.0,
    };
    let input: Vec<f64> = (0..SAMPLES).map(command).collect();
    let (late, step_s) = (375, PERIOD_S / STEPS as f64);
    let (mut angle, mut speed, mut output) = (0.0, 0.0, Vec::new());
    for step in 0..SAMPLES * STEPS {
        if step % STEPS == 0 {
            let v: f64 = StandardNormal.sample(&mut random);
            output.push(angle + 0.05 * v);
        }
        let error = input[step.saturating_sub(late) / STEPS] - angle;
        let drive = f64::clamp(2500.0 * error - 10.0 * speed, -22_500.0, 35_000.0);
        speed += step_s * (drive - 100.0 * speed);
        angle += step_s * speed;
    }
    Record::of_run(PERIOD_S, input, output).unwrap()
}

/// Whether the limit is found at all depends on the phases; in none of these records was that of 350 a second at work.
#[test]
fn a_top_speed_whose_limit_was_not_at_work_is_open_above() {
    for seed in 0..6 {
        require_open_top_speed(seed, &unequal_drives(seed));
    }
}

/// The same motion of a servo that turns the other way: upwards is where the output grows.
#[test]
fn so_it_is_where_the_gain_is_negative() {
    for seed in 0..6 {
        let record = unequal_drives(seed);
        let run = &record.runs()[0];
        let input: Vec<f64> = run.input().iter().map(|u| -u).collect();
        let other_way = Record::of_run(PERIOD_S, input, run.output().to_vec()).unwrap();
        require_open_top_speed(seed, &other_way);
    }
}

fn require_open_top_speed(seed: u64, record: &Record) {
    let found = fit(record, &ServoModelOptions::default()).unwrap();
    let mut upwards = (found.quantities.iter()).filter(|q| q.name == "top speed upwards");
    let interval = upwards.next().and_then(|q| q.interval.valid().copied());
    let holds = interval.is_none_or(|found| found.upper.is_none_or(|upper| upper > 350.0));
    assert!(holds, "{seed}: {interval:?} {:?}", found.reached);
}

/// Random levels within ±5 degrees, held for 100 to 400 ms, and noise of 0.05 degrees. Towards larger angles the drive and the damping of the motor
/// are three quarters of those towards smaller ones, so that both top speeds are 24 degrees a second; the controller is the same.
fn unequal_motors(seed: u64) -> Record<'static> {
    const SAMPLES: usize = 1500;
    const STEPS: usize = 200;
    let (mut random, period_s) = (ChaCha8Rng::seed_from_u64(seed), 0.01);
    let mut input = Vec::new();
    while input.len() < SAMPLES {
        let level = random.random_range(-5.0..5.0);
        input.extend(std::iter::repeat_n(level, random.random_range(10..40)));
    }
    input.truncate(SAMPLES);
    let (late, step_s) = (250, period_s / STEPS as f64);
    let (mut angle, mut speed, mut noise, mut output) = (input[0], 0.0, 0.0, Vec::new());
    for step in 0..SAMPLES * STEPS {
        if step % STEPS == 0 {
            let v: f64 = StandardNormal.sample(&mut random);
            noise = 0.8 * noise + 0.03 * v;
            output.push(angle + noise);
        }
        let error = input[step.saturating_sub(late) / STEPS] - angle;
        let drive = f64::clamp(636.0 * error - 21.8 * speed, -880.0, 660.0);
        let motor = if speed < 0.0 { 36.6 } else { 27.45 };
        speed += step_s * (drive - motor * speed);
        angle += step_s * speed;
    }
    Record::of_run(period_s, input, output).unwrap()
}

/// The fit takes the unequal motor for a load, and a top speed that is 3 % too low for one with an interval of 2 %.
#[test]
fn a_motor_that_brakes_more_in_one_direction_has_no_false_top_speed() {
    for seed in 0..8 {
        let found = fit(&unequal_motors(seed), &ServoModelOptions::default()).unwrap();
        for kind in [
            QuantityKind::TopSpeedUpwards,
            QuantityKind::TopSpeedDownwards,
        ] {
            let quantity = found.quantity(kind).unwrap();
            let holds = |found: &Interval| found.contains(880.0 / 36.6);
            let holds = quantity.interval.valid().is_none_or(holds);
            assert!(holds, "{seed}: {quantity:?}");
        }
    }
}

#[test]
fn a_linear_servo_stays_linear() {
    let (servo, input) = (point(Terms::default(), value), strokes(2000));
    let record = Record::of_run(PERIOD_S, &input, noisy(&servo, &input, 2)).unwrap();
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    assert!(found.is_linear(), "{:?}", found.terms);
}

/// A shaft that is held has no gain, and a model of it has errors that are noise.
#[test]
fn a_servo_that_does_not_move_has_no_intervals() {
    let servo = point(Terms::default(), value);
    let output = noisy(&servo, &[0.0; 2000], 4);
    let record = Record::of_run(PERIOD_S, strokes(2000), output).unwrap();
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    assert_eq!(found.covariance.withdrawn(), Some(Reason::InputUnexcited));
}

/// Two levels of the command leave friction, gain and offset open between them.
#[test]
fn two_levels_have_no_intervals() {
    let terms = Terms {
        limit: true,
        friction: true,
        ..Terms::default()
    };
    let servo = point(terms, value);
    let input: Vec<f64> = (0..2000)
        .map(|k| if k / 150 % 2 == 0 { -5.0 } else { 5.0 })
        .collect();
    let record = Record::of_run(PERIOD_S, &input, noisy(&servo, &input, 3)).unwrap();
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    assert_eq!(found.covariance.withdrawn(), Some(Reason::InputUnexcited));
    for quantity in &found.quantities {
        assert!(quantity.interval.withdrawn().is_some());
        let Spread { least, most } = quantity.other_fits.unwrap();
        assert!(least <= quantity.value && quantity.value <= most);
    }
    // Between two levels fits to parts of the record agree on the time, and not on friction.
    let spread = |name: &str| {
        let mut named = found.quantities.iter().filter(|found| found.name == name);
        named.next().and_then(|found| found.other_fits).unwrap()
    };
    let delay = spread("delay");
    assert!(delay.most - delay.least < 2e-3, "{delay:?}");
    assert!(
        found.alternatives.is_empty() && found.respond(&[0.0, 1.0], 0).half_width.valid().is_none()
    );
    assert_eq!(found.fit.discrepancy, None);
    require_one_validity(&found);
}

/// A document that has bounds in one part and none in another is refused.
fn require_one_validity(withdrawn: &ServoModel) {
    assert!(withdrawn.is_consistent());
    let mut with_interval = withdrawn.clone();
    let quantity = &mut with_interval.quantities[0];
    quantity.interval = Bounds::Valid(Interval::new(quantity.value, 0.0, 1.0));
    assert!(!with_interval.is_consistent());
    let mut for_another_reason = withdrawn.clone();
    for_another_reason.quantities[0].interval = Bounds::Withdrawn(Reason::ErrorsNotNoise);
    assert!(!for_another_reason.is_consistent());
    let mut with_alternative = withdrawn.clone();
    let count = withdrawn.values.len();
    with_alternative.alternatives.push(Alternative {
        terms: withdrawn.terms,
        coordinates: withdrawn.coordinates.clone(),
        values: withdrawn.values.clone(),
        friction_speed_share: 0.1,
        covariance: vec![vec![0.0; count]; count],
    });
    assert!(!with_alternative.is_consistent());
}

/// Missing samples, a stop in the middle of the travel, a servo that is switched off half-way, a single stroke, a glitch: numbers
/// stay finite.
#[test]
fn recordings_of_poor_quality_give_finite_numbers() {
    let terms = Terms {
        limit: true,
        ..Terms::default()
    };
    let (servo, input) = (point(terms, value), strokes(800));
    let good = noisy(&servo, &input, 4);
    let changed = |of: &dyn Fn(usize, f64) -> f64| -> Vec<f64> {
        good.iter().enumerate().map(|(k, y)| of(k, *y)).collect()
    };
    let outputs = [
        changed(&|k, y| {
            if k % 17 == 3 || (300..340).contains(&k) {
                f64::NAN
            } else {
                y
            }
        }),
        changed(&|_, y| y.min(2.0)),
        changed(&|k, y| if k > 400 { 0.0 } else { y }),
        changed(&|k, y| if k == 200 { 1e6 } else { y }),
    ];
    let mut records: Vec<Record> = outputs
        .iter()
        .map(|output| Record::of_run(PERIOD_S, &input, output).unwrap())
        .collect();
    let gaps: Vec<f64> = input
        .iter()
        .enumerate()
        .map(|(k, u)| if k % 211 == 7 { f64::NAN } else { *u })
        .collect();
    records.push(Record::of_run(PERIOD_S, gaps, good).unwrap());
    let single = [vec![0.0; 40], vec![5.0; 100]].concat();
    records.push(Record::of_run(PERIOD_S, &single, noisy(&servo, &single, 5)).unwrap());
    for (number, record) in records.iter().enumerate() {
        let found = fit(record, &ServoModelOptions::default()).unwrap();
        assert!(
            found.values.iter().all(|value| value.is_finite()),
            "{number}: {found:?}"
        );
        assert!(
            found.fit.rmse.is_finite() && found.is_consistent(),
            "{number}: {found:?}"
        );
    }
}

#[test]
fn what_cannot_be_fitted_is_refused_with_a_sentence() {
    let short = Record::of_run(PERIOD_S, strokes(60), strokes(60)).unwrap();
    assert!(fit(&short, &ServoModelOptions::default()).is_err());
    let input = strokes(400);
    let runs: Vec<Run> = (0..40)
        .map(|_| Run::new(input.clone(), input.clone()).unwrap())
        .collect();
    let many = Record::new(PERIOD_S, runs).unwrap();
    let options = ServoModelOptions {
        controllers: (0..40).collect(),
        ..ServoModelOptions::default()
    };
    let error = fit(&many, &options).unwrap_err().to_string();
    assert!(error.contains("40 controllers"), "{error}");
}

#[test]
fn samples_too_far_apart_for_a_servo_are_refused_before_the_search() {
    let input = strokes(600);
    let record = Record::of_run(5.0, &input, &input).unwrap();
    let refused = fit(&record, &ServoModelOptions::default()).unwrap_err();
    assert!(refused.to_string().contains("5 s apart"), "{refused}");
}

/// Three runs of a limited servo, whose sensor's zero is `offsets` further up in each.
fn runs_with(offsets: [f64; 3]) -> (Point, Record<'static>) {
    let terms = Terms {
        limit: true,
        two_speeds: true,
        ..Terms::default()
    };
    let servo = point(terms, value);
    let input = strokes(2400);
    let run = |(index, offset): (usize, f64)| {
        let input = [&[0.0; 40][..], &input[800 * index..800 * (index + 1)]].concat();
        let output = noisy(&servo, &input, 20 + index as u64);
        Run::new(
            input,
            output.into_iter().map(|y| y + offset).collect::<Vec<_>>(),
        )
        .unwrap()
    };
    let runs = offsets.into_iter().enumerate().map(run).collect();
    (servo, Record::new(PERIOD_S, runs).unwrap())
}

#[test]
fn the_zero_of_the_sensor_may_move_between_runs() {
    let offsets = [0.5, -0.25, 2.0];
    let mean = offsets.iter().sum::<f64>() / 3.0;
    let (mut servo, record) = runs_with(offsets);
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    for (found, own) in found.run_offsets.iter().zip(offsets) {
        assert!((found - (own - mean)).abs() < 0.01, "{found} {own}");
    }
    let common = servo.get(Coordinate::Offset).unwrap();
    servo.set(Coordinate::Offset, common + mean);
    for (name, truth) in super::quantities::values(&servo) {
        let mut named = found.quantities.iter().filter(|found| found.name == name);
        let quantity = named.next().unwrap();
        let interval = quantity.interval.valid().unwrap();
        assert!(interval.contains(truth), "{name}: {truth} {interval:?}");
        // As wide as noise of 0.03 in 840 samples of each run makes it, not as wide as the offsets.
        assert!(
            name != "offset" || interval.upper.unwrap() - interval.lower.unwrap() < 0.04,
            "{interval:?}"
        );
    }
    // The zero of another run is found from that run.
    let (_, other) = runs_with([-1.0, 0.0, 4.0]);
    let fit_percent = found.validate(&other, &[]).unwrap().fit_percent;
    assert!(fit_percent > 98.0, "{fit_percent}");
}

#[test]
fn runs_that_do_not_differ_have_one_offset() {
    let (_, record) = runs_with([0.0; 3]);
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    assert!(found.run_offsets.is_empty(), "{:?}", found.run_offsets);
}

/// The servo stops at 2 degrees upwards. Downwards it goes to -5, and what is said to be a stop at -3 is none.
#[test]
fn of_two_stops_the_one_that_the_motion_shows_is_taken() {
    let terms = Terms {
        limit: true,
        ..Terms::default()
    };
    let mut servo = point(terms, value);
    servo.stops.upper = Some(2.0);
    let input = strokes(2400);
    let record = Record::of_run(PERIOD_S, &input, noisy(&servo, &input, 8)).unwrap();
    let options = ServoModelOptions {
        stops_at: vec![2.0, -3.0],
        ..ServoModelOptions::default()
    };
    let found = fit(&record, &options).unwrap();
    assert_eq!(found.stops, servo.stops);
    // With neither or both of them it predicts 60 to 90 %.
    assert!(found.fit.held_out_percent > 98.0, "{:?}", found.fit);
}
