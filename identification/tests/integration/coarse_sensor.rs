//! Sensors whose steps are as large as their noise, or larger: what the steps explain is not laid to the servo, and what they do not explain is.

use rand_chacha::ChaCha8Rng;
use servoid_identification::results::{Model, Reason};
use servoid_identification::{Options, Record, identify};
use servoid_test_support::plants::{normal, random};

/// A sensor: the standard deviation of its noise, and its steps \[deg\].
#[derive(Clone, Copy)]
struct Sensor {
    noise: f64,
    step: f64,
}

/// A servo of second order.
#[derive(Clone, Copy)]
struct Servo {
    /// \[rad/s\]
    frequency: f64,
    damping: f64,
    /// Position under command 0 \[deg\].
    offset: f64,
}

impl Servo {
    /// Its angle at each sample, without the offset, from rest at `angle` on.
    fn motion(self, input: &[f64], mut angle: f64) -> Vec<f64> {
        const PARTS: u32 = 100;
        let part_s = 0.01 / f64::from(PARTS);
        let mut speed = 0.0;
        let after = |command: &f64| {
            let before = angle;
            for _ in 0..PARTS {
                let damped = 2.0 * self.damping * self.frequency * speed;
                speed += (self.frequency.powi(2) * (command - angle) - damped) * part_s;
                angle += speed * part_s;
            }
            before
        };
        input.iter().map(after).collect()
    }
}

/// 40 s, sampled every 10 ms, from rest at the first level on. Each level is held for a number of samples.
fn identified(
    servo: Servo,
    mut level: impl FnMut(&mut ChaCha8Rng) -> (f64, usize),
    sensor: Sensor,
    seed: u64,
) -> Model {
    let mut random = random(seed);
    let mut input = Vec::new();
    while input.len() < 4000 {
        let (level, hold) = level(&mut random);
        input.extend(vec![level; hold]);
    }
    let motion = servo.motion(&input, input[0]);
    let output: Vec<f64> = motion
        .iter()
        .map(|angle| {
            let seen = servo.offset + angle + sensor.noise * normal(&mut random);
            (seen / sensor.step).round() * sensor.step
        })
        .collect();
    let record = Record::of_run(0.01, input, output).unwrap();
    identify(&record, &Options::default()).unwrap()
}

const SLOW: Servo = Servo {
    frequency: 7.0,
    damping: 0.9,
    offset: 0.3,
};

/// A servo that takes .8 s under equal holds of .6 s: the reference repeats itself before the response is over. Either no bounds are given, or, where the
/// steps make levels that are off, bounds that hold the response.
#[test]
fn steps_of_a_sensor_hide_no_response_that_goes_on() {
    let truth = SLOW.motion(&[1.0; 200], 0.0);
    for (noise, step) in [(0.05, 0.1), (0.05, 0.2)] {
        for seed in 0..10 {
            let mut which = 0;
            let level = |_: &mut ChaCha8Rng| {
                which += 1;
                ([0.0, 15.0, 0.0, -15.0][which % 4], 60)
            };
            let model = identified(SLOW, level, Sensor { noise, step }, seed);
            if let Some(bounds) = model.step.bounds.valid() {
                let band = &bounds.simultaneous;
                let band = band.lower.iter().zip(&band.upper);
                let missed = band.zip(&truth).filter(|((l, u), t)| t < l || t > u);
                assert_eq!(missed.count(), 0, "steps of {step}, seed {seed}");
                continue;
            }
            let reason = model.bounds.withdrawn();
            assert!(
                matches!(reason, Some(Reason::ResponseNotOver | Reason::EndUnseen)),
                "steps of {step}, seed {seed}: {reason:?}"
            );
        }
    }
}

/// Two levels are seen at two codes each time, wrong by up to half a step: that bends no servo.
#[test]
fn steps_of_a_sensor_bend_no_servo() {
    for seed in 0..12 {
        let mut up = false;
        let level = |random: &mut ChaCha8Rng| {
            let hold = 20 + (20.0 * normal(random).abs()) as usize;
            up = !up;
            (if up { 11.04 } else { -11.04 }, hold)
        };
        let coarse = Sensor {
            noise: 0.05,
            step: 1.0,
        };
        let servo = Servo {
            frequency: 45.0,
            damping: 0.65,
            offset: 0.27 * f64::from(u32::try_from(seed).unwrap()),
        };
        let model = identified(servo, level, coarse, seed);
        assert!(model.linear, "seed {seed}: {:?}", model.residuals);
        let gain = model.metrics.dc_gain;
        assert!(gain.contains(1.0), "seed {seed}: {gain:?}");
    }
}

/// Equal holds of ten times the lag, steps of a fifth of the strokes: what the steps make of the end of a hold is no motion after it.
#[test]
fn steps_of_a_sensor_move_no_servo_a_hold_later() {
    for seed in 0..6 {
        let mut which = 0;
        let level = |_: &mut ChaCha8Rng| {
            which += 1;
            (
                [0.0, 10.0, 20.0, 10.0, 0.0, -10.0, -20.0, -10.0][which % 8],
                80,
            )
        };
        let coarse = Sensor {
            noise: 0.05,
            step: 2.0,
        };
        let servo = Servo {
            frequency: 30.0,
            damping: 1.4,
            offset: 0.0,
        };
        let model = identified(servo, level, coarse, seed);
        let reason = model.bounds.withdrawn();
        assert!(
            reason != Some(Reason::ErrorsNotNoise),
            "seed {seed}: {:?}",
            model.advice
        );
    }
}
