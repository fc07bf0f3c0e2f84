//! Two sides that are held against each other and come from different programs.

use crate::support::{arg, data, refusal, run, servoid};
use std::path::{Path, PathBuf};

/// A recording of the linear servo, and another one as a table of another program.
fn recording_and_table(dir: &Path) -> [PathBuf; 2] {
    let [own, other, table] = ["own.csv", "other.csv", "table.csv"].map(|name| dir.join(name));
    for (file, seed) in [(&own, "1"), (&other, "2")] {
        run(&[
            "simulate",
            "--servo",
            "linear",
            "--seed",
            seed,
            "-o",
            arg(file),
        ]);
    }
    let text = std::fs::read_to_string(other).unwrap();
    let rows = text.lines().filter(|line| !line.starts_with('#'));
    let foreign: String = rows
        .map(|row| {
            let cells: Vec<&str> = row.split(',').collect();
            format!("{},{},{}\n", cells[1], cells[2], cells[3])
        })
        .collect();
    std::fs::write(&table, foreign.replace("_deg", "")).unwrap();
    [own, table]
}

const NAMED: [&str; 4] = ["--input", "reference", "--output", "position"];

#[test]
fn a_recording_and_a_table_are_held_against_each_other_in_one_call() {
    let dir = tempfile::tempdir().unwrap();
    let [own, table] = recording_and_table(dir.path());
    // Without the names of columns the sentence says what to add, and that is enough.
    let sentence = refusal(&["compare", arg(&own), arg(&table)]);
    assert!(sentence.contains(&NAMED.join(" ")), "{sentence}");
    for [a, b] in [[&own, &table], [&table, &own]] {
        let args = [&["compare", arg(a), arg(b)], &NAMED[..]].concat();
        let output = servoid(&args).output().unwrap();
        let [reported, remarks] =
            [output.stdout, output.stderr].map(|t| String::from_utf8(t).unwrap());
        assert!(
            // The table says nothing of its scale, and that of the recording is known to 5 % only.
            reported.contains("verdict                        undecided by")
                && reported.contains("±12.9 %"),
            "{reported}{remarks}"
        );
        assert!(
            remarks.contains("own.csv is read as the recording that it is"),
            "{remarks}"
        );
    }
    // A slip in the names is one of the side that they are for, whichever comes first.
    for [a, b] in [[&own, &table], [&table, &own]] {
        let sentence = refusal(&[
            "compare",
            arg(a),
            arg(b),
            "--input",
            "reference",
            "--output",
            "positoin",
        ]);
        assert!(sentence.contains("table.csv\" has no column"), "{sentence}");
    }
    let page = dir.path().join("x.html");
    run(&[
        &["report", arg(&own), arg(&table), "-o", arg(&page)],
        &NAMED[..],
    ]
    .concat());
}

#[test]
fn columns_that_a_recording_has_not_are_refused_by_themselves() {
    let dir = tempfile::tempdir().unwrap();
    let [own, _] = recording_and_table(dir.path());
    for command in ["identify", "compare"] {
        let files = if command == "compare" {
            vec![arg(&own), arg(&own)]
        } else {
            vec![arg(&own)]
        };
        let sentence = refusal(&[&[command], &files[..], &NAMED[..]].concat());
        assert!(
            sentence.contains("leave the names of columns out"),
            "{sentence}"
        );
    }
}

/// At a command of 0 a servo goes nowhere, and no share of that is too far.
#[test]
fn nothing_is_over_predicted_at_a_command_of_nought() {
    let dir = tempfile::tempdir().unwrap();
    let steps = dir.path().join("steps.csv");
    std::fs::write(
        &steps,
        "angle_deg,hold_s\n".to_owned() + &"5,0.4\n0,0.5\n5,0.3\n0,0.6\n".repeat(3),
    )
    .unwrap();
    let files = ["linear", "bench"].map(|servo| {
        let file = dir.path().join(format!("{servo}.csv"));
        run(&[
            "simulate",
            "--servo",
            servo,
            "--reference",
            arg(&steps),
            "-o",
            arg(&file),
        ]);
        file
    });
    let args = ["compare", "-q", arg(&files[1]), arg(&files[0])];
    let reported: serde_json::Value =
        serde_json::from_str(&run(&[&args[..], &["--json"]].concat())).unwrap();
    let over = &reported["over_prediction"];
    for (side, known) in [
        ("plus_percent", true),
        ("minus_percent", false),
        ("travel_percent", true),
    ] {
        for key in ["value", "lower", "upper"] {
            assert_eq!(over[side][key].is_number(), known, "{side}: {over}");
        }
    }
    assert!(run(&args).contains("- side -, travel"));
}

/// The same servo by a calibration that is 4 % steeper.
#[test]
fn different_calibrations_of_two_sides_are_named() {
    let dir = tempfile::tempdir().unwrap();
    let capture = |name: &str, degrees: &str| {
        let [rig, file] = ["toml", "csv"].map(|ending| dir.path().join(format!("{name}.{ending}")));
        let port = ["--port", "sim:linear"];
        let init = [
            "init",
            "--yes",
            "--sensor-degrees",
            degrees,
            "-o",
            arg(&rig),
        ];
        run(&[&init[..], &port[..]].concat());
        run(&["capture", "-q", "--rig", arg(&rig), "-o", arg(&file)]);
        file
    };
    let (a, b) = (capture("a", "120"), capture("b", "124.8"));
    let compared = |b: &Path| {
        let said = run(&["compare", arg(&a), arg(b)]);
        said.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let said = compared(&b);
    assert!(said.contains("is +4.00 % from that of the first"), "{said}");
    let said = compared(&a);
    assert!(!said.contains("calibrations of the sensor"), "{said}");
}

#[test]
fn files_without_sides_are_answered_with_the_command_that_names_them() {
    let said = refusal(&["report", "a.csv", "b.csv", "c.csv", "-o", "r.html"]);
    assert!(
        said.contains("servoid report --a a.csv b.csv --b c.csv"),
        "{said}"
    );
    let said = refusal(&["compare", "a.csv", "b.csv", "c.csv"]);
    assert!(
        said.contains("servoid compare --a a.csv b.csv --b c.csv"),
        "{said}"
    );
    let said = refusal(&["compare", "a.csv"]);
    assert!(
        said.contains("servoid compare --a a.csv --b OTHER.csv"),
        "{said}"
    );
}

#[test]
fn conditions_that_the_files_state_are_named_where_they_differ() {
    let dir = tempfile::tempdir().unwrap();
    let sides = ["bench", "aircraft"].map(|condition| {
        let file = dir.path().join(format!("{condition}.csv"));
        let port = format!("sim:{condition}?seed=5");
        run(&[
            "capture",
            "-q",
            "--port",
            &port,
            "--condition",
            condition,
            "-o",
            arg(&file),
        ]);
        file
    });
    let compared = |a: &Path, b: &Path| {
        let said = run(&["compare", "-q", arg(a), arg(b)]);
        said.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let said = compared(&sides[0], &sides[1]);
    assert!(
        said.contains("different conditions: the first is \"bench\", the second \"aircraft\""),
        "{said}"
    );
    assert!(
        said.contains("a load under the condition \"aircraft\", it holds a servo there"),
        "{said}"
    );
    assert!(!compared(&sides[0], &sides[0]).contains("different conditions"));
}

/// A recording of the linear servo with a sensor of this gain.
fn by_sensor(dir: &Path, name: &str, servo: &str) -> PathBuf {
    let file = dir.join(name);
    run(&["simulate", "-q", "--servo", servo, "-o", arg(&file)]);
    file
}

fn verdict_of(a: &Path, b: &Path) -> serde_json::Value {
    serde_json::from_str(&run(&["compare", "-q", arg(a), arg(b), "--json"])).unwrap()
}

#[test]
fn two_sensors_of_a_data_sheet_make_no_two_servos_of_one() {
    let dir = tempfile::tempdir().unwrap();
    let one = by_sensor(dir.path(), "one.csv", "linear?seed=21");
    let again = by_sensor(dir.path(), "again.csv", "linear?seed=31");
    let other = by_sensor(dir.path(), "other.csv", "linear?seed=31&sensor-gain=0.9");
    let slow = by_sensor(
        dir.path(),
        "slow.csv",
        "linear?seed=33&sensor-gain=0.95&delay-ms=40",
    );
    // One sensor, whose error is the same in both.
    let found = verdict_of(&one, &again);
    assert_eq!(found["verdict"], "same", "{}", found["summary"]);
    // Two sensors, each known to 5 %: 10 % less is no finding, a delay that is longer by 20 ms is.
    let found = verdict_of(&one, &other);
    assert_eq!(found["verdict"], "undecided", "{}", found["summary"]);
    let summary = found["summary"].as_str().unwrap();
    assert!(
        summary.contains("may be off from each other by ±18.2 %"),
        "{summary}"
    );
    assert!(
        found["advice"]
            .to_string()
            .contains("The scales of the two sides")
    );
    let found = verdict_of(&one, &slow);
    assert_eq!(found["verdict"], "different", "{}", found["summary"]);
    // Their models know as much.
    let models = [&one, &other].map(|file| {
        let model = file.with_extension("json");
        run(&["identify", "-q", arg(file), "-o", arg(&model)]);
        model
    });
    let found = verdict_of(&models[0], &models[1]);
    assert_eq!(found["verdict"], "undecided", "{}", found["summary"]);
}

#[test]
fn columns_of_two_sides_may_have_different_names() {
    let dir = tempfile::tempdir().unwrap();
    let [_, one] = recording_and_table(dir.path());
    let other = dir.path().join("other-names.csv");
    let text = std::fs::read_to_string(&one).unwrap();
    let text = text
        .replacen("reference", "u", 1)
        .replacen("position", "y", 1);
    std::fs::write(&other, text).unwrap();
    let sentence = refusal(&[&["compare", arg(&one), arg(&other)], &NAMED[..]].concat());
    assert!(
        sentence.contains("--input-b and --output-b those of the second"),
        "{sentence}"
    );
    let second = ["--input-b", "u", "--output-b", "y"];
    run(&[
        &["compare", "-q", arg(&one), arg(&other)],
        &NAMED[..],
        &second[..],
    ]
    .concat());
}

/// A sensor whose zero is off makes the same steps elsewhere: the first screen of the page says it beside the verdict.
#[test]
fn a_page_says_that_the_second_rests_elsewhere() {
    let dir = tempfile::tempdir().unwrap();
    let [a, b, page] = ["a.csv", "b.csv", "page.html"].map(|name| dir.path().join(name));
    run(&["simulate", "-q", "--servo", "bench", "-o", arg(&a)]);
    let off = "bench?sensor-zero-deg=8";
    run(&[
        "simulate",
        "-q",
        "--servo",
        off,
        "--seed",
        "2",
        "-o",
        arg(&b),
    ]);
    run(&["report", "-q", arg(&a), arg(&b), "-o", arg(&page)]);
    let page = std::fs::read_to_string(&page).unwrap();
    let screen = page.split("id=\"verdict\"").nth(1).unwrap();
    let (verdict, _) = screen.split_once("</p>").unwrap();
    assert!(
        verdict.contains("<b>same</b>") && verdict.contains("The second stands -"),
        "{verdict}"
    );
}

/// The columns of a recording were said when its model was made; a recording like it need not say them again.
#[test]
fn a_recording_beside_a_model_is_read_as_the_file_of_the_model() {
    let dir = tempfile::tempdir().unwrap();
    let [model, page] = ["m.json", "page.html"].map(|name| dir.path().join(name));
    let recording = data("dcmotor_speed_prbs.csv");
    let columns = ["--input", "u", "--output", "y"];
    run(&[
        &["identify", "-q", arg(&recording), "-o", arg(&model)],
        &columns[..],
    ]
    .concat());
    run(&[
        "report",
        "-q",
        arg(&model),
        arg(&recording),
        "-o",
        arg(&page),
    ]);
    assert!(page.exists());
    let said = refusal(&["compare", arg(&model), arg(&recording)]);
    assert!(
        said.contains(
            "is a model: compare two models, or recordings on both sides; here: servoid identify"
        ) && said.contains("--input u --output y -o ")
            && said.contains("then servoid compare "),
        "{said}"
    );
}
