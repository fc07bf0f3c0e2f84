//! Commands that wait for pulses on a clock of their own, of servos that are known.

use crate::support::{arg, json, run};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use serde_json::Value;
use servoid::data::model_file::ModelFile;
use servoid_dynamics::{DriveLimit, Grid, ServoParameters, Start, simulate};
use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Steps in which pulses come \[s\].
const STEP_S: f64 = 2.5e-5;

/// The command of a servo.
#[derive(Clone, Copy)]
enum Command {
    /// Random levels of up to 25 deg, held for random times.
    Levels,
    /// Sines of 0.4 to 6 Hz, written anew every 20 ms: such changes wait alike for pulses of exactly that length.
    Sines,
}

/// How a servo is recorded, for 48 s.
struct Recording {
    command: Command,
    seed: u64,
    /// Steps in a row.
    in_a_row: usize,
    /// From one pulse to the next, and until the first \[s\].
    frame_s: f64,
    first_s: f64,
    /// Standard deviation of the noise \[deg\].
    noise: f64,
}

impl Recording {
    /// The rows as a logger writes them.
    fn write(&self, servo: &ServoParameters, folder: &Path) -> PathBuf {
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        let row_s = self.in_a_row as f64 * STEP_S;
        let rows_of = |seconds: f64| (seconds / row_s) as usize;
        // Sines come to no rest by themselves.
        let rest_s = match self.command {
            Command::Levels => 0.2,
            Command::Sines => 2.0,
        };
        let mut rows = vec![0.0; rows_of(rest_s)];
        let phases: Vec<f64> = (0..15).map(|_| random.random_range(0.0..TAU)).collect();
        while rows.len() < rows_of(48.0) {
            let (level, held) = match self.command {
                Command::Levels => (
                    f64::from(random.random_range(-250..=250)) / 10.0,
                    rows_of(random.random_range(0.12..0.6)),
                ),
                Command::Sines => {
                    let turns = 0.4 * rows.len() as f64 * row_s;
                    let sines = phases
                        .iter()
                        .zip(1..)
                        .map(|(phase, number)| (TAU * f64::from(number) * turns + phase).sin());
                    (
                        (20.0 * sines.sum::<f64>()).round() / 10.0,
                        rows_of(0.02 + 0.5 * row_s),
                    )
                }
            };
            rows.extend(std::iter::repeat_n(level, held));
        }
        let (mut in_force, mut next_s) = (0.0, self.first_s);
        let steps = (0..rows.len() * self.in_a_row).map(|step| {
            if step as f64 * STEP_S >= next_s {
                in_force = rows[step / self.in_a_row];
                next_s += self.frame_s;
            }
            in_force
        });
        let steps: Vec<f64> = steps.collect();
        let start = Start::at_rest(servo.resting_output(0.0), Some(0.0));
        let grid = Grid::new(STEP_S, 0.0, STEP_S);
        let mut text = "t_s,u_deg,y_deg\n".to_owned();
        simulate(servo, &grid, &start, &steps, |step, y| {
            if step % self.in_a_row == 0 {
                let row = step / self.in_a_row;
                let y = y + self.noise * random.sample::<f64, _>(StandardNormal);
                writeln!(text, "{:.4},{},{y:.4}", row as f64 * row_s, rows[row]).unwrap();
            }
        });
        let file = folder.join(format!("{}.csv", self.seed));
        std::fs::write(&file, text).unwrap();
        file
    }
}

/// The model file of a recording, and what is said of it.
fn identified(recording: &Path) -> (PathBuf, String) {
    let model = recording.with_extension("json");
    let said = run(&[
        "identify",
        arg(recording),
        "--input",
        "u_deg",
        "--output",
        "y_deg",
        "--servo-model",
        "-o",
        arg(&model),
    ]);
    (model, said)
}

/// The ends of an interval, where the servo model has it.
fn ends(servo_model: &Value, name: &str) -> Option<[f64; 2]> {
    let mut all = servo_model["quantities"].as_array()?.iter();
    let quantity = all.find(|one| one["name"] == name && one["determined"] == true)?;
    let end = |end: &str| quantity["bounds"][end].as_f64();
    Some([end("lower")?, end("upper")?])
}

#[test]
fn a_servo_behind_pulses_of_their_own_clock_is_known_with_intervals() {
    let folder = tempfile::tempdir().unwrap();
    let servo = ServoParameters {
        delay_s: 0.0062,
        gain: 0.9,
        offset: 0.3,
        play: Some(0.4),
        limit: Some(DriveLimit {
            up: 9000.0,
            down_to_up: 1.0,
            motor_damping: 25.0,
            at_one_stiffness: false,
        }),
        ..ServoParameters::linear(2000.0, 75.0)
    };
    // The clock of the pulses is slower than that of the rows by 1 part in 5000, on another day by less.
    let frame_s = 0.020_004;
    let days = [(1, 0.0071, frame_s), (2, 0.0133, 0.020_001)];
    let [first, second] = days.map(|(seed, first_s, frame_s)| {
        let recording = Recording {
            seed,
            in_a_row: 160,
            command: Command::Levels,
            frame_s,
            first_s,
            noise: 0.05,
        };
        recording.write(&servo, folder.path())
    });
    let (model, said) = identified(&first);
    assert!(said.contains("waited for pulses 20.0 ms apart"), "{said}");
    let found = &json(&model)["servo_model"];
    let waits = &found["fit"]["waits_for_pulses"];
    let found_s = waits["frame_s"].as_f64().unwrap();
    // The search ends with steps that move a pulse at the end of the 48 s by a four-hundredth of a frame: a few of these.
    let off = (found_s / frame_s - 1.0).abs();
    assert!(off < 0.02 * frame_s / 48.0, "{found_s}");
    for (name, truth) in [
        ("delay", 0.0062),
        ("gain", 0.9),
        ("play, whole width", 0.36),
    ] {
        let [lower, upper] = ends(found, name).unwrap();
        assert!(lower < truth && truth < upper, "{name}: {lower} .. {upper}");
    }
    // Less than a row, where the mean wait alone is 10 ms.
    let [lower, upper] = ends(found, "delay").unwrap();
    assert!(upper - lower < 3e-3, "{lower} .. {upper}");

    let validate = ["validate", arg(&model), arg(&second), "--json"];
    let validated: Value = serde_json::from_str(&run(&validate)).unwrap();
    let fit = validated["servo_model"]["fit_percent"].as_f64().unwrap();
    // Noise of 0.05 of a motion of 13 deg leaves 99.6 %; commands at their rows, 94 %.
    assert!(fit > 99.4, "{fit}");

    let header = folder.path().join("servo.h");
    let export = ["export", arg(&model), "--to", "c", "--servo-model", "-o"];
    run(&[&export[..], &[arg(&header)]].concat());
    let text = std::fs::read_to_string(header).unwrap();
    let one_line = text.replace("\n * ", " ");
    let frame = "Put a sample and hold of 20.0 ms before it";
    assert!(one_line.contains(frame), "{one_line}");
}

#[test]
fn a_linear_servo_behind_pulses_is_linear() {
    let folder = tempfile::tempdir().unwrap();
    let servo = ServoParameters {
        delay_s: 0.0073,
        ..ServoParameters::linear(2500.0, 70.0)
    };
    let recording = Recording {
        seed: 4,
        in_a_row: 200,
        command: Command::Sines,
        frame_s: 0.02007,
        first_s: 0.0044,
        noise: 0.05,
    };
    let (model, said) = identified(&recording.write(&servo, folder.path()));
    assert!(said.starts_with("This servo is linear"), "{said}");
    assert!(
        said.contains("Commands waited for pulses 20.1 ms apart"),
        "{said}"
    );
    let document = json(&model);
    assert_eq!(document["linear"], true);
    let [lower, upper] = ends(&document["servo_model"], "delay").unwrap();
    assert!(lower < 0.0073 && 0.0073 < upper, "{lower} .. {upper}");
    assert!(upper - lower < 1e-3, "{lower} .. {upper}");
}

/// A servo with a limit of the drive and perhaps play, and a recording of it.
fn drawn(seed: u64, command: Command) -> (ServoParameters, Recording) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut between = |low: f64, high: f64| random.random_range(low..high);
    let bandwidth = between(25.0, 60.0);
    let damping = 2.0 * between(0.6, 1.1) * bandwidth;
    let full_drive = between(2.0, 8.0);
    let servo = ServoParameters {
        delay_s: between(0.003, 0.012),
        gain: between(0.7, 1.2),
        offset: between(-1.0, 1.0),
        play: (between(0.0, 2.0) < 1.0).then_some(between(0.1, 1.0)),
        limit: Some(DriveLimit {
            up: bandwidth * bandwidth * full_drive,
            down_to_up: between(0.8, 1.25),
            motor_damping: damping * between(0.2, 0.6),
            at_one_stiffness: false,
        }),
        ..ServoParameters::linear(bandwidth * bandwidth, damping)
    };
    // Crystals, and the ceramic resonators of small boards.
    let off = match command {
        Command::Levels => 2e-4,
        Command::Sines => 0.02,
    };
    let recording = Recording {
        seed,
        in_a_row: [80, 120, 160, 200][seed as usize % 4],
        command,
        frame_s: 0.02 * (1.0 + between(-1.0, 1.0) * off),
        first_s: between(0.0, 0.02),
        noise: between(0.03, 0.1),
    };
    (servo, recording)
}

/// What the servo model of a recording says and what is true, where it has intervals.
fn known(servo_model: &Value, servo: &ServoParameters) -> Vec<(&'static str, f64, [f64; 2])> {
    let limit = servo.limit.unwrap();
    let (top, full) = (limit.up / limit.motor_damping, limit.up);
    let truths = [
        ("delay", servo.delay_s),
        ("gain", servo.gain),
        ("offset", servo.offset),
        ("play, whole width", servo.gain * servo.play.unwrap_or(0.0)),
        ("top speed upwards", servo.gain * top),
        ("top speed downwards", servo.gain * top * limit.down_to_up),
        ("acceleration upwards", servo.gain * full),
        (
            "acceleration downwards",
            servo.gain * full * limit.down_to_up,
        ),
    ];
    let known = truths.map(|(name, truth)| Some((name, truth, ends(servo_model, name)?)));
    known.into_iter().flatten().collect()
}

/// The share of the moments of a new command at which the band of the model holds the motion of the servo, where it has one.
fn inside(model: &Path, servo: &ServoParameters, row_s: f64) -> Option<f64> {
    let model = ModelFile::read(model)
        .unwrap()
        .servo_model()
        .unwrap()?
        .model;
    let levels = [0.0, 3.0, -12.0, 14.0, 13.0, -5.0, 6.0, 0.0];
    let held = (0.3 / row_s) as usize;
    let input: Vec<f64> = levels.iter().flat_map(|level| vec![*level; held]).collect();
    let response = model.respond(&input, 0);
    let half_width = response.half_width.into_valid()?;
    let start = Start::at_rest(servo.resting_output(0.0), Some(0.0));
    let mut holds = 0;
    let grid = Grid::new(row_s, 0.0, STEP_S);
    simulate(servo, &grid, &start, &input, |k, y| {
        holds += usize::from((y - response.value[k]).abs() <= half_width[k]);
    });
    Some(holds as f64 / input.len() as f64)
}

/// Prints how many of `SERVOS` recordings, from the number `FIRST` on and with `SINES` of sums of sines, have intervals, and which of these miss the truth.
#[test]
#[ignore = "minutes"]
fn coverage_behind_pulses_of_their_own_clock() {
    let asked = |name: &str| std::env::var(name).ok()?.parse().ok();
    let first = asked("FIRST").unwrap_or(1001);
    let servos = asked("SERVOS").unwrap_or(24);
    let command = match std::env::var("SINES") {
        Ok(_) => Command::Sines,
        Err(_) => Command::Levels,
    };
    let folder = tempfile::tempdir().unwrap();
    let (mut with_intervals, mut intervals, mut missed) = (0, 0, Vec::new());
    let mut bands = Vec::new();
    for seed in first..first + servos {
        let (servo, recording) = drawn(seed, command);
        let (model, _) = identified(&recording.write(&servo, folder.path()));
        bands.extend(inside(&model, &servo, recording.in_a_row as f64 * STEP_S));
        let known = known(&json(&model)["servo_model"], &servo);
        with_intervals += usize::from(!known.is_empty());
        intervals += known.len();
        let misses = known
            .into_iter()
            .filter(|(_, truth, [low, high])| !(*low..=*high).contains(truth));
        missed.extend(misses.map(|miss| (seed, miss)));
    }
    let hold = intervals - missed.len();
    println!("{with_intervals} of {servos} recordings have intervals, {hold} of {intervals} hold");
    let mean = bands.iter().sum::<f64>() / bands.len() as f64;
    println!(
        "missed: {missed:?}; inside of {} bands in the mean: {mean}",
        bands.len()
    );
    // 99 % of them, and as many again by chance.
    assert!(missed.len() * 50 <= intervals, "{missed:?}");
    assert!(bands.is_empty() || mean > 0.98, "{bands:?}");
}
