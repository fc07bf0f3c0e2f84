//! What the exports say, and what must not get into them.

use super::{SUBJECT, export, must, works};
use crate::support::{arg, refusal, run, servoid};
use servoid_test_support::tools::missing;
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::process::Command;

const TARGETS: [&str; 6] = ["matlab", "python", "julia", "c", "csv", "jsbsim"];

fn text(model: &Path, target: &str, more: &[&str]) -> String {
    let args = ["export", arg(model), "--to", target, "-q"];
    run(&[&args[..], more].concat())
}

/// The subject's file, changed.
fn changed(folder: &Path, change: impl Fn(&mut serde_json::Value)) -> PathBuf {
    let mut json = crate::support::json(&SUBJECT.file);
    change(&mut json);
    let path = folder.join("changed.json");
    std::fs::write(&path, json.to_string()).unwrap();
    path
}

#[test]
fn every_export_says_what_it_is() {
    for target in TARGETS {
        let text = text(&SUBJECT.file, target, &[]);
        // As prose: without the signs that begin the lines of a comment.
        let lines = text
            .lines()
            .map(|line| line.trim_start_matches(['#', '%', '*', ' ']));
        let prose = lines.collect::<Vec<_>>().join(" ");
        for said in [
            "bench 1.json",
            concat!("servoid ", env!("CARGO_PKG_VERSION")),
            "every 0.002 s",
            "the command is in deg, the position is in deg",
            "negative phase",
            "20.0 ms",
            "level 99",
            "ovariance of [K, L, ln w, ln zeta",
            "Largest difference of its step response",
        ] {
            assert!(prose.contains(said), "{target}: {said}");
        }
        assert!(!text.contains("{{") && !text.contains("NaN"), "{target}");
    }
}

#[test]
fn without_a_frame_hold_none_is_stated() {
    let held = text(&SUBJECT.file, "jsbsim", &[]);
    let free = text(&SUBJECT.file, "jsbsim", &["--frame-ms", "0"]);
    assert!(held.contains("<switch") && !free.contains("<switch"));
    assert!(free.contains("No frame hold"));
}

#[test]
fn bounds_that_do_not_hold_are_said_in_every_file_and_on_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let model = changed(folder.path(), |json| {
        json["advice"] = serde_json::json!([{
            "check": "model_error", "finding": "*/ --> not noise", "value": 1, "threshold": 0, "do": "x"
        }]);
        crate::support::withdraw(json);
        json["structure"]["selected_by"] = "narrow".into();
    });
    for target in TARGETS {
        let output = servoid(&["export", arg(&model), "--to", target])
            .output()
            .unwrap();
        let (text, errors) = (
            String::from_utf8(output.stdout).unwrap(),
            String::from_utf8(output.stderr).unwrap(),
        );
        for said in [&text, &errors] {
            assert!(said.contains("no bounds can be given"), "{target}: {said}");
            assert!(said.contains("narrow"), "{target}");
        }
        assert!(
            text.contains("WARNING") && !text.contains("level 99"),
            "{target}"
        );
    }
    let header = text(&model, "c", &[]);
    assert!(header.contains("BOUNDS_HOLD 0"));
    assert_eq!(header.matches("/*").count(), header.matches("*/").count());
}

#[test]
fn what_the_bounds_contain_beside_noise_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let model = changed(folder.path(), |json| {
        json["step"]["bounds"]["rounding_bias"] = 0.0125.into();
    });
    let text = text(&model, "csv", &[]);
    let said = "0.0125 of their half width is a bound of what the steps of the sensor may hide";
    assert!(text.replace("\n# ", " ").contains(said), "{text}");
}

#[test]
fn a_model_without_a_low_order_one_is_exported_as_far_as_it_goes() {
    let folder = tempfile::tempdir().unwrap();
    let model = changed(folder.path(), |json| {
        for row in json["bounds"]["covariance"].as_array_mut().unwrap() {
            row.as_array_mut().unwrap().fill(0.0.into());
        }
    });
    for target in ["matlab", "python", "julia", "c", "csv"] {
        let text = text(&model, target, &[]);
        assert!(text.contains("no low-order model"), "{target}");
    }
    let sentence = refusal(&["export", arg(&model), "--to", "jsbsim"]);
    assert!(sentence.contains("low-order"), "{sentence}");
    assert!(
        sentence.contains("identify with --servo-model"),
        "{sentence}"
    );
    let beside = crate::support::json(&super::servo_model::AIRCRAFT.file);
    let mut document = crate::support::json(&model);
    document["servo_model"] = beside["servo_model"].clone();
    std::fs::write(&model, document.to_string()).unwrap();
    let sentence = refusal(&["export", arg(&model), "--to", "jsbsim"]);
    let points = "take the servo model of the same file, which needs none, with --servo-model";
    assert!(sentence.ends_with(points), "{sentence}");
}

#[test]
fn a_low_order_model_in_the_file_is_the_one_that_is_exported() {
    let folder = tempfile::tempdir().unwrap();
    let mut flight = SUBJECT.flight.clone();
    flight.transfer.gain = 0.123_456_789;
    let with = |flight: serde_json::Value| {
        changed(folder.path(), |json| json["flight_model"] = flight.clone())
    };
    let model = with(serde_json::to_value(&flight).unwrap());
    assert!(text(&model, "jsbsim", &[]).contains("<gain>0.123456789</gain>"));
    flight.order = 7;
    let model = with(serde_json::to_value(&flight).unwrap());
    let sentence = refusal(&["export", arg(&model), "--to", "c"]);
    assert!(sentence.contains("contradicts"), "{sentence}");
}

#[test]
fn the_table_has_the_model_to_the_last_digit() {
    let table = text(&SUBJECT.file, "csv", &[]);
    assert_eq!(table, text(&SUBJECT.file, "simulink-csv", &[]));
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_reader(table.as_bytes());
    let names = reader.headers().unwrap().clone();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let column = |name: &str| -> Vec<f64> {
        let k = names.iter().position(|n| n == name).unwrap();
        let cells = rows
            .iter()
            .map(|row| &row[k])
            .filter(|cell| !cell.is_empty());
        cells.map(|cell| cell.parse().unwrap()).collect()
    };
    let model = &SUBJECT.model;
    assert_eq!(column("step"), model.step.value);
    assert_eq!(
        column("step_upper_simultaneous"),
        model.step.bounds.valid().unwrap().simultaneous.upper
    );
    assert_eq!(
        column("phase_deg_lower"),
        model.frequency.bounds.valid().unwrap().phase_deg_lower
    );
    // The servo itself, as terminal and report have it.
    let of_servo = model.servo_response(&model.frequency.omega_rad_s).unwrap();
    let pairs = column("servo_phase_deg")
        .into_iter()
        .zip(&of_servo.phase_deg);
    assert!(pairs.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs())) < 1e-6);
    assert_eq!(column("theta"), model.theta);
    for (k, expected) in (1..).zip(&model.bounds.valid().unwrap().covariance) {
        // Of a symmetric matrix columns are rows.
        assert_eq!(&column(&format!("theta_covariance_{k}")), expected);
    }
    assert_eq!(column("time_s")[0], model.sample_phase_s);
}

/// The sum that every export states.
#[test]
fn parameters_make_the_impulse_response_as_it_is_said() {
    let model = &SUBJECT.model;
    let n = model.structure.settling_samples as f64;
    for (i, h) in model.impulse_response().iter().enumerate() {
        let (mean, others) = model.theta.split_first().unwrap();
        let sum: f64 = others
            .chunks_exact(2)
            .zip(1..)
            .map(|(g, l)| {
                let q = std::f64::consts::TAU * f64::from(l) * i as f64 / n;
                g[0] * q.cos() - g[1] * q.sin()
            })
            .sum();
        // Some hundred terms below 1, each rounded to 53 bits.
        assert!(((mean + 2.0 * sum) / n - h).abs() < 1e-12, "h({i})");
    }
}

/// A name that tries to end strings, comments and lines in every language, and a harmless one that
/// gives the same identifier.
const HOSTILE: &str = "x\"; */ --> ' ] ) ??/\n%}\r\u{2028}\u{202e}=# \"\"\" $(y) \\";
const HARMLESS: &str = "x y";

#[test]
fn a_hostile_name_stays_a_name() {
    for target in TARGETS {
        let hostile = text(&SUBJECT.file, target, &["--name", HOSTILE]);
        let harmless = text(&SUBJECT.file, target, &["--name", HARMLESS]);
        let comment = match target {
            "matlab" => "% ",
            "c" => " * ",
            "jsbsim" => "  ",
            // Within the text of the module, which three quotes end.
            "python" => "",
            _ => "# ",
        };
        let known: HashSet<&str> = harmless.lines().collect();
        let new: Vec<&str> = hostile
            .lines()
            .filter(|line| !known.contains(line))
            .collect();
        assert!((1..=4).contains(&new.len()), "{target}: {new:?}");
        for line in new {
            let named = line.contains("NAME") || line.contains(".name = ");
            assert!(named || line.starts_with(comment), "{target}: {line}");
        }
        let end = match target {
            "c" => "*/",
            "jsbsim" => "-->",
            "python" => "\"\"\"",
            _ => "\u{202e}",
        };
        // Within a string it ends nothing.
        let count = |text: &str| -> usize {
            let lines = text.lines().filter(|line| !line.contains("_NAME \""));
            lines.map(|line| line.matches(end).count()).sum()
        };
        assert_eq!(count(&hostile), count(&harmless), "{target}");
    }
}

#[test]
fn a_hostile_name_runs_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let write = |target: &str, file: &str| {
        let path = folder.path().join(file);
        std::fs::write(&path, text(&SUBJECT.file, target, &["--name", HOSTILE])).unwrap();
        path
    };
    if works("cc", &["--version"]) {
        // With trigraphs, as -std=c99 has them.
        let header = write("c", "servo_x_y.h");
        let mut cc = Command::new("cc");
        cc.args([
            "-std=c99",
            "-Wall",
            "-Werror",
            "-Wno-trigraphs",
            "-fsyntax-only",
            "-x",
            "c",
        ]);
        must(cc.arg(header));
    } else {
        missing("a hostile name in C", "there is no C compiler 'cc'");
    }
    if works("python3", &["--version"]) {
        let xml = write("jsbsim", "servo_x_y.xml");
        let script = "import sys, xml.dom.minidom as x; x.parse(sys.argv[1])";
        must(Command::new("python3").args(["-c", script]).arg(xml));
    } else {
        missing("a hostile name in XML", "there is no python3");
    }
    if works("python3", &["-c", "import numpy"]) {
        write("python", "servo_x_y.py");
        let script =
            "import servo_x_y as s; assert s.NAME.startswith('x\"; */ --> \\' ] ) ??/ %}')";
        must(
            Command::new("python3")
                .args(["-c", script])
                .current_dir(folder.path()),
        );
    } else {
        missing("a hostile name in Python", "there is no python3 with numpy");
    }
}

/// A linear model has no limit, and what the recording had is all that is known.
#[test]
fn a_linear_file_says_which_commands_and_speeds_were_recorded() {
    let folder = tempfile::tempdir().unwrap();
    for target in ["matlab", "python", "c", "csv", "jsbsim"] {
        let text = std::fs::read_to_string(export(target, folder.path(), target)).unwrap();
        let said = text.replace(['\n', '#', '%', '*'], " ");
        let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
        let recorded =
            "Recorded: commands from -5.00 to 5.00 deg, and the position moved at more than ";
        assert!(said.contains(recorded), "{target}: {said}");
        let warning = "WARNING: no limit of the speed was seen up to ";
        assert!(
            said.contains(warning) && said.contains("a servo has one"),
            "{target}: {said}"
        );
    }
}

/// The text in one line, without the signs that begin the lines of a comment.
fn prose(text: &str) -> String {
    let text = text.replace(['\n', '#', '%', '*'], " ");
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Of one size, of several, and of a servo that is not linear, which moves otherwise in others.
#[test]
fn a_linear_file_says_for_which_strokes_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let of = |change: &dyn Fn(&mut serde_json::Value), target: &str| {
        prose(&text(&changed(folder.path(), change), target, &[]))
    };
    for target in TARGETS {
        let one_size = of(&|json| json["only_stroke"] = 10.0.into(), target);
        let said = "Strokes: all of the recording are of 10 deg, and this model is for those.";
        assert!(one_size.contains(said), "{target}: {one_size}");
        let several = of(
            &|json| {
                json.as_object_mut().unwrap().remove("only_stroke");
            },
            target,
        );
        assert!(!several.contains("Strokes:"), "{target}: {several}");
        let not_linear = of(
            &|json| {
                json["linear"] = false.into();
                json.as_object_mut().unwrap().remove("only_stroke");
            },
            target,
        );
        let said = "moves otherwise in smaller and in larger strokes. This model is for those of the recording together (commands from -5.00 to 5.00 deg).";
        assert!(not_linear.contains(said), "{target}: {not_linear}");
    }
}

/// The linear file and that of the servo model, from one function.
#[test]
fn both_files_say_what_rows_leave_open_of_the_delay() {
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().join("stairs.csv");
    let file = folder.path().join("stairs.json");
    let stairs = [
        "--servo",
        "bench",
        "--reference",
        "stairs",
        "--length",
        "20",
    ];
    run(&[&["simulate", "-o", arg(&record)], &stairs[..]].concat());
    run(&["identify", arg(&record), "--servo-model", "-o", arg(&file)]);
    let open = "if the servo followed it between them, its delay is up to 12.0 ms longer than in this file.";
    let mut document = crate::support::json(&file);
    for (moves, servo_model) in [(false, false), (false, true), (true, false), (true, true)] {
        if moves {
            document["moving_command"] = true.into();
            document["sensor_delay_uncertainty_s"] = 0.012.into();
        }
        std::fs::write(&file, document.to_string()).unwrap();
        let more: &[&str] = if servo_model { &["--servo-model"] } else { &[] };
        for target in ["python", "c", "jsbsim"] {
            let said = prose(&text(&file, target, more));
            assert_eq!(said.contains(open), moves, "{target} {servo_model}: {said}");
        }
    }
}
