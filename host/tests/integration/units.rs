//! Model files keep units and what held the command: what is in different units is not held against
//! each other, and exports state what is true.

use crate::support::{arg, data, json, refusal, run, servoid};
use std::path::Path;
use std::sync::LazyLock;

/// One servo: servoid's recording, the same as another program's tables with the command in degrees and
/// in microseconds, and models of all three.
struct Subject {
    folder: tempfile::TempDir,
}

/// How the columns of the tables are named to the program.
const COLUMNS: [&str; 6] = ["--input", "u", "--output", "y", "--period", "0.002"];

impl Subject {
    fn at(&self, name: &str) -> String {
        arg(&self.folder.path().join(name)).to_owned()
    }
}

static SUBJECT: LazyLock<Subject> = LazyLock::new(|| {
    let subject = Subject {
        folder: tempfile::tempdir().unwrap(),
    };
    let own = subject.at("own.csv");
    run(&["simulate", "--servo", "linear", "-o", &own]);
    run(&["identify", "-q", &own, "-o", &subject.at("own.json")]);
    for (name, unit, scale) in [("deg", "°", 1.0), ("us", "us", 10.0), ("bare", "", 1.0)] {
        let (table, model) = (
            subject.at(&format!("{name}.csv")),
            subject.at(&format!("{name}.json")),
        );
        std::fs::write(&table, foreign(Path::new(&own), unit, scale)).unwrap();
        let identify = ["identify", "-q", &table, "-o", &model];
        run(&[&identify[..], &COLUMNS].concat());
    }
    subject
});

/// A recording as another program's table, its command in another unit.
fn foreign(recording: &Path, unit: &str, scale: f64) -> String {
    let text = std::fs::read_to_string(recording).unwrap();
    let rows = text
        .lines()
        .filter(|line| !line.starts_with('#'))
        .collect::<Vec<_>>()
        .join("\n");
    let mut reader = csv::Reader::from_reader(rows.as_bytes());
    let names = reader.headers().unwrap().clone();
    let [input, output] = ["reference_deg", "position_deg"]
        .map(|name| names.iter().position(|column| column == name).unwrap());
    let mut table = match unit {
        "" => "u,y\n".to_owned(),
        _ => format!("u [{unit}],y [deg]\n"),
    };
    for row in reader.records().map(Result::unwrap) {
        let command: f64 = row[input].parse().unwrap();
        table += &format!("{},{}\n", scale * command, &row[output]);
    }
    table
}

#[test]
fn a_model_file_says_its_units_and_what_held_the_command() {
    let file = |name: &str| json(Path::new(&SUBJECT.at(name)));
    let own = file("own.json");
    assert_eq!(own["units"]["input"], "deg");
    assert_eq!(own["units"]["output"], "deg");
    assert_eq!(own["pulse_frame_s"], 0.02);
    let other = file("us.json");
    assert_eq!(other["units"]["input"], "us");
    assert_eq!(other["units"]["output"], "deg");
    assert!(other.get("pulse_frame_s").is_none());
    let bare = file("bare.json");
    assert!(bare.get("units").is_none() && bare.get("pulse_frame_s").is_none());
}

#[test]
fn what_is_in_different_units_is_not_held_against_each_other() {
    let [deg, us, own, bare] = ["deg", "us", "own", "bare"].map(|name| SUBJECT.at(name));
    let json = |name: &str| format!("{name}.json");
    let csv = |name: &str| format!("{name}.csv");
    for args in [
        vec!["compare", &json(&deg), &json(&us)],
        vec!["compare", &json(&us), &json(&own)],
        [&["compare", &csv(&deg), &csv(&us)], &COLUMNS[..]].concat(),
        [&["identify", &csv(&deg), &csv(&us)], &COLUMNS[..]].concat(),
        [&["validate", &json(&deg), &csv(&us)], &COLUMNS[..]].concat(),
        vec!["validate", &json(&us), &csv(&own)],
    ] {
        let sentence = refusal(&args);
        let units = sentence.contains("is in us, ") || sentence.contains(" in us: ");
        let others = ["is in °", "is in deg", " in °: ", " in deg: "];
        assert!(
            units && others.iter().any(|other| sentence.contains(other)),
            "{args:?}: {sentence}"
        );
        assert!(sentence.contains("the command of"), "{sentence}");
    }
    // What the last of them says to type works.
    let pulses = "add --input pulse_us --output position_deg";
    let sentence = refusal(&["validate", &json(&us), &csv(&own)]);
    assert!(sentence.contains(pulses), "{sentence}");
    let named = ["--input", "pulse_us", "--output", "position_deg"];
    run(&[&["validate", "-q", &json(&us), &csv(&own)], &named[..]].concat());
    let other = refusal(&[&["validate", &json(&deg), &csv(&us)], &COLUMNS[..]].concat());
    assert!(!other.contains(pulses), "{other}");
    // One unit under two spellings, and one that is not known.
    run(&["compare", "-q", &json(&deg), &json(&own)]);
    run(&["compare", "-q", &json(&bare), &json(&us)]);
    run(&["validate", "-q", &json(&deg), &csv(&own)]);
    run(&[&["validate", "-q", &json(&us), &csv(&us)], &COLUMNS[..]].concat());
}

#[test]
fn a_page_of_two_models_in_different_units_has_no_verdict() {
    let page = SUBJECT.at("page.html");
    let args = ["report", &SUBJECT.at("deg.json"), &SUBJECT.at("us.json")];
    let output = servoid(&[&args[..], &["-o", &page]].concat())
        .output()
        .unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{said}");
    assert!(
        said.contains("no verdict: the command of deg is in °"),
        "{said}"
    );
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains("\"units\":{\"input\":\"us\""));
}

/// An export as prose, without the signs that begin the lines of a comment.
fn prose(text: &str) -> String {
    let lines = text
        .lines()
        .map(|line| line.trim_start_matches(['#', '%', '*', ' ']));
    lines.collect::<Vec<_>>().join(" ")
}

#[test]
fn an_export_states_the_units_and_holds_as_the_model_says() {
    require_units_stated("jsbsim");
}

#[test]
#[ignore = "five seconds: cargo test -p servoid --test integration -- --ignored every_export_states_the_units"]
fn every_export_states_the_units_and_holds_as_the_model_says() {
    ["c", "csv", "matlab"]
        .into_iter()
        .for_each(require_units_stated);
}

fn require_units_stated(target: &str) {
    let golden = arg(&data("model-schema-1.json")).to_owned();
    let export = |model: &str, target: &str, more: &[&str]| {
        let args = ["export", model, "--to", target, "-q"];
        prose(&run(&[&args[..], more].concat()))
    };
    let (us, own, bare) = (
        SUBJECT.at("us.json"),
        SUBJECT.at("own.json"),
        SUBJECT.at("bare.json"),
    );
    let text = export(&us, target, &[]);
    assert!(
        text.contains("the command is in us, the position is in deg"),
        "{target}"
    );
    assert!(text.contains("in deg/us"), "{target}");
    for model in [&us, &bare, &golden] {
        let text = export(model, target, &[]);
        assert!(text.contains("is assumed: state"), "{target}");
        assert!(
            !text.contains("20.0 ms") && !text.contains("<switch"),
            "{target}"
        );
    }
    for (model, more) in [(&own, &[][..]), (&us, &["--frame-ms", "20"])] {
        let text = export(model, target, more);
        assert!(text.contains("20.0 ms"), "{target} {model}");
        assert!(
            !text.contains("is assumed: state") && !text.contains("hold is assumed ("),
            "{target} {model}"
        );
        assert_eq!(text.contains("<switch"), target == "jsbsim");
    }
    assert!(
        export(&bare, target, &[])
            .contains("the unit of the command is that of the recording, and not known")
    );
    let free = export(&own, target, &["--frame-ms", "0"]);
    assert!(free.contains("No frame hold is assumed"), "{target}");
}

/// The position at a pulse of 0 us, far from all that a servo gets, is none of the numbers that people ask for first.
#[test]
fn an_offset_at_no_pulse_is_left_out_of_the_first_numbers() {
    let numbers = |name: &str| {
        let page = SUBJECT.at(&format!("{name}.html"));
        let report = [
            "report",
            "-q",
            "--servo-model",
            &SUBJECT.at(&format!("{name}.csv")),
            "-o",
            &page,
        ];
        run(&[&report[..], &COLUMNS].concat());
        let page = std::fs::read_to_string(&page).unwrap();
        let (_, list) = page.split_once("<dl class=\"key\">").unwrap();
        list.split_once("</dl>").unwrap().0.to_owned()
    };
    assert!(numbers("deg").contains("<dt>offset</dt>"));
    assert!(!numbers("us").contains("<dt>offset</dt>"));
}
