//! The MuJoCo model of a servo, run by MuJoCo.

use super::super::scripts::literal;
use super::super::{must, rows, works};
use super::subjects::{Exported, SERVOS, export, number_behind, prose, pulses, unitless};
use crate::support::{arg, run};
use servoid_test_support::tools::missing;
use std::fmt::Write;
use std::process::Command;

/// Prints the angle at the beginning of each step, from rest where the first command and the load hold it, begun as the header says.
const SCRIPT: &str = r"
import sys, mujoco, numpy as np
def run(file, rest, at_zero, each, commands):
    model = mujoco.MjModel.from_xml_path(sys.argv[1] + '/' + file)
    data = mujoco.MjData(model)
    data.qpos[0] = rest
    samples = model.actuator_history[0][0]
    held = np.full(samples, at_zero + each * commands[0])
    mujoco.mj_initCtrlHistory(model, data, 0, None, held)
    angles = []
    for command in commands:
        angles.append(data.qpos[0])
        data.ctrl[0] = at_zero + each * command
        mujoco.mj_step(model, data)
    print(*map(repr, map(float, angles)))
";

/// A load of the air whose constant part and whose stiffening cancel each other within the recorded range: either alone is beyond full drive.
#[test]
fn a_load_of_the_air_is_its_mean_and_not_its_constant_part() {
    let folder = tempfile::tempdir().unwrap();
    let airborne = SERVOS.into_iter().find(|servo| servo.name == "airborne");
    let file = airborne.unwrap().file(folder.path());
    let mut document = crate::support::json(&file);
    let model = &mut document["servo_model"];
    let names = model["coordinates"].as_array().unwrap().clone();
    let place = |name: &str| names.iter().position(|known| known == name).unwrap();
    for (name, value) in [
        ("constant_load", -40.0),
        ("air_stiffening", 2.5e-4),
        ("air_from", -400.0),
    ] {
        model["values"][place(name)] = serde_json::json!(value);
    }
    std::fs::write(&file, document.to_string()).unwrap();
    for target in ["mujoco", "jsbsim"] {
        let args = [
            "export",
            arg(&file),
            "--to",
            target,
            "--servo-model",
            "--json",
            "-q",
        ];
        let found: serde_json::Value = serde_json::from_str(&run(&args)).unwrap();
        let in_strokes = found["largest_difference_in_strokes"].as_f64().unwrap();
        assert!(in_strokes < 5.0, "{target}: {in_strokes}");
        let text = prose(found["text"].as_str().unwrap());
        assert!(text.contains("its mean over the recorded range"), "{text}");
    }
}

/// The numbers of header, file and terminal, of a delay of 21.3 ms.
#[test]
fn a_delay_that_is_rounded_to_steps_is_said_to_be() {
    let folder = tempfile::tempdir().unwrap();
    let file = SERVOS[1].file(folder.path());
    for (step, late_ms, said) in [
        ("2", 21.0, "0.3000 ms less"),
        ("1", 21.5, "0.2000 ms more"),
        ("0.1", 21.25, "0.05000 ms less"),
    ] {
        let args = ["export", arg(&file), "--to", "mujoco", "--step-ms", step];
        let output = crate::support::servoid(&args).output().unwrap();
        let [text, talk] = [output.stdout, output.stderr].map(|of| String::from_utf8(of).unwrap());
        let text = prose(&text);
        let of_header = number_behind(&text, "the motion is late by ");
        assert!((of_header - late_ms).abs() < 1e-9, "{text}");
        assert!(text.contains(said) && talk.contains(said), "{talk}");
        // As short as it can be.
        let number = format!("{:?}", late_ms * 1e3 / 1e6);
        assert!(text.contains(&format!("delay=\"{number}\"")), "{text}");
    }
}

#[test]
fn joints_are_as_far_from_the_servo_model_as_they_state() {
    if !works("python3", &["-c", "import mujoco"]) {
        let reason = "python's mujoco is not installed";
        return missing("the servo model in MuJoCo", reason);
    }
    let folder = tempfile::tempdir().unwrap();
    let mut script = SCRIPT.to_owned();
    let mut exports: Vec<(&str, Exported)> = SERVOS
        .iter()
        .map(|servo| (servo.name, servo.export("mujoco", folder.path(), &[])))
        .collect();
    let others = [
        ("pulses", pulses(folder.path())),
        ("unitless", unitless(folder.path())),
    ];
    exports.extend(others.map(|(name, file)| (name, export(&file, 0, "mujoco", &[]))));
    // With all terms, turning against its command: two speeds, two stops and a load change their sides.
    for servo in ["full", "constant", "tilted", "stopped"] {
        let found = SERVOS.iter().find(|found| found.name == servo).unwrap();
        let file = found.reversed(folder.path());
        exports.push((servo, export(&file, 0, "mujoco", &[])));
    }
    for (number, (_, exported)) in exports.iter().enumerate() {
        let file = format!("{number}.xml");
        std::fs::write(folder.path().join(&file), &exported.text).unwrap();
        let [at_zero, each] = exported.line("ctrl");
        let _infallible = writeln!(
            script,
            "run('{file}', {:?}, {at_zero:?}, {each:?}, {})",
            exported.exact[0].to_radians(),
            literal(&exported.trial.command())
        );
    }
    let file = folder.path().join("run.py");
    std::fs::write(&file, script).unwrap();
    let printed = rows(&must(Command::new("python3").arg(file).arg(folder.path())));
    for ((name, exported), angles) in exports.iter().zip(printed) {
        // The joint's angle is the position.
        let positions: Vec<f64> = angles.iter().map(|angle| angle.to_degrees()).collect();
        // The solver stops a little before the exact minimum of its constraint.
        exported.check(name, &positions, 1e-4);
        // One that turned the wrong way would be off by a whole stroke where each is held.
        let stroke = exported.largest_stroke();
        let held = [&positions, &exported.exact].map(|course| exported.trial.staircase(course));
        let found = exported.trial.largest_difference(held[0], held[1]);
        assert!(found < 0.5 * stroke, "{name}: {found}");
        // A position actuator came no closer than a tenth of the stroke.
        if *name == "clipped" {
            assert!(exported.text.contains("<general "), "{name}");
            assert!(exported.stated < 0.02 * stroke, "{name}");
        }
    }
}
