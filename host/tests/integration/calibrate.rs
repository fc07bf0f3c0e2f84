//! The sensor's scale, the servo's, and the ends of its travel.

use crate::support::{arg, refusal, run, servoid};
use servoid::data::rig_file::RigFile;

const PAIRS: &str = "--pairs=-20=6001,-10=7000,0=8001,10=9000,20=10001";

#[test]
fn a_calibration_goes_into_the_rig_file_and_leaves_the_rest() {
    let dir = tempfile::tempdir().unwrap();
    let (old, new) = (dir.path().join("old.toml"), dir.path().join("new.toml"));
    std::fs::write(&old, "# mine\n[servo]\nneutral_us = 1520\n").unwrap();
    let args = [
        "calibrate",
        PAIRS,
        "--rig",
        arg(&old),
        "-o",
        arg(&new),
        "--json",
    ];
    let found: serde_json::Value = serde_json::from_str(&run(&args)).unwrap();
    assert_eq!(found["sensor"]["readings"], 5);
    let rig = RigFile::read(&new).unwrap();
    assert_eq!(rig.servo.neutral_us, 1520);
    // The readings are within a count of 100 counts a degree and 8000 at 0.
    assert!((rig.sensor.degrees_per_count - 0.01).abs() < 1e-5);
    assert!((rig.sensor.zero_counts - 8000.6).abs() < 1e-6);
    assert!(rig.sensor.zero_sd_deg > 0.0 && rig.sensor.scale_sd_percent > 0.0);
    assert!(std::fs::read_to_string(&new).unwrap().contains("# mine"));
    assert!(refusal(&args).contains("--force"));
}

#[test]
fn the_example_of_the_help_is_no_doubt_and_says_nothing_of_pulses() {
    let dir = tempfile::tempdir().unwrap();
    let example = "--pairs=-20=6008,-10=7100,0=8192,10=9284,20=10377";
    let out = dir.path().join("rig.toml");
    let said = servoid(&["calibrate", "--no-rig", example, "-o", arg(&out)])
        .output()
        .unwrap();
    let [printed, said] = [said.stdout, said.stderr].map(|text| String::from_utf8(text).unwrap());
    assert!(printed.contains("degrees_per_count"), "{printed}");
    assert!(!said.contains("pulses"), "{said}");
}

#[test]
fn readings_that_give_no_scale_are_refused_and_nothing_is_written() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("rig.toml");
    for (pairs, word) in [
        ("--pairs=-20=6000,20=10000", "three"),
        ("--pairs=-20=8000,0=8000,20=8000", "direction"),
        ("--pairs=-20=6000,0=8000,20=70000", "65535"),
        ("--pairs=20", "-20=6008"),
    ] {
        let said = refusal(&["calibrate", pairs, "-o", arg(&out)]);
        assert!(said.contains(word), "{pairs}: {said}");
        assert!(!out.exists());
    }
}

#[test]
fn a_rig_is_calibrated_and_its_file_has_the_result() {
    let dir = tempfile::tempdir().unwrap();
    let rig = dir.path().join("rig.toml");
    // The sensor is 3 % steeper than its data sheet, and the servo stops at 26.5 degrees.
    let port = "sim:bench?sensor-gain=1.03&stops-deg=-80:26.5";
    let wide = "--travel=-50:50";
    run(&["init", "--yes", "--port", port, wide, "-o", arg(&rig)]);
    let before = std::fs::read_to_string(&rig).unwrap();
    let args = [
        "calibrate",
        "--rig",
        arg(&rig),
        "--pulses=1300,1400,1500,1600,1700",
        "--angles=-20,-10,0,10,20",
        "--json",
        "-q",
    ];
    let found: serde_json::Value = serde_json::from_str(&run(&args)).unwrap();
    assert_eq!(found["travel"]["long_end"]["kind"], "stops");
    let at = &found["travel"]["long_end"]["at_us"];
    assert!((at["value"].as_f64().unwrap() - 1765.0).abs() < 5.0, "{at}");
    assert_eq!(found["travel"]["short_end"]["kind"], "not_within");
    // Nothing is written unasked.
    assert_eq!(before, std::fs::read_to_string(&rig).unwrap());

    run(&[&args[..], &["--update"]].concat());
    let text = std::fs::read_to_string(&rig).unwrap();
    assert!(text.contains("# Calibrated: 5 readings"), "{text}");
    // How far the limits reach is said of the new ones.
    let is_kept = |line: &&str| line.starts_with('#') && !line.starts_with("# From ");
    for line in before.lines().filter(is_kept) {
        assert!(text.contains(line), "{line} is gone: {text}");
    }
    let file = RigFile::read(&rig).unwrap();
    let nominal = RigFile::default().sensor.degrees_per_count;
    // Dead band and play leave the shaft up to 0.06 degrees from the angles that were given.
    let ratio = file.sensor.degrees_per_count * 1.03 / nominal;
    assert!((ratio - 1.0).abs() < 0.005, "{ratio}");
    assert!((file.servo.us_per_degree - 10.0).abs() < 0.05);
    assert!(file.sensor.scale_sd_percent > 0.0 && file.sensor.scale_sd_percent < 1.0);
    // No pulse pushes the servo against its stop from now on: the finer levels around it are 8 µs apart.
    let limits = &file.limits;
    assert!((1756..=1765).contains(&limits.longest_us), "{limits:?}");
    assert_eq!(limits.shortest_us, 1000);
    assert!(
        text.contains("# Calibrated: the servo stops beyond this pulse\nlongest_us"),
        "{text}"
    );
}

#[test]
fn angles_that_are_assumed_are_labelled() {
    let dir = tempfile::tempdir().unwrap();
    let rig = dir.path().join("rig.toml");
    let said = run(&[
        "calibrate",
        "--port",
        "sim:linear",
        "--by-servo",
        "-o",
        arg(&rig),
    ]);
    assert!(said.contains("assumed, not measured"), "{said}");
    let text = std::fs::read_to_string(&rig).unwrap();
    assert!(text.contains("assumed, not measured"), "{text}");
    assert!(!text.contains("us_per_degree"), "it was assumed: {text}");
    assert!(RigFile::read(&rig).unwrap().sensor.scale_sd_percent > 5.0);
}

/// The sensor agrees with the angles, so the servo is turned round and no sign is wrong.
#[test]
fn a_servo_that_turns_the_other_way_is_no_doubt_and_signs_that_are_all_wrong_are() {
    let dir = tempfile::tempdir().unwrap();
    let rig = dir.path().join("rig.toml");
    let port = ["--port", "sim:linear?gain=-0.9", "--travel=-20:20"];
    run(&[&["init", "-q", "--yes"][..], &port, &["-o", arg(&rig)]].concat());
    let calibrate = ["calibrate", "-q", "--update", "--rig", arg(&rig)];
    run(&[&calibrate[..], &["--angles=16,8,0,-8,-16"]].concat());
    let file = RigFile::read(&rig).unwrap();
    assert!((file.servo.us_per_degree + 10.0).abs() < 0.1);
    // From here on sensor and servo both contradict such angles.
    let said = refusal(&[&calibrate[..], &["--angles=-16,-8,0,8,16"]].concat());
    assert!(said.contains("is doubtful"), "{said}");
}

/// A rig file of this port.
fn init(rig: &std::path::Path, port: &str) {
    run(&["init", "-q", "--yes", "--port", port, "-o", arg(rig)]);
}

/// The protractor slipped by a degree between the second and the third reading.
#[test]
fn a_calibration_worse_than_a_data_sheet_does_not_replace_a_good_one() {
    let dir = tempfile::tempdir().unwrap();
    let rig = dir.path().join("rig.toml");
    init(&rig, "sim:bench");
    let update = [
        "calibrate",
        "-q",
        "--no-travel",
        "--update",
        "--rig",
        arg(&rig),
    ];
    run(&[&update[..], &["--angles=-8,-4,0,4,8"]].concat());
    let good = std::fs::read_to_string(&rig).unwrap();
    let refused = |angles: &str| {
        let output = servoid(&[&update[..], &[angles]].concat())
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(1));
        String::from_utf8(output.stderr).unwrap()
    };
    let said = refused("--angles=-8,-4,1,5,9");
    assert!(
        said.contains("a data sheet says more")
            && said.contains("the rig file has the sensor's scale"),
        "{said}"
    );
    let said = refused("--angles=-7.6,-3.8,0,3.8,7.6");
    assert!(said.contains("-5.0 % from that of the rig file"), "{said}");
    assert_eq!(std::fs::read_to_string(&rig).unwrap(), good);
    let said = run(&[&update[..], &["--angles=-5,-1,3,7,11"]].concat());
    assert!(said.contains("0 degrees are -3.0"), "{said}");
}

/// Where no angles were read, none were read wrong; and what a calibration leaves of the travel, the default reference keeps to.
#[test]
fn a_staircase_alone_doubts_no_angles_and_the_next_capture_stays_within_its_limits() {
    let said = run(&[
        "calibrate",
        "-q",
        "--no-rig",
        "--port",
        "sim:linear?gain=0.8",
        "--travel-only",
    ]);
    assert!(
        said.contains("DOUBTFUL") && !said.contains("were they read"),
        "{said}"
    );
    let dir = tempfile::tempdir().unwrap();
    let [rig, record] = ["rig.toml", "r.csv"].map(|name| dir.path().join(name));
    init(&rig, "sim:bench?stops-deg=-30:4");
    run(&[
        "calibrate",
        "-q",
        "--rig",
        arg(&rig),
        "--travel-only",
        "--update",
        "--yes",
    ]);
    let capture = ["capture", "--rig", arg(&rig), "-o", arg(&record)];
    let said = refusal(&[&capture[..], &["--amplitude", "8"]].concat());
    assert!(said.contains("--amplitude 3."), "{said}");
    let plan: serde_json::Value = serde_json::from_str(&run(&[
        "plan",
        "-q",
        "--json",
        "--rig",
        arg(&rig),
        "--amplitude",
        "8",
    ]))
    .unwrap();
    assert!(
        plan["beyond_limits"]
            .as_str()
            .unwrap()
            .contains("--amplitude 3.")
    );
    run(&capture);
    assert!(record.exists());
}

#[test]
fn doubtful_angles_are_written_without_a_terminal_only_on_request() {
    let dir = tempfile::tempdir().unwrap();
    let rig = dir.path().join("rig.toml");
    let before = "port = \"sim:bench\"\n";
    std::fs::write(&rig, before).unwrap();
    let args = [
        "calibrate",
        "--rig",
        arg(&rig),
        "--update",
        "--no-travel",
        "--angles=-16,-8,0,8,16",
    ];
    let refused = refusal(&args);
    assert!(
        refused.contains("doubtful or disagrees with the rig file") && refused.contains("--yes"),
        "{refused}"
    );
    assert_eq!(std::fs::read_to_string(&rig).unwrap(), before);
    run(&[&args[..], &["-q", "--yes"]].concat());
    assert!(
        std::fs::read_to_string(&rig)
            .unwrap()
            .contains("degrees_per_count")
    );
}

#[test]
fn a_rig_that_cannot_be_calibrated_is_refused_in_a_sentence() {
    for (options, word) in [
        (&["--port", "sim:bench"][..], "--angles"),
        (&["--by-servo"], "--port"),
        (
            &[
                "--port",
                "/dev/none",
                "--condition",
                "aircraft",
                "--by-servo",
            ],
            "--arm",
        ),
        (&["--port", "sim:bench", "--angles=1,2"], "5 positions"),
        (
            &[
                "--port",
                "sim:bench",
                "--by-servo",
                "--pulses=900,1500,2000",
            ],
            "900 µs",
        ),
        (
            &["--port", "sim:linear?gain=0", "--travel-only"],
            "does not follow",
        ),
        (
            &["--port", "sim:bench?fault=open@1", "--by-servo"],
            "sensor",
        ),
    ] {
        let said = refusal(&[&["calibrate"], options].concat());
        assert!(said.contains(word), "{options:?}: {said}");
    }
}

#[cfg(target_os = "linux")]
mod at_a_terminal {
    use super::{RigFile, arg, run};
    use crate::terminal::Session;

    fn begin(rig: &std::path::Path, port: &str) -> Session {
        let wide = "--travel=-50:50";
        run(&["init", "--yes", "--port", port, wide, "-o", arg(rig)]);
        let mut session = Session::begin(&["calibrate", "--rig", arg(rig)]);
        session.wait_for("no question", |seen| seen.contains("May it move"));
        session.press("y\r");
        session
    }

    #[test]
    fn angles_are_asked_for_while_the_servo_holds_and_the_file_gets_the_result() {
        let dir = tempfile::tempdir().unwrap();
        let rig = dir.path().join("rig.toml");
        let mut session = begin(&rig, "sim:bench?sensor-gain=0.9");
        session.answer("position 1 of 5, 1100 µs", "-40");
        session.wait_for("no angle", |seen| seen.contains("asks for -40.0)?"));
        session.answer("position 2 of 5", "twenty");
        session.answer("a number of degrees", "-20");
        session.answer("position 3 of 5", "skip");
        session.wait_for("not said", |seen| seen.contains("1500 µs: left out"));
        session.answer("position 4 of 5", "20,0");
        session.answer("position 5 of 5", "40");
        session.wait_for("no result", |seen| seen.contains("Put this into"));
        session.press("y\r");
        // What it prints last may be read after its end.
        session.wait_for("no next step", |seen| {
            seen.contains("next: servoid capture --rig")
        });
        assert!(session.end().success(), "{}", session.seen());
        assert!(!session.seen().contains("DOUBTFUL"), "{}", session.seen());
        assert!(dir.path().join("rig-1.toml").exists());
        let sensor = RigFile::read(&rig).unwrap().sensor;
        let nominal = RigFile::default().sensor.degrees_per_count;
        // Dead band and play: 0.06 of 40 degrees.
        let ratio = sensor.degrees_per_count * 0.9 / nominal;
        assert!((ratio - 1.0).abs() < 0.005, "{ratio}");
        assert!(session.is_as_before());
    }

    /// Enter after the letter, later than the letter acts, and twice.
    #[test]
    fn an_enter_that_is_typed_late_answers_no_position() {
        let dir = tempfile::tempdir().unwrap();
        let rig = dir.path().join("rig.toml");
        let mut session = begin(&rig, "sim:bench");
        std::thread::sleep(std::time::Duration::from_millis(200));
        session.press("\r");
        for (position, angle) in ["-40", "-20", "0", "20", "40"].iter().enumerate() {
            session.answer(&format!("position {} of 5", position + 1), angle);
        }
        session.wait_for("no result", |seen| seen.contains("Put this into"));
        session.press("y\r");
        assert!(session.end().success(), "{}", session.seen());
        let sensor = RigFile::read(&rig).unwrap().sensor;
        let nominal = RigFile::default().sensor;
        // Dead band and play, 0.06 degrees.
        let zero_deg = (sensor.zero_counts - nominal.zero_counts) * nominal.degrees_per_count;
        assert!(zero_deg.abs() < 0.1, "{zero_deg}");
    }

    #[test]
    fn angles_that_disagree_with_the_rig_file_are_doubtful_and_enter_writes_nothing() {
        let dir = tempfile::tempdir().unwrap();
        let rig = dir.path().join("rig.toml");
        let mut session = begin(&rig, "sim:bench");
        let before = std::fs::read_to_string(&rig).unwrap();
        for (position, angle) in ["-80", "-40", "0", "40", "80"].iter().enumerate() {
            session.answer(&format!("position {} of 5", position + 1), angle);
        }
        session.wait_for("not doubted", |seen| {
            seen.contains("DOUBTFUL: the angles are 2.0") && seen.contains("Put this into")
        });
        session.press("\r");
        // What it prints last may be read after its end.
        session.wait_for("no readings", |seen| seen.contains("--pairs=-80="));
        assert!(session.end().success(), "{}", session.seen());
        assert_eq!(before, std::fs::read_to_string(&rig).unwrap());
    }

    /// At real pace, as on a board: the run is followed while somebody thinks.
    #[test]
    fn ctrl_c_keeps_what_has_been_read_and_changes_nothing() {
        let dir = tempfile::tempdir().unwrap();
        let rig = dir.path().join("rig.toml");
        let mut session = begin(&rig, "sim:bench?realtime");
        let before = std::fs::read_to_string(&rig).unwrap();
        session.answer("position 1 of 5", "-40");
        session.wait_for("no question", |seen| seen.contains("position 2 of 5"));
        session.press("\x03");
        assert!(!session.end().success());
        session.wait_for("what has been read is lost", |seen| {
            seen.contains("--pairs=-40=")
        });
        assert_eq!(before, std::fs::read_to_string(&rig).unwrap());
        assert!(session.is_as_before());
    }
}

/// Beyond the end of its travel a servo is not where its pulses command it to be.
#[test]
fn a_servo_that_does_not_follow_is_said_to_not_follow() {
    for options in [&[][..], &["--no-travel"]] {
        let args = [
            &["calibrate", "--port", "sim:aircraft", "--by-servo"],
            options,
        ]
        .concat();
        let said = refusal(&args);
        assert!(
            said.contains("does not follow its pulses there") && said.contains("--travel-only"),
            "{said}"
        );
    }
    let travel = run(&["calibrate", "--port", "sim:aircraft", "--travel-only", "-q"]);
    let less = travel
        .lines()
        .filter(|line| line.contains("  answers less"));
    for line in less {
        let (_, percent) = line.split_once("with ").unwrap();
        let percent: f64 = percent.split(' ').next().unwrap().parse().unwrap();
        assert!(percent < 100.0, "{line}");
    }
    assert!(travel.contains("answers more from"), "{travel}");
}

/// A stop within the positions that are taken by themselves: the first refusal names the pulses with which the same command works.
#[test]
fn a_stop_within_the_positions_is_answered_with_pulses_that_work() {
    let dir = tempfile::tempdir().unwrap();
    let rig = dir.path().join("rig.toml");
    init(&rig, "sim:bench?stops-deg=-30:4");
    let command = [
        "calibrate",
        "-q",
        "--rig",
        arg(&rig),
        "--by-servo",
        "--update",
    ];
    let refused = refusal(&command);
    let (_, rest) = refused
        .split_once("take --pulses ")
        .expect("it names pulses");
    let (pulses, _) = rest.split_once(", between").unwrap();
    let found = run(&[&command[..], &["--pulses", pulses]].concat());
    assert!(found.contains("stops at 15"), "{found}");
    let written = std::fs::read_to_string(&rig).unwrap();
    assert!(written.contains("longest_us = 153"), "{written}");
}
