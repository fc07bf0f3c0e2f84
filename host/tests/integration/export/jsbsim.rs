//! The JSBSim system, in an aircraft that has nothing else.

use super::{SUBJECT, export, must, rows, works};
use crate::support::{arg, run};
use serde_json::json;
use servoid_identification::flight_model::LowOrder;
use servoid_test_support::tools::missing;
use std::path::{Path, PathBuf};
use std::process::Command;

/// An aircraft with the system of a servo.
pub(super) const AIRCRAFT: &str = r#"<?xml version="1.0"?>
<fdm_config name="stand" version="2.0" release="ALPHA">
  <fileheader><author>none</author><filecreationdate>2026-01-01</filecreationdate>
    <description>a test stand</description><version>0</version></fileheader>
  <metrics>
    <wingarea unit="FT2">1</wingarea><wingspan unit="FT">1</wingspan><chord unit="FT">1</chord>
    <location name="AERORP" unit="IN"><x>0</x><y>0</y><z>0</z></location>
    <location name="EYEPOINT" unit="IN"><x>0</x><y>0</y><z>0</z></location>
    <location name="VRP" unit="IN"><x>0</x><y>0</y><z>0</z></location>
  </metrics>
  <mass_balance>
    <ixx unit="SLUG*FT2">1</ixx><iyy unit="SLUG*FT2">1</iyy><izz unit="SLUG*FT2">1</izz>
    <emptywt unit="LBS">10</emptywt>
    <location name="CG" unit="IN"><x>0</x><y>0</y><z>0</z></location>
  </mass_balance>
  <ground_reactions/>
  <propulsion/>
  <system file="servo_bench_1"/>
  <flight_control name="none"/>
  <aerodynamics/>
</fdm_config>
"#;

/// Step of the simulation (s).
const STEP_S: f64 = 0.0005;

/// By how much of its largest motion within a step a position may be off: a delay of whole steps would make it half of it or more.
const OF_A_STEP: f64 = 0.3;

/// Steps the command at a time and prints the time at which a step begins, and the position behind it.
const SCRIPT: &str = r"
import sys, jsbsim
root, (at, dt, first, hold) = sys.argv[1], map(float, sys.argv[2:])
fdm = jsbsim.FGFDMExec(root)
fdm.set_debug_level(0)
fdm.set_dt(dt)
fdm.set_aircraft_path('aircraft')
fdm.set_systems_path('systems')
assert fdm.load_model('stand')
fdm['ic/h-sl-ft'] = 1e5
assert fdm.run_ic()
if hold == 0:
    assert fdm['fcs/servo_bench_1-hold'] == 1
    fdm['fcs/servo_bench_1-hold'] = 0
while fdm.get_sim_time() < at + 0.3:
    now = fdm.get_sim_time()
    fdm['fcs/servo_bench_1-cmd'] = first + (1.0 if now >= at - dt / 4 else 0.0)
    fdm.run()
    print(repr(now), repr(fdm['fcs/servo_bench_1-pos']))
";

/// The system behind a step of the command, from `first` on, at this time (s), in steps of `step_s`; `hold` "0" takes the hold of the frame out.
fn respond(at: &str, step_s: f64, first: &str, hold: &str, folder: &Path) -> Vec<(f64, f64)> {
    let mut python = Command::new("python3");
    python
        .args(["-c", SCRIPT])
        .arg(folder)
        .args([at, &step_s.to_string(), first, hold]);
    let printed = must(&mut python);
    // JSBSim greets on standard output.
    let numbers = |line: &&str| {
        line.split_whitespace()
            .all(|word| word.parse::<f64>().is_ok())
    };
    let lines: Vec<&str> = printed.lines().filter(numbers).collect();
    rows(&lines.join("\n"))
        .into_iter()
        .filter(|row| row.len() == 2)
        .map(|row| (row[0], row[1]))
        .collect()
}

/// An aircraft in a folder, and the folder of its system.
fn stand(folder: &Path) -> PathBuf {
    let (aircraft, systems) = (folder.join("aircraft/stand"), folder.join("systems"));
    std::fs::create_dir_all(&aircraft).unwrap();
    std::fs::create_dir_all(&systems).unwrap();
    std::fs::write(aircraft.join("stand.xml"), AIRCRAFT).unwrap();
    systems
}

#[test]
fn the_actuator_moves_as_the_low_order_model() {
    if !works("python3", &["-c", "import xml.dom.minidom"]) {
        return missing(
            "the JSBSim system",
            "there is no python3, not even to parse it",
        );
    }
    let folder = tempfile::tempdir().unwrap();
    let systems = stand(folder.path());
    let file = export("jsbsim", &systems, "servo_bench_1.xml");
    must(
        Command::new("python3")
            .args([
                "-c",
                "import sys, xml.dom.minidom as x; x.parse(sys.argv[1])",
            ])
            .arg(file),
    );
    if !works("python3", &["-c", "import jsbsim"]) {
        return missing(
            "running the JSBSim system",
            "python's jsbsim is not installed",
        );
    }
    let transfer = SUBJECT.flight.transfer;
    // A pulse has the command of the step in which it begins, of which that may be new; a later one waits. Without the hold it acts from the step on in which it comes.
    for (step_s, at, hold, edge) in [
        (STEP_S, "0.0595", "1", 0.06),
        (STEP_S, "0.06", "1", 0.06),
        (STEP_S, "0.0605", "1", 0.08),
        (STEP_S, "0.067", "0", 0.067),
        (0.002, "0.06", "1", 0.06),
        (0.0025, "0.06", "1", 0.06),
        // The step of 58.3 ms is the first of the command, and a pulse begins in it; that of 25 ms waits for the one of 40 ms.
        (1.0 / 120.0, "0.02", "1", 0.04),
        (1.0 / 120.0, "0.06", "1", 0.06),
        (0.003, "0.06", "1", 0.06),
        (0.003, "0.062", "1", 0.08),
    ] {
        let found = respond(at, step_s, "0", hold, folder.path());
        assert!(found.len() as f64 > 0.25 / step_s, "{}", found.len());
        let largest = OF_A_STEP * largest_motion(&transfer, step_s);
        for (time, position) in found {
            let exact = SUBJECT.model.offset + transfer.step(time - edge);
            assert!(
                (position - exact).abs() < largest,
                "{at}: {position} for {exact} at {time}"
            );
        }
    }
}

/// The largest motion within a step of this length, behind a step of the command.
fn largest_motion(transfer: &LowOrder, step_s: f64) -> f64 {
    let at = |step: u32| transfer.step(transfer.delay_s + step_s * f64::from(step));
    let moved = (0..1000).map(|step| (at(step + 1) - at(step)).abs());
    moved.fold(0.0, f64::max)
}

/// Delays of no step, of a part of one, of one and of some: at rates that JSBSim has, as right as the header says.
#[test]
fn a_delay_is_right_to_a_part_of_a_step() {
    if !works("python3", &["-c", "import jsbsim"]) {
        return missing("delays in JSBSim", "python's jsbsim is not installed");
    }
    let folder = tempfile::tempdir().unwrap();
    let out = stand(folder.path()).join("servo_bench_1.xml");
    let file = folder.path().join("delayed.json");
    let name = ["--name", "bench 1", "-o", arg(&out), "-q", "--force"];
    for delay_s in [0.0, 0.002, 0.005, 0.0083, 1.0 / 120.0, 0.012, 0.02] {
        let mut flight = SUBJECT.flight.clone();
        flight.transfer.delay_s = delay_s;
        flight.delay_s.value = Some(delay_s);
        let transfer = flight.transfer;
        let mut document = crate::support::json(&SUBJECT.file);
        document["flight_model"] = json!(flight);
        std::fs::write(&file, document.to_string()).unwrap();
        let options = ["export", arg(&file), "--to", "jsbsim", "--frame-ms", "0"];
        run(&[&options[..], &name].concat());
        let said = std::fs::read_to_string(&out).unwrap();
        let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
        for hz in [120.0, 400.0, 500.0] {
            let begin = 6.0 / 120.0;
            let exact = |time: f64| SUBJECT.model.offset + transfer.step(time - begin);
            let found = respond("0.05", 1.0 / hz, "0", "1", folder.path());
            let apart = found.iter().map(|(time, at)| (at - exact(*time)).abs());
            let apart = apart.fold(0.0, f64::max);
            assert!(
                apart < OF_A_STEP * largest_motion(&transfer, 1.0 / hz),
                "{apart} at {hz} Hz with a delay of {delay_s} s"
            );
            if hz != 400.0 {
                let stated = format!(" % at {hz} Hz");
                let (before, _) = said.split_once(&stated).unwrap();
                let stated = before.rsplit(' ').next().unwrap().parse::<f64>().unwrap();
                let percent = 100.0 * apart / transfer.gain.abs();
                // Four digits are written.
                assert!(
                    (percent - stated).abs() < 1e-3 * stated,
                    "{percent} {stated}"
                );
            }
        }
    }
}

/// Of a command in us, whose position at 0 us is far away: the system has the offset, and is at rest under 1500 us.
#[test]
fn a_pulse_begins_at_rest_with_the_offset() {
    if !works("python3", &["-c", "import jsbsim"]) {
        return missing("the offset in JSBSim", "python's jsbsim is not installed");
    }
    let folder = tempfile::tempdir().unwrap();
    let mut document = crate::support::json(&SUBJECT.file);
    document["units"]["input"] = "us".into();
    let gain = SUBJECT.model.step.value.last().unwrap();
    document["offset"] = (3.0 - 1500.0 * gain).into();
    document["recorded"]["commands"] = json!({ "least": 1495.0, "largest": 1505.0 });
    let file = folder.path().join("us.json");
    let out = stand(folder.path()).join("servo_bench_1.xml");
    std::fs::write(&file, document.to_string()).unwrap();
    let name = ["--name", "bench 1", "-o", arg(&out), "-q"];
    run(&[&["export", arg(&file), "--to", "jsbsim"], &name[..]].concat());
    let said = std::fs::read_to_string(&out).unwrap();
    assert!(said.contains("under the command 1500.0 us"), "{said}");
    // Before the step, which adds a microsecond: the fit of the gain and its rounding are smaller.
    for (time, position) in respond("0.1", STEP_S, "1500.0", "1", folder.path()) {
        let largest = if time < 0.1 { 1e-6 } else { 2.0 * gain.abs() };
        assert!((position - 3.0).abs() < largest, "{position} at {time}");
    }
}
