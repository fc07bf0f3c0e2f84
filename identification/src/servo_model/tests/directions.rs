//! What differs between the two directions of the motion.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::{PERIOD_S, point, require_intervals, response, value};
use crate::data::Record;
use crate::results::Interval;
use crate::servo_model::descent::coordinates::{Coordinate, Terms};
use crate::servo_model::{QuantityKind, ServoModelOptions, fit, quantities};

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
    let stated = quantities::values(&servo, 0.0);
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

/// A servo whose controller is the same in both directions, which the equation does not have, and whose drive is not.
struct UnequalDrives {
    delay_s: f64,
    /// Drive for each unit of error, and of speed less.
    controller: [f64; 2],
    /// Damping of the motor.
    motor: f64,
    /// The least and the largest drive.
    drive: [f64; 2],
}

impl UnequalDrives {
    /// Its motion from rest at 0 under `input`, with noise of 0.05 degrees.
    fn record(&self, input: Vec<f64>, random: &mut ChaCha8Rng) -> Record<'static> {
        const STEPS: usize = 50;
        let step_s = PERIOD_S / STEPS as f64;
        let late = (self.delay_s / step_s).round() as usize;
        let ([stiffness, damping], [least, largest]) = (self.controller, self.drive);
        let (mut angle, mut speed, mut output) = (0.0, 0.0, Vec::new());
        for step in 0..input.len() * STEPS {
            if step % STEPS == 0 {
                let v: f64 = StandardNormal.sample(random);
                output.push(angle + 0.05 * v);
            }
            let error = input[step.saturating_sub(late) / STEPS] - angle;
            let drive = f64::clamp(stiffness * error - damping * speed, least, largest);
            speed += step_s * (drive - self.motor * speed);
            angle += step_s * speed;
        }
        Record::of_run(PERIOD_S, input, output).unwrap()
    }
}

/// 46 sines up to 4.6 Hz between two rests, of 20 degrees at the most. The drive is good for 350 a second upwards, of which it reaches two thirds, and 225 downwards, which it reaches. Phases by draws.
fn unequal_drives(seed: u64) -> Record<'static> {
    const SAMPLES: usize = 4000;
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
    UnequalDrives {
        delay_s: 0.015,
        controller: [2500.0, 10.0],
        motor: 100.0,
        drive: [-22_500.0, 35_000.0],
    }
    .record(input, &mut random)
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
fn a_top_speed_is_open_above_where_the_gain_is_negative_too() {
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

/// Random levels within ±35 degrees, held for 60 to 360 ms. The drive alone is weaker downwards, by 15 %, and nothing loads the servo. That is exactly the motion of a servo of equal drives under a constant load.
fn weaker_downwards(seed: u64) -> Record<'static> {
    const SAMPLES: usize = 6000;
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut input = vec![0.0; 200];
    while input.len() < SAMPLES {
        let level = random.random_range(-35.0..35.0);
        input.extend(std::iter::repeat_n(level, random.random_range(30..180)));
    }
    input.truncate(SAMPLES);
    UnequalDrives {
        delay_s: 0.012,
        controller: [2025.0, 47.0],
        motor: 25.0,
        drive: [-7437.5, 8750.0],
    }
    .record(input, &mut random)
}

/// Accelerations of the drive alone would be those of one of the two servos.
#[test]
fn accelerations_are_those_of_a_load_and_of_unequal_drives() {
    for seed in 0..4 {
        let found = fit(&weaker_downwards(seed), &ServoModelOptions::default()).unwrap();
        for (kind, truth) in [
            (QuantityKind::AccelerationUpwards, 8750.0),
            (QuantityKind::AccelerationDownwards, 7437.5),
            (QuantityKind::TopSpeedUpwards, 350.0),
            (QuantityKind::TopSpeedDownwards, 297.5),
        ] {
            let quantity = found.quantity(kind).unwrap();
            let holds = |found: &Interval| found.contains(truth);
            let holds = quantity.interval.valid().is_some_and(holds);
            assert!(holds, "{seed}: {quantity:?}");
        }
    }
}
