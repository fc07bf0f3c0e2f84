//! What the tests have in common.

use assert_cmd::Command;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Long enough for an unoptimised build on a loaded machine, short enough to end a hang.
const LIMIT: Duration = Duration::from_secs(120);

/// `servoid` with these arguments.
pub fn servoid(args: &[&str]) -> Command {
    let mut command = Command::cargo_bin("servoid").expect("the binary under test is built");
    command.args(args).timeout(LIMIT);
    command
}

/// Runs `servoid`, requires success, returns what it printed to standard output.
pub fn run(args: &[&str]) -> String {
    let output = servoid(args).output().expect("it can be started");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "servoid {args:?}: {errors}");
    String::from_utf8(output.stdout).expect("it prints UTF-8")
}

/// Runs `servoid`, requires exit code 1, 2 or 3 and one plain sentence, returns it.
pub fn refusal(args: &[&str]) -> String {
    let output = servoid(args).output().expect("it can be started");
    let errors = String::from_utf8(output.stderr).expect("it prints UTF-8");
    assert!(
        matches!(output.status.code(), Some(1..=3)),
        "{args:?}: {:?}",
        output.status
    );
    assert!(output.stdout.is_empty(), "{args:?} printed a result");
    assert!(!errors.contains("panicked"), "{errors}");
    if output.status.code() != Some(2) {
        let sentence = errors.lines().last().unwrap_or_default();
        assert!(sentence.starts_with("servoid: "), "{errors}");
        return sentence.to_owned();
    }
    errors
}

/// A short recording of levels that are held until the servo rests, with strokes of one to four levels.
pub const SHORT_STAIRS: [&str; 10] = [
    "--reference",
    "stairs",
    "--levels",
    "5",
    "--amplitude",
    "8",
    "--hold",
    "0.3",
    "--length",
    "6",
];

/// A recording of a simulated servo, and its model with a servo model.
pub fn modelled(dir: &Path, name: &str, servo: &str, reference: &[&str]) -> PathBuf {
    let [file, model] = ["csv", "json"].map(|ending| dir.join(format!("{name}.{ending}")));
    let simulate = ["simulate", "-q", "--servo", servo, "-o", arg(&file)];
    run(&[&simulate[..], reference].concat());
    identify_servo_model(&file, &model, &[]);
    model
}

/// The `model` of a recording, with a servo model.
pub fn identify_servo_model(file: &Path, model: &Path, further: &[&str]) {
    let identify = ["identify", "-q", arg(file), "--servo-model"];
    run(&[&identify[..], &["-o", arg(model)], further].concat());
}

/// A recording that came with the tests.
pub fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data")
        .join(name)
}

/// A path as an argument.
pub fn arg(path: &Path) -> &str {
    path.to_str().expect("the path is UTF-8")
}

/// A JSON file.
pub fn json(path: &Path) -> serde_json::Value {
    let text = std::fs::read_to_string(path).expect("the file is there");
    serde_json::from_str(&text).expect("it is JSON")
}

/// Makes a model's document one whose bounds are withdrawn.
pub fn withdraw(model: &mut serde_json::Value) {
    let serde_json::Value::Object(object) = model else {
        return;
    };
    if object.contains_key("bounds") {
        object["bounds"] = serde_json::Value::Null;
        object["withdrawn"] = serde_json::json!({ "reason": "errors_not_noise" });
    }
    for bound in ["lower", "upper"] {
        if object.contains_key(bound) {
            object[bound] = serde_json::Value::Null;
        }
    }
    object.values_mut().for_each(withdraw);
}
