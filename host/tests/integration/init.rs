//! The rig file of a new rig.

use crate::support::{arg, refusal, run, servoid};
use servoid::data::rig_file::RigFile;

/// The folder's own rig.toml is taken without being named; a simulated servo of another kind does not take it.
#[test]
fn the_rig_file_of_the_folder_is_found() {
    let dir = tempfile::tempdir().unwrap();
    let here = |args: &[&str]| {
        let output = servoid(args).current_dir(dir.path()).output().unwrap();
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stdout).unwrap() + &String::from_utf8(output.stderr).unwrap()
    };
    let said = here(&[
        "init",
        "--yes",
        "--port",
        "sim:bench",
        "--us-per-degree",
        "11",
    ]);
    assert!(said.contains("next: servoid calibrate\n"), "{said}");
    let said = here(&["capture", "-o", "found.csv"]);
    assert!(
        said.contains("rig file: rig.toml (--no-rig leaves it out)")
            && said.contains("next: servoid identify found.csv -o found.json"),
        "{said}"
    );
    let said = here(&[
        "capture",
        "--port",
        "sim:bench",
        "--no-rig",
        "-o",
        "without.csv",
    ]);
    assert!(
        said.contains("without a rig file, pulses are wide, 50 in a second, of 1000 to 2000 µs"),
        "{said}"
    );
    let said = here(&["capture", "--port", "sim:aircraft", "-o", "other.csv"]);
    assert!(
        said.contains("rig.toml is not that of sim:aircraft"),
        "{said}"
    );
    let aircraft = ["capture", "--rig", "rig.toml", "--port", "sim:aircraft"];
    let refusal = |args: &[&str]| {
        let refused = servoid(args).current_dir(dir.path()).output().unwrap();
        assert!(!refused.status.success());
        String::from_utf8(refused.stderr).unwrap()
    };
    let said = refusal(&[&aircraft[..], &["-q", "-o", "false.csv"]].concat());
    assert!(
        said.contains("the condition is \"bench\", by the rig file")
            && said.contains("--condition aircraft records this one"),
        "{said}"
    );
    let wrong = ["capture", "--condition", "aircraft"];
    let said = refusal(&[&wrong[..], &["-q", "-o", "false.csv"]].concat());
    assert!(said.contains("--port sim:aircraft simulates"), "{said}");
    assert!(!dir.path().join("false.csv").exists());
    let stated = ["--condition", "aircraft", "-o", "stated.csv"];
    here(&[&aircraft[..], &stated[..]].concat());
    for (file, us_per_degree) in [("found", "11.0"), ("without", "10.0"), ("other", "10.0")] {
        let recording = std::fs::read_to_string(dir.path().join(format!("{file}.csv"))).unwrap();
        let expected = format!("us_per_degree = {us_per_degree}");
        assert!(recording.contains(&expected), "{file}: {recording:.2000}");
    }
}

/// A self-test needs a board; its port may be that of the rig file as for every other command.
#[test]
fn a_self_test_takes_the_port_of_the_rig_file() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("rig.toml");
    std::fs::write(&file, "port = \"/dev/no-such-port\"\n").unwrap();
    let said = refusal(&["selftest", "--yes", "--rig", arg(&file)]);
    assert!(said.contains("no port \"/dev/no-such-port\""), "{said}");
}

#[test]
fn options_answer_every_question_and_the_file_is_a_rig() {
    let dir = tempfile::tempdir().unwrap();
    let (file, recording) = (dir.path().join("rig.toml"), dir.path().join("x.csv"));
    let args = [
        "init",
        "--yes",
        "--port",
        "sim:bench",
        "--name",
        "bench 1",
        "--condition",
        "bench, 6 V",
        "--pulses",
        "1100:1900",
        "--travel=-10:20",
        "--json",
        "-o",
        arg(&file),
    ];
    let said: serde_json::Value = serde_json::from_str(&run(&args)).unwrap();
    assert_eq!(
        said["next"],
        format!("servoid calibrate --rig {}", file.display())
    );
    let rig = RigFile::read(&file).unwrap();
    assert_eq!(rig.name, "bench 1");
    assert_eq!(
        (rig.limits.shortest_us, rig.limits.longest_us),
        (1400, 1700)
    );
    // What is there already is not lost.
    assert!(refusal(&args).contains("--force"));
    assert_eq!(rig, RigFile::read(&file).unwrap());

    run(&["capture", "--rig", arg(&file), "-o", arg(&recording), "-q"]);
    let header = std::fs::read_to_string(&recording).unwrap();
    assert!(header.contains("condition = \"bench, 6 V\""), "{header}");
}

#[test]
fn a_rig_that_is_no_bench_asks_for_arm() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("rig.toml");
    let rig = ["--port", "/dev/ttyUSB0", "--condition", "aircraft"];
    run(&[&["init", "--yes", "-o", arg(&file)], &rig[..]].concat());
    let said = refusal(&["capture", "--rig", arg(&file), "-o", "x.csv"]);
    assert!(
        said.contains("--arm") && said.contains("aircraft"),
        "{said}"
    );
}

#[test]
fn without_a_terminal_nothing_is_asked_and_wrong_answers_are_explained() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("rig.toml");
    for (options, word) in [
        (&[][..], "--yes"),
        (&["--yes", "--neutral", "700"], "1000:2000"),
        (&["--yes", "--us-per-degree", "0"], "--us-per-degree"),
        (&["--yes", "--travel=5:20"], "below 0"),
        (&["--yes", "--pulses", "1500"], "colon"),
        (&["--yes", "--sensor-kind", "hall"], "as5600-fast"),
        (&["--yes", "--sensor-delay", "101"], "milliseconds"),
        (
            &["--yes", "--sensor-kind", "as5600", "--sensor-volts", "0:5"],
            "0 to 3.3 V",
        ),
    ] {
        let said = refusal(&[&["init", "-o", arg(&file)], options].concat());
        assert!(said.contains(word), "{options:?}: {said}");
        assert!(!file.exists());
    }
}

#[cfg(target_os = "linux")]
mod at_a_terminal {
    use super::{RigFile, arg};
    use crate::terminal::Session;

    /// The answer in brackets.
    const ENTER_ONLY: &str = "";

    #[test]
    fn a_wrong_answer_is_asked_for_again_in_one_sentence() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("rig.toml");
        let mut session = Session::begin(&["init", "--port", "sim:bench", "-o", arg(&file)]);
        session.answer("Name of the rig", "the lab's");
        session.answer("Condition (", "sim:bench");
        session.answer("that is a port", ENTER_ONLY);
        session.answer("Name of the servo", "DS610");
        session.answer("Pulses of the servo", "thin");
        session.answer("choose wide or narrow", ENTER_ONLY);
        session.answer("Pulses in a second", "400");
        session.answer("wide pulses come at 50 to 333 Hz", "333");
        session.answer("Shortest and longest pulse", "500:2500");
        session.answer("the board makes pulses of 800 to 2200", "900:2100");
        session.answer("Pulse at 0 degrees", "1520");
        session.answer("µs for one degree", "ten");
        session.answer("a number is needed", "-9.5");
        session.answer("Travel of the linkage", "-20:20");
        session.answer("Kind of the angle sensor", ENTER_ONLY);
        session.answer("Name of the angle sensor", ENTER_ONLY);
        session.answer("Output of the sensor", ENTER_ONLY);
        session.answer("Degrees between these", ENTER_ONLY);
        session.answer("Time by which its reading lags", "-1");
        session.answer("milliseconds from 0 to 100", "1.5");
        session.answer("How far the true delay may be", ENTER_ONLY);
        assert!(session.end().success(), "{}", session.seen());
        session.wait_for("the next command", |seen| {
            seen.contains("next: servoid calibrate --rig")
        });
        let rig = RigFile::read(&file).unwrap();
        assert_eq!(
            (rig.name.as_str(), rig.condition.as_deref()),
            ("the lab's", Some("bench"))
        );
        assert_eq!(rig.servo.pulse_rate_hz, 333.0);
        // A simulated sensor does not lag, unless its user says so.
        let sensor = &rig.sensor;
        assert_eq!((sensor.delay_ms, sensor.delay_uncertainty_ms), (1.5, 0.0));
        assert_eq!(
            (rig.servo.neutral_us, rig.servo.us_per_degree),
            (1520, -9.5)
        );
        assert_eq!(
            (rig.limits.shortest_us, rig.limits.longest_us),
            (1330, 1710)
        );
        assert!(session.is_as_before());
    }

    /// Enter is never a port at which nobody has answered.
    #[test]
    fn enter_takes_no_port_that_is_silent_and_limits_that_are_careful() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("rig.toml");
        let mut session = Session::begin(&["init", "-o", arg(&file)]);
        session.answer("Name of the rig", ENTER_ONLY);
        session.answer("Condition (", ENTER_ONLY);
        session.wait_for("who answers", |seen| {
            seen.contains("no rig answers") || seen.contains("no serial ports")
        });
        for question in [
            "Port of the rig",
            "Name of the servo",
            "Pulses of the servo",
            "Pulses in a second",
            "Shortest and longest pulse",
            "Pulse at 0 degrees",
            "µs for one degree",
            "Travel of the linkage",
            "Kind of the angle sensor",
            "Name of the angle sensor",
            "Output of the sensor",
            "Degrees between these",
            "Time by which its reading lags",
            "How far the true delay may be",
        ] {
            session.answer(question, ENTER_ONLY);
        }
        assert!(session.end().success(), "{}", session.seen());
        let rig = RigFile::read(&file).unwrap();
        assert_eq!(rig.port, None);
        // The data sheet of the usual sensor.
        assert_eq!(rig.sensor.delay_ms, 4.0);
        assert_eq!(
            (rig.limits.shortest_us, rig.limits.longest_us),
            (1400, 1600)
        );
    }

    #[test]
    fn ctrl_c_leaves_no_file_and_the_terminal_as_it_was() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("rig.toml");
        let mut session = Session::begin(&["init", "-o", arg(&file)]);
        session.wait_for("no question", |seen| seen.contains("Name of the rig"));
        session.press("\x03");
        assert!(!session.end().success());
        assert!(!file.exists());
        assert!(session.is_as_before());
    }

    #[test]
    fn ctrl_c_at_a_menu_shows_the_cursor_again_and_says_that_nothing_was_written() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("rig.toml");
        let mut session = Session::begin(&["init", "-o", arg(&file)]);
        session.answer("Name of the rig", ENTER_ONLY);
        session.answer("Condition (", ENTER_ONLY);
        session.wait_for("no menu", |seen| seen.contains("not known yet"));
        session.press("\x03");
        assert!(!session.end().success());
        assert!(!file.exists());
        session.wait_for("nothing was written", |seen| {
            let shown = seen.rfind("\x1b[?25h");
            seen.contains("nothing was written") && shown > seen.rfind("\x1b[?25l")
        });
    }
}
