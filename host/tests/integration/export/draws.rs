//! Servos at random from a model file, as docs/for-a-simulator.md draws them, and what their numbers are in the equation.

use super::servo_model::SERVOS;
use super::works;
use crate::support::{arg, json, run};
use servoid_test_support::tools::missing;
use std::path::Path;
use std::process::Command;

fn page(name: &str) -> String {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    std::fs::read_to_string(docs.join(name)).unwrap()
}

/// The constant of a header.
fn constant(header: &str, name: &str) -> f64 {
    let (_, rest) = header.split_once(&format!("_{name} = ")).unwrap();
    let (number, _) = rest.split_once(';').unwrap();
    number.parse().unwrap()
}

/// Stairs of the simulated bench servo, which determine it.
fn servo(folder: &Path) -> std::path::PathBuf {
    let [record, model] = ["mine.csv", "mine.json"].map(|name| folder.join(name));
    let stairs = [
        "--reference",
        "stairs",
        "--amplitude",
        "20",
        "--length",
        "20",
    ];
    let simulate = ["simulate", "--servo", "bench", "-q", "-o", arg(&record)];
    run(&[&simulate[..], &stairs].concat());
    run(&[
        "identify",
        arg(&record),
        "--servo-model",
        "-q",
        "-o",
        arg(&model),
    ]);
    model
}

#[test]
fn the_example_of_the_page_writes_servos_that_scatter_by_the_covariance() {
    if !works("python3", &["-c", "import numpy"]) {
        return missing("draws from a model file", "there is no python3 with numpy");
    }
    let folder = tempfile::tempdir().unwrap();
    let model = json(&servo(folder.path()))["servo_model"].clone();
    let text = page("for-a-simulator.md");
    let (_, example) = text.split_once("```python\n").unwrap();
    let (example, _) = example.split_once("```").unwrap();
    let program = Path::new(env!("CARGO_BIN_EXE_servoid")).parent().unwrap();
    let path = std::env::var("PATH").unwrap_or_default();
    let mut python = Command::new("python3");
    python.args(["-c", example]).current_dir(folder.path());
    let output = python
        .env("PATH", format!("{}:{path}", program.display()))
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );

    let coordinates = model["coordinates"].as_array().unwrap();
    let at = |name: &str| coordinates.iter().position(|found| found == name).unwrap();
    let headers = (0..20).map(|number| {
        let file = folder.path().join(format!("servo_draw_{number}.h"));
        std::fs::read_to_string(file).unwrap()
    });
    let headers: Vec<String> = headers.collect();
    for (name, of) in [("stiffness", "ln_stiffness"), ("damping", "ln_damping")] {
        let found = headers.iter().map(|header| constant(header, name).ln());
        let place = at(of);
        let mean = model["values"][place].as_f64().unwrap();
        let sd = model["bounds"]["rows"][place][place]
            .as_f64()
            .unwrap()
            .sqrt();
        let squares: f64 = found.map(|value| ((value - mean) / sd).powi(2)).sum();
        // χ² of 20 numbers, between its 0.05 % and 99.95 % points.
        assert!((4.5..49.0).contains(&squares), "{name}: {squares}");
    }
}

/// Each row of the table in docs/servo-model.md, on a servo that has it.
#[test]
fn the_coordinates_are_in_the_equation_as_the_page_says() {
    let folder = tempfile::tempdir().unwrap();
    let table = page("servo-model.md");
    for servo in SERVOS {
        let model = json(&servo.file(folder.path()))["servo_model"].clone();
        let names = model["coordinates"].as_array().unwrap().clone();
        let values = model["values"].as_array().unwrap().clone();
        for name in names.iter().filter_map(|name| name.as_str()) {
            assert!(table.contains(&format!("`{name}`")), "{name}");
        }
        let get = |wanted: &str| {
            let place = names.iter().position(|name| name == wanted)?;
            values[place].as_f64()
        };
        let of = |wanted: &str| get(wanted).unwrap_or(0.0);
        let own = names.iter().position(|name| name.is_object());
        let own = own.map_or(0.0, |place| values[place].as_f64().unwrap());
        let (k, c) = (of("ln_stiffness").exp(), of("ln_damping").exp());
        let of_loop = 1.0 - of("spring");
        let b = of("motor_share") * c;
        let header = servo.export("c", folder.path(), &[]).text;
        let mut expected = vec![
            ("stiffness", k * of_loop * own.exp()),
            ("damping", c),
            ("motor_damping", b),
            ("gain", of("gain") / of_loop),
            ("offset", of("offset")),
            ("dead_band", of("dead_band")),
            ("play", of("play")),
            ("friction", of("friction") * k),
            ("friction_at_rest", of("friction_at_rest")),
            ("friction_of_gears", of("friction_of_gears")),
        ];
        let ratio = of("ln_down_to_up").exp();
        if let Some(top) = get("ln_top_speed") {
            expected.extend([("full_drive", b * top.exp()), ("down_to_up", ratio)]);
        }
        if let Some(top) = get("ln_speed_limit") {
            expected.extend([
                ("highest_speed", top.exp()),
                ("lowest_speed", -ratio * top.exp()),
            ]);
        }
        let accelerated = get("ln_acceleration").map(|a| ("full_drive", a.exp()));
        expected.extend(accelerated);
        if get("friction_at_rest").is_some() {
            let top = get("ln_top_speed").unwrap_or(of("ln_speed_limit"));
            expected.push(("friction_speed", 0.05 * top.exp()));
        }
        let loads = [
            ("constant_load", "load_constant", k),
            ("spring", "load_rate", k),
            ("gravity", "load_gravity", k),
            ("gravity_from", "load_from", 1.0),
            ("air_stiffening", "load_stiffening", k),
            ("air_from", "load_from", 1.0),
        ];
        for (coordinate, name, each) in loads {
            expected.extend(get(coordinate).map(|value| (name, value * each)));
        }
        for (name, value) in expected {
            let found = constant(&header, name);
            let close = (found - value).abs() <= 1e-12 * value.abs();
            assert!(close, "{}: {name} is {found}, and not {value}", servo.name);
        }
    }
}
