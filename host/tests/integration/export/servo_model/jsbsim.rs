//! The JSBSim system of a servo model, in an aircraft that has nothing else.

use super::super::jsbsim::AIRCRAFT;
use super::super::scripts::literal;
use super::super::{must, rows, works};
use super::subjects::SERVOS;
use servoid_test_support::tools::missing;
use std::process::Command;

/// Prints the position after each step; JSBSim counts time up before it computes.
const SCRIPT: &str = r"
import sys, jsbsim
fdm = jsbsim.FGFDMExec(sys.argv[1])
fdm.set_debug_level(0)
fdm.set_dt(float(sys.argv[3]))
fdm.set_aircraft_path('aircraft')
fdm.set_systems_path('systems')
assert fdm.load_model('stand')
fdm['ic/h-sl-ft'] = 1e5
assert fdm.run_ic()
print()
for command in LIST:
    fdm['fcs/servo_' + sys.argv[2] + '-cmd'] = command
    fdm.run()
    print('position', repr(fdm['fcs/servo_' + sys.argv[2] + '-pos']))
";

#[test]
fn systems_are_as_far_from_the_servo_model_as_they_state() {
    if !works("python3", &["-c", "import jsbsim"]) {
        let reason = "python's jsbsim is not installed";
        return missing("the servo model in JSBSim", reason);
    }
    let folder = tempfile::tempdir().unwrap();
    let place = |path: &str| folder.path().join(path);
    for path in ["aircraft/stand", "systems"] {
        std::fs::create_dir_all(place(path)).unwrap();
    }
    for servo in SERVOS {
        let exported = servo.export("jsbsim", folder.path(), &["--frame-ms", "0"]);
        let system = format!("servo_{}", servo.name);
        let aircraft = AIRCRAFT.replace("servo_bench_1", &system);
        std::fs::write(place("aircraft/stand/stand.xml"), aircraft).unwrap();
        std::fs::write(place(&format!("systems/{system}.xml")), &exported.text).unwrap();
        let script = SCRIPT.replace("LIST", &literal(&exported.trial.command()));
        std::fs::write(place("run.py"), script).unwrap();
        let printed = must(
            Command::new("python3")
                .arg(place("run.py"))
                .arg(folder.path())
                .args([servo.name, &exported.trial.step_s.to_string()]),
        );
        let positions: Vec<&str> = printed
            .lines()
            .filter_map(|line| line.strip_prefix("position "))
            .collect();
        let positions: Vec<f64> = rows(&positions.join("\n")).concat();
        // The emulation is exact but for rounding; one step of time at top speed would be 0.04.
        exported.check(servo.name, &positions, 1e-6);
        if matches!(servo.load, "none" | "constant") {
            let rest = positions[exported.trial.steps_per_level - 1];
            // What the filter has left after five time constants; half the dead band is 0.01.
            exported.check_rest(servo.name, rest, 1e-3);
        }
    }
}
