//! What a file says of its error beside the servo itself, against servos that are known.

use super::subjects::{export, number_behind, prose};
use crate::support::{arg, run};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use servoid::data::model_file::ModelFile;
use servoid_dynamics::{DriveLimit, Grid, ServoParameters, Start, simulate};
use std::fmt::Write;
use std::path::Path;

const PERIOD_S: f64 = 0.005;

/// A servo whose drive is limited, with play or without.
fn servo(play: Option<f64>) -> ServoParameters {
    ServoParameters {
        delay_s: 0.011,
        offset: 0.3,
        limit: Some(DriveLimit {
            up: 4000.0,
            down_to_up: 0.8,
            motor_damping: 15.0,
            at_one_stiffness: false,
        }),
        play,
        ..ServoParameters::linear(1600.0, 64.0)
    }
}

fn motion(servo: &ServoParameters, command: &[f64]) -> Vec<f64> {
    let start = Start::at_rest(servo.resting_output(command[0]), Some(command[0]));
    let mut output = Vec::new();
    let grid = Grid::new(PERIOD_S, 0.0, 1e-5);
    simulate(servo, &grid, &start, command, |_, y| output.push(y));
    output
}

/// A minute of random levels, held for random times, in noise of 0.05 deg.
fn recording(servo: &ServoParameters, seed: u64, at: &Path) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut command = vec![0.0; 40];
    while command.len() < 12_000 {
        let level = f64::from(random.random_range(-150..=150)) / 10.0;
        let samples = random.random_range(20..120);
        command.extend(std::iter::repeat_n(level, samples));
    }
    let mut text = "t_s,u_deg,y_deg\n".to_owned();
    for (k, (u, y)) in command.iter().zip(motion(servo, &command)).enumerate() {
        let noise = 0.05 * random.sample::<f64, _>(StandardNormal);
        writeln!(text, "{:.3},{u},{:.4}", k as f64 * PERIOD_S, y + noise).unwrap();
    }
    std::fs::write(at, text).unwrap();
}

#[test]
fn the_servo_itself_is_as_near_as_the_file_says() {
    let folder = tempfile::tempdir().unwrap();
    for (seed, play) in [(1, None), (2, Some(0.5))] {
        let truth = servo(play);
        let [csv, json] = ["csv", "json"].map(|kind| folder.path().join(format!("{seed}.{kind}")));
        recording(&truth, seed, &csv);
        run(&[
            "identify",
            arg(&csv),
            "--input",
            "u_deg",
            "--output",
            "y_deg",
            "--servo-model",
            "-o",
            arg(&json),
            "-q",
        ]);
        let said = prose(&export(&json, 0, "c", &[]).text);
        let widest = number_behind(&said, "recorded: up to ");
        let rms = number_behind(&said, "known least, and up to ");
        let (_, levels) = said.split_once("rms, under the commands ").unwrap();
        let (levels, times) = levels.split_once(" deg, held for ").unwrap();
        let held_s = number_behind(&format!("for {times}"), "for ");
        let broken_off_s = number_behind(times, "then again for ");
        let levels: Vec<f64> = levels
            .split(", ")
            .map(|level| level.parse().unwrap())
            .collect();
        let stairs = |seconds: f64| {
            let samples = (seconds / PERIOD_S).round() as usize;
            levels
                .iter()
                .flat_map(move |level| std::iter::repeat_n(*level, samples))
        };
        let command: Vec<f64> = stairs(held_s).chain(stairs(broken_off_s)).collect();
        let model = ModelFile::read(&json)
            .unwrap()
            .servo_model()
            .unwrap()
            .unwrap()
            .model
            .clone();
        let positions = model.respond(&command, 0).value;
        let errors: Vec<f64> = (motion(&truth, &command).iter().zip(&positions))
            .map(|(a, b)| (a - b).abs())
            .collect();
        let largest = errors.iter().copied().fold(0.0, f64::max);
        let mean = errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64;
        assert!(largest < widest, "{seed}: {largest} {widest}");
        assert!(
            mean.sqrt() < rms && rms < widest,
            "{seed}: {} {rms}",
            mean.sqrt()
        );
        // It says something: the largest stroke is of 30 deg.
        assert!(widest < 1.5, "{seed}: {widest}");
    }
}
