//! The MuJoCo model of a servo, run by MuJoCo.

use super::super::scripts::literal;
use super::super::{must, rows, works};
use super::subjects::SERVOS;
use servoid_test_support::tools::missing;
use std::fmt::Write;
use std::process::Command;

/// Prints the angle at the beginning of each step, from rest where the first command and the load hold it.
const SCRIPT: &str = r"
import sys, mujoco
def run(file, radians, rest, commands):
    model = mujoco.MjModel.from_xml_path(sys.argv[1] + '/' + file)
    data = mujoco.MjData(model)
    data.qpos[0] = rest * radians
    angles = []
    for command in commands:
        angles.append(data.qpos[0] / radians)
        data.ctrl[0] = command * radians
        mujoco.mj_step(model, data)
    print(*map(repr, map(float, angles)))
";

#[test]
fn joints_are_as_far_from_the_servo_model_as_they_state() {
    if !works("python3", &["-c", "import mujoco"]) {
        let reason = "python's mujoco is not installed";
        return missing("the servo model in MuJoCo", reason);
    }
    let folder = tempfile::tempdir().unwrap();
    let mut script = SCRIPT.to_owned();
    let exports = SERVOS.map(|servo| {
        let exported = servo.export("mujoco", folder.path(), &[]);
        let file = format!("{}.xml", servo.name);
        std::fs::write(folder.path().join(&file), &exported.text).unwrap();
        let rest = (exported.exact[0] - exported.servo.offset) / exported.servo.gain;
        // The command is in deg.
        let radians = 1f64.to_radians();
        let _infallible = writeln!(
            script,
            "run('{file}', {radians:?}, {rest:?}, {})",
            literal(&exported.trial.command())
        );
        exported
    });
    let file = folder.path().join("run.py");
    std::fs::write(&file, script).unwrap();
    let printed = rows(&must(Command::new("python3").arg(file).arg(folder.path())));
    for ((exported, servo), angles) in exports.iter().zip(SERVOS).zip(printed) {
        let [at_zero, each] = exported.line();
        let position = |angle: &f64| at_zero + each * angle.to_radians();
        let positions: Vec<f64> = angles.iter().map(position).collect();
        // The solver stops a little before the exact minimum of its constraint.
        exported.check(servo.name, &positions, 1e-4);
    }
}
