//! Servos whose speed is cut off, as digital servos and simulations have it, and servos whose speed is not.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

use super::PERIOD_S;
use crate::data::Record;
use crate::servo_model::{QuantityKind, ServoModel, ServoModelOptions, fit};

/// Steps of the integration in a sample period: by Euler's rule in 20 µs, as a simulation would have it.
const STEPS: usize = 100;

/// How it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Motion {
    /// By an error and a damping, with an acceleration that may be limited.
    SecondOrder,
    /// At a speed that is proportional to the error, as far as speed and acceleration have no limits.
    Profile,
    /// By a drive with a limit, against the damping of its motor.
    Motor,
}

/// A servo of second order whose speed is cut off, drawn by `seed`; every other one has a largest acceleration, too.
struct Profiled {
    delay_s: f64,
    bandwidth: f64,
    damping_ratio: f64,
    speed: f64,
    acceleration: f64,
    random: ChaCha8Rng,
}

impl Profiled {
    fn new(seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut between = |low: f64, high: f64| random.random_range(low..high);
        let speed = between(200.0, 600.0);
        Self {
            delay_s: between(0.005, 0.015),
            bandwidth: between(30.0, 80.0),
            damping_ratio: between(0.7, 1.0),
            speed,
            acceleration: match seed % 2 {
                0 => f64::INFINITY,
                _ => speed / between(0.01, 0.04),
            },
            random,
        }
    }

    /// The speed after a step of the integration.
    fn next_speed(&self, motion: Motion, error: f64, speed: f64, step_s: f64) -> f64 {
        let stiffness = self.bandwidth.powi(2);
        let damping = 2.0 * self.damping_ratio * self.bandwidth;
        let most = self.acceleration;
        let change = match motion {
            Motion::SecondOrder => {
                (stiffness * error - damping * speed).clamp(-most, most) * step_s
            }
            Motion::Motor => ((stiffness * error).clamp(-most, most) - damping * speed) * step_s,
            Motion::Profile => {
                let wanted = (stiffness / damping * error).clamp(-self.speed, self.speed);
                (wanted - speed).clamp(-most * step_s, most * step_s)
            }
        };
        (speed + change).clamp(-self.speed, self.speed)
    }

    /// Strokes up to one of `largest` degrees to each side at random, under noise of 0.1 degrees.
    fn recorded(
        &mut self,
        motion: Motion,
        largest: &[f64],
        samples: usize,
    ) -> (Vec<f64>, Vec<f64>) {
        let mut input: Vec<f64> = Vec::new();
        while input.len() < samples {
            let largest = largest[self.random.random_range(0..largest.len())];
            let level = self.random.random_range(-largest..largest);
            let hold = self.random.random_range(75..300);
            input.extend(std::iter::repeat_n(level, hold));
        }
        input.truncate(samples);
        let step_s = PERIOD_S / STEPS as f64;
        let late = (self.delay_s / step_s).round() as usize;
        let (mut angle, mut speed) = (input[0], 0.0_f64);
        let mut output = Vec::new();
        for step in 0..samples * STEPS {
            if step % STEPS == 0 {
                let v: f64 = StandardNormal.sample(&mut self.random);
                output.push(angle + 0.1 * v);
            }
            let error = input[step.saturating_sub(late) / STEPS] - angle;
            speed = self.next_speed(motion, error, speed, step_s);
            angle += step_s * speed;
        }
        (input, output)
    }
}

fn near(found: &ServoModel, kind: QuantityKind, truth: f64, share: f64) -> Result<(), String> {
    let quantity = found.quantity(kind).ok_or("not there")?;
    match (quantity.value / truth - 1.0).abs() < share {
        true => Ok(()),
        false => Err(format!("{kind:?}: {} for {truth}", quantity.value)),
    }
}

/// Small and large strokes.
const MIXED: [f64; 4] = [5.0, 15.0, 40.0, 60.0];

/// Finds a servo of this seed again, which was recorded for `samples`.
fn find(motion: Motion, seed: u64, samples: usize) -> Result<(), String> {
    let mut servo = Profiled::new(seed);
    let (input, output) = servo.recorded(motion, &MIXED, samples);
    let record = Record::of_run(PERIOD_S, &input, &output).unwrap();
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    if !found.terms.speed_limit {
        return Err(format!("{:?}", found.terms));
    }
    near(&found, QuantityKind::Delay, servo.delay_s, 0.02)?;
    near(&found, QuantityKind::TopSpeedUpwards, servo.speed, 0.005)?;
    near(&found, QuantityKind::TopSpeedDownwards, servo.speed, 0.005)?;
    if servo.acceleration.is_finite() {
        near(
            &found,
            QuantityKind::AccelerationUpwards,
            servo.acceleration,
            0.05,
        )?;
    }
    Ok(())
}

#[test]
fn a_servo_whose_speed_is_cut_off_is_found_again() {
    for seed in [1, 2] {
        assert_eq!(find(Motion::SecondOrder, seed, 5000), Ok(()), "{seed}");
    }
}

/// Few strokes reach this limit, which takes away 16 % of the squared errors of a motor. That stood for it with a top speed of 421 deg/s, and no
/// intervals.
#[test]
fn a_speed_limit_that_few_strokes_reach_is_found() {
    let mut servo = Profiled {
        delay_s: 0.01,
        bandwidth: 50.0,
        damping_ratio: 0.7,
        speed: 300.0,
        acceleration: f64::INFINITY,
        random: ChaCha8Rng::seed_from_u64(1),
    };
    let (input, output) = servo.recorded(Motion::SecondOrder, &[11.0], 8000);
    let record = Record::of_run(PERIOD_S, &input, &output).unwrap();
    let found = fit(&record, &ServoModelOptions::default()).unwrap();
    assert!(found.terms.speed_limit, "{:?}", found.terms);
    let speed = found.quantity(QuantityKind::TopSpeedUpwards).unwrap();
    assert!(speed.interval.valid().unwrap().contains(300.0), "{speed:?}");
}

/// At its top speed the motor's damping takes half of the drive. The fit has an acceleration of three quarters of the drive, and its interval was a fifth to each side.
#[test]
fn a_motor_behind_a_speed_limit_has_no_false_acceleration() {
    const DRIVE: f64 = 60_000.0;
    for seed in 0..4 {
        let mut servo = Profiled {
            delay_s: 0.0072,
            bandwidth: 66.5,
            damping_ratio: 1.0,
            speed: 252.0,
            acceleration: DRIVE,
            random: ChaCha8Rng::seed_from_u64(seed),
        };
        let (input, output) = servo.recorded(Motion::Motor, &[25.0], 10_000);
        let record = Record::of_run(PERIOD_S, &input, &output).unwrap();
        let found = fit(&record, &ServoModelOptions::default()).unwrap();
        assert!(found.terms.speed_limit, "{:?}", found.terms);
        let acceleration = found.quantity(QuantityKind::AccelerationUpwards).unwrap();
        let interval = acceleration.interval.valid();
        assert!(
            interval.is_none_or(|found| found.contains(DRIVE)),
            "{seed}: {acceleration:?}"
        );
    }
}

/// A damping without end of the loop within, which no fit of the motor's own has.
#[test]
fn a_profile_of_speed_and_acceleration_is_found_again() {
    assert_eq!(find(Motion::Profile, 3, 5000), Ok(()));
}

#[test]
#[ignore = "half a minute: cargo test --release -p servoid-identification --lib speeds_that_are_cut_off -- --ignored"]
fn speeds_that_are_cut_off_are_found_again() {
    for motion in [Motion::SecondOrder, Motion::Profile] {
        // Without a limit of its own the acceleration of a profile has no end.
        let seeds = (100..106u64).filter(|seed| seed % 2 == 1 || motion == Motion::SecondOrder);
        let missed: Vec<String> = (seeds.collect::<Vec<_>>().into_par_iter())
            .filter_map(|seed| Some(format!("{seed}: {}", find(motion, seed, 10_000).err()?)))
            .collect();
        println!("{motion:?}: {missed:?}");
        assert!(missed.len() <= 1, "{motion:?}: {missed:?}");
    }
}
