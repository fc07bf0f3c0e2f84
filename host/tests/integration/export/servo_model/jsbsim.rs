//! The JSBSim system of a servo model, in an aircraft that has nothing else.

use super::super::jsbsim::AIRCRAFT;
use super::super::scripts::literal;
use super::super::{must, rows, works};
use super::smooth::Smooth;
use super::subjects::{Exported, SERVOS, Servo, export, number_behind, prose, pulses};
use servoid_test_support::tools::missing;
use std::path::Path;
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

/// Commands change at the beginning of a frame: one that holds them takes each at once, and is no farther away.
#[test]
fn systems_are_as_far_from_the_servo_model_as_they_state() {
    if !works("python3", &["-c", "import jsbsim"]) {
        let reason = "python's jsbsim is not installed";
        return missing("the servo model in JSBSim", reason);
    }
    let folder = tempfile::tempdir().unwrap();
    // Of a frame every second one has steps that do not divide it.
    let of_servo = |(number, servo)| {
        let framed = ["20", if number % 2 == 0 { "2" } else { "2.5" }];
        [["0", "2"], framed].map(|options| (servo, options))
    };
    for (servo, [frame, step]) in SERVOS.iter().enumerate().flat_map(of_servo) {
        let options = ["--frame-ms", frame, "--step-ms", step];
        let exported = servo.export("jsbsim", folder.path(), &options);
        check_start(folder.path(), servo.name, &exported);
        let positions = run(
            folder.path(),
            servo.name,
            &exported,
            &exported.trial.command(),
        );
        // The emulation is exact but for rounding; one step of time at top speed would be 0.04.
        exported.check(servo.name, &positions, 1e-6);
        if matches!(servo.load, "none" | "constant") {
            let rest = positions[exported.trial.steps_per_level - 1];
            // What the filter has left after five time constants; half the dead band is 0.01.
            exported.check_rest(servo.name, rest, 1e-3);
        }
    }
}

/// Its actuator turns round at once where a servo must brake first.
#[test]
fn reversals_and_strokes_that_break_off_are_no_farther_than_they_state() {
    if !works("python3", &["-c", "import jsbsim"]) {
        return missing("reversals in JSBSim", "python's jsbsim is not installed");
    }
    let folder = tempfile::tempdir().unwrap();
    // Of the limits themselves two show it: each command is some ten thousand steps of a program in Python.
    let limited = |servo: &&Servo| servo.terms.contains(&"limit");
    for servo in SERVOS.iter().filter(limited).take(2) {
        let exported = servo.export("jsbsim", folder.path(), &["--frame-ms", "0"]);
        let positions = |commands: &[f64]| {
            // JSBSim begins at rest under the neutral command.
            let first = std::iter::repeat_n(commands[0], 1000);
            let whole: Vec<f64> = first.chain(commands.iter().copied()).collect();
            run(folder.path(), servo.name, &exported, &whole).split_off(1000)
        };
        exported.check_reversals(servo.name, positions);
        exported.check_broken_off(servo.name, positions);
    }
}

/// Under the neutral command, which is the value of the property, and where the header says, the system begins at rest.
fn check_start(folder: &Path, name: &str, exported: &Exported) {
    let said = prose(&exported.text);
    let neutral = number_behind(&said, "at rest under the command ");
    let stated = number_behind(&said, ", where the position is ");
    for position in run(folder, name, exported, &[neutral; 100]) {
        // Four digits are written.
        assert!(
            (position - stated).abs() < 1e-3,
            "{name}: {position} {stated}"
        );
    }
}

#[test]
fn a_system_of_pulses_begins_at_rest_where_it_states() {
    if !works("python3", &["-c", "import jsbsim"]) {
        return missing("the start in JSBSim", "python's jsbsim is not installed");
    }
    let folder = tempfile::tempdir().unwrap();
    let pulses = pulses(folder.path());
    for frame in ["0", "20"] {
        let options = ["--frame-ms", frame, "--name", "pulses"];
        let exported = export(&pulses, 0, "jsbsim", &options);
        check_start(folder.path(), "pulses", &exported);
    }
}

/// Of the held command, whose steps a rate limit passes later than a smooth one.
#[test]
fn systems_are_as_late_as_they_state() {
    if !works("python3", &["-c", "import jsbsim"]) {
        return missing("a sine in JSBSim", "python's jsbsim is not installed");
    }
    let folder = tempfile::tempdir().unwrap();
    for (frame, frame_s, step) in [
        ("0", 0.0, "2"),
        ("20", 0.02, "2"),
        ("20", 0.02, "8.333333"),
        ("20", 0.02, "2.5"),
    ] {
        let options = ["--frame-ms", frame, "--step-ms", step];
        let exported = SERVOS[1].export("jsbsim", folder.path(), &options);
        let smooth = Smooth::of(&exported, frame_s);
        let commands = smooth.command(0.0);
        let positions = run(folder.path(), "limited", &exported, &commands);
        smooth.check(&exported, &positions);
    }
}

/// Of a command that is held for frames, which a file without a frame is not made for. The delay that was closest in strokes alone made smooth motion early by nearly all of the servo's own.
#[test]
fn a_system_of_a_held_command_is_closer_to_the_servo_in_strokes_and_not_early_in_smooth_motion() {
    if !works("python3", &["-c", "import jsbsim"]) {
        return missing("strokes in JSBSim", "python's jsbsim is not installed");
    }
    let folder = tempfile::tempdir().unwrap();
    let [smooth, held] = ["0", "20"].map(|frame| {
        let exported = SERVOS[1].export("jsbsim", folder.path(), &["--frame-ms", frame]);
        let trial = &exported.trial;
        let positions = run(folder.path(), "limited", &exported, &trial.command());
        let delay = prose(&exported.text).contains("the rate limit spreads each step");
        assert_eq!(delay, frame == "20");
        if frame == "20" {
            let early_s = -Smooth::of(&exported, 0.02).stated_s();
            assert!(early_s < 0.003, "{early_s}");
        }
        trial.root_mean_square(
            trial.staircase(&positions),
            trial.staircase(&exported.exact),
        )
    });
    // About half of the difference is left.
    assert!(held < 0.7 * smooth, "{held} {smooth}");
}

/// A quick servo of 427 a second with a dead band: in strokes that end, a filter before the actuator was closest by a tenth, and in reversals it was 45 % of a stroke away.
#[test]
fn the_filter_is_where_it_is_closest_in_reversals_too() {
    let folder = tempfile::tempdir().unwrap();
    let servo = Servo {
        name: "quick",
        terms: &["limit", "dead_band"],
        load: "none",
        controller: None,
    };
    let file = servo.file(folder.path());
    let mut document = crate::support::json(&file);
    let model = &mut document["servo_model"];
    model["commands"] = serde_json::json!({ "least": -36.6, "largest": 36.6 });
    let chosen = [
        ("delay", 0.00705),
        ("ln_stiffness", 8.2453),
        ("ln_damping", 4.8103),
        ("gain", 0.91),
        ("offset", 0.0),
        ("ln_top_speed", 427f64.ln()),
        ("motor_share", 0.3406),
        ("dead_band", 0.586),
    ];
    for (name, value) in chosen {
        let mut names = model["coordinates"].as_array().unwrap().iter();
        let place = names.position(|known| known == name).unwrap();
        model["values"][place] = value.into();
    }
    std::fs::write(&file, document.to_string()).unwrap();
    let exported = export(&file, 0, "jsbsim", &["--name", servo.name]);
    let said = prose(&exported.text);
    assert!(said.contains("behind the actuator"), "{said}");
    let percent = number_behind(&said, "deg of the position, ");
    assert!(percent < 15.0, "{percent}");
}

#[test]
fn the_step_of_a_stated_rate_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let of = |more: &[&str]| prose(&SERVOS[1].export("jsbsim", folder.path(), more).text);
    assert!(of(&[]).contains("Run it at 500 Hz or more"));
    let stated = of(&["--step-ms", "8.333333"]);
    assert!(
        stated.contains("Run it at 120.0 Hz, in steps of 8.333 ms"),
        "{stated}"
    );
    assert!(!stated.contains("500 Hz"), "{stated}");
}

/// The position after each of these commands.
fn run(folder: &Path, name: &str, exported: &Exported, commands: &[f64]) -> Vec<f64> {
    let place = |path: &str| folder.join(path);
    for path in ["aircraft/stand", "systems"] {
        std::fs::create_dir_all(place(path)).unwrap();
    }
    let system = format!("servo_{name}");
    let aircraft = AIRCRAFT.replace("servo_bench_1", &system);
    std::fs::write(place("aircraft/stand/stand.xml"), aircraft).unwrap();
    std::fs::write(place(&format!("systems/{system}.xml")), &exported.text).unwrap();
    let script = SCRIPT.replace("LIST", &literal(commands));
    std::fs::write(place("run.py"), script).unwrap();
    let printed = must(
        Command::new("python3")
            .arg(place("run.py"))
            .arg(folder)
            .args([name, &exported.trial.step_s.to_string()]),
    );
    let positions: Vec<&str> = printed
        .lines()
        .filter_map(|line| line.strip_prefix("position "))
        .collect();
    rows(&positions.join("\n")).concat()
}
