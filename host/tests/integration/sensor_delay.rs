//! The delay of a sensor: stated in the rig file, taken out of the recording, and as uncertain in the result as it is.

use crate::support::{arg, run};
use serde_json::Value;
use servoid::data::recording::{Ending, Header, Recording, RecordingWriter};
use servoid_protocol::{Counts, Frame};
use std::path::{Path, PathBuf};

/// Samples in 4 ms, by which the sensor lags.
const LAG: usize = 2;

/// The same recording by a sensor that lags, with a header that states a delay (s).
fn lagging(recording: &Recording, path: &Path, [delay_s, uncertainty_s]: [f64; 2]) {
    let header = Header {
        sensor_delay_s: delay_s,
        sensor_delay_uncertainty_s: uncertainty_s,
        ..recording.header.clone()
    };
    let mut writer = RecordingWriter::create(path, false, &header).unwrap();
    for (index, rows) in recording.rows.chunks(10).enumerate() {
        let counts = |k: usize| {
            let shown = (10 * index + k).saturating_sub(LAG);
            recording.rows[shown].counts
        };
        let samples: [Counts; 10] = std::array::from_fn(counts);
        let frame = Frame {
            run: 1,
            index: index as u16,
            pulse: rows[0].pulse,
            samples,
        };
        writer.append(&frame).unwrap();
    }
    writer.finish(&Ending::Complete).unwrap();
}

fn identify(file: &Path) -> Value {
    let text = run(&["identify", arg(file), "--json", "--flight-model"]);
    serde_json::from_str(&text).unwrap()
}

fn interval(value: &Value) -> [f64; 3] {
    ["lower", "value", "upper"].map(|key| value[key].as_f64().unwrap())
}

#[test]
fn a_stated_delay_is_taken_out_and_its_uncertainty_is_in_all_times_from_the_edge() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    run(&["simulate", "--servo", "linear", "-o", arg(&at("exact.csv"))]);
    let recording = Recording::read(&at("exact.csv")).unwrap();
    lagging(&recording, &at("stated.csv"), [0.004, 0.001]);
    lagging(&recording, &at("unstated.csv"), [0.0, 0.0]);
    let [exact, stated, unstated] =
        ["exact.csv", "stated.csv", "unstated.csv"].map(|name| identify(&at(name)));
    // A hundredth of a sample: the last two samples of the recording are others.
    let close = |a: f64, b: f64| (a - b).abs() < 2e-5;
    for name in ["delay_s", "t50_s", "settling_time_s"] {
        let times = |model: &Value| interval(&model["metrics"][name]);
        let ([low, value, high], found) = (times(&exact), times(&stated));
        assert!(close(found[1], value), "{name}: {found:?} {value}");
        assert!(close(found[0], low - 0.001), "{name}: {found:?} {low}");
        assert!(close(found[2], high + 0.001), "{name}: {found:?} {high}");
    }
    for name in ["delay_s", "t50_s"] {
        let of = |model: &Value| interval(&model["metrics"][name])[1];
        assert!(close(of(&unstated), of(&exact) + 0.004), "{name}");
    }
    let metric = |model: &Value, name: &str| interval(&model["metrics"][name]);
    for name in ["rise_time_s", "dc_gain"] {
        let (found, expected) = (metric(&stated, name), metric(&exact, name));
        let same = found.iter().zip(expected).all(|(a, b)| close(*a, b));
        assert!(same, "{name}: {found:?} {expected:?}");
    }
    // Its group delay is longer than a quarter of its period: 1 ms moves the frequency by less than its share of that.
    let (found, expected) = (
        metric(&stated, "phase_minus_90_rad_s"),
        metric(&exact, "phase_minus_90_rad_s"),
    );
    assert!((found[1] / expected[1] - 1.0).abs() < 1e-3);
    let widened = (expected[0] - found[0]) / expected[1];
    assert!((0.005..0.05).contains(&widened), "{found:?} {expected:?}");

    let low_order = |model: &Value| interval(&model["flight_model"]["delay_s"]);
    let ([low, value, high], found) = (low_order(&exact), low_order(&stated));
    assert!((found[1] - value).abs() < 1e-4, "{found:?} {value}");
    assert!((high - low + 0.002 - (found[2] - found[0])).abs() < 1e-4);
    let advised = |model: &Value| model["advice"].to_string().contains("sensor_delay");
    assert_eq!(
        [&exact, &stated, &unstated].map(advised),
        [false, true, false]
    );
    assert_eq!(stated["sensor_delay_uncertainty_s"], 0.001);
    assert_eq!(exact.get("sensor_delay_uncertainty_s"), None);
}

/// A document of `compare`.
fn compare(files: [&PathBuf; 2]) -> Value {
    let text = run(&["compare", arg(files[0]), arg(files[1]), "--json"]);
    serde_json::from_str(&text).unwrap()
}

/// Half the width of the interval of the delay shift (ms).
fn shift_half_ms(compared: &Value) -> f64 {
    let [from, to] = [0, 1].map(|k| compared["bounds"]["delay_shift_s"][k].as_f64().unwrap());
    500.0 * (to - from)
}

/// A lag of 4 ms that may be the sensor's is no difference of servos, in recordings and in models; that of one sensor is on both sides.
#[test]
fn a_comparison_allows_for_what_the_delays_of_two_sensors_may_be() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    run(&["simulate", "--servo", "linear", "-o", arg(&at("exact.csv"))]);
    let recording = Recording::read(&at("exact.csv")).unwrap();
    for (name, delay) in [
        ("surely.csv", [0.0, 0.0]),
        ("perhaps.csv", [0.0, 0.004]),
        ("taken_out.csv", [0.004, 0.001]),
        ("taken_out_again.csv", [0.004, 0.001]),
    ] {
        lagging(&recording, &at(name), delay);
    }
    let [exact, surely, perhaps] = ["exact.csv", "surely.csv", "perhaps.csv"].map(at);
    let different = compare([&exact, &surely]);
    assert_eq!(different["verdict"], "different");
    let [model, of_perhaps] =
        [(&exact, "exact.json"), (&perhaps, "perhaps.json")].map(|(file, to)| {
            run(&["identify", arg(file), "-o", arg(&at(to))]);
            at(to)
        });
    for sides in [
        [&exact, &perhaps],
        [&perhaps, &exact],
        [&model, &of_perhaps],
    ] {
        let found = compare(sides);
        assert_eq!(found["verdict"], "undecided", "{sides:?}");
        let wider = shift_half_ms(&found) - shift_half_ms(&different);
        assert!((wider - 4.0).abs() < 0.01, "{wider}");
        let differences = found["differences"].as_array().unwrap();
        let delay = differences.iter().find(|row| row["metric"] == "delay_s");
        let [lower, upper] = ["lower", "upper"].map(|key| delay.unwrap()[key].as_f64().unwrap());
        assert!(lower <= 0.0 && upper >= 0.0, "{delay:?}");
        assert!(
            found["advice"]
                .to_string()
                .contains("may be off from each other by 4 ms")
        );
    }
    let one_sensor = compare([&at("taken_out.csv"), &at("taken_out_again.csv")]);
    let two_sensors = compare([&exact, &at("taken_out.csv")]);
    let wider = shift_half_ms(&two_sensors) - shift_half_ms(&one_sensor);
    assert!((wider - 1.0).abs() < 0.01, "{wider}");
    assert!(!one_sensor["advice"].to_string().contains("may be off"));
    let page = at("report.html");
    run(&[
        "report",
        arg(&exact),
        arg(&at("taken_out.csv")),
        "-o",
        arg(&page),
    ]);
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains("sensors of different delays, 0 and 4 ms"));
}

/// A recording without a delay is, but for its time and folder, what it was before there were any.
#[test]
fn without_a_delay_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("exact.csv");
    run(&["simulate", "--servo", "linear", "-o", arg(&file)]);
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(!text.contains("sensor_delay"), "{text:.2000}");
}
