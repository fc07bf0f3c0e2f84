//! Results that stand on nothing: exchanged columns, loops, models that do not predict, times that cannot be.

use crate::support::{arg, data, json, refusal, run, servoid};
use serde_json::Value;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Lines of a recording of a real servo: its head, and these rows.
fn part(dir: &Path, file: &str, rows: std::ops::Range<usize>) -> PathBuf {
    let whole = std::fs::read_to_string(data(file)).unwrap();
    let mut lines = whole.lines();
    let head = lines.next().unwrap();
    let rows: Vec<&str> = lines.skip(rows.start).take(rows.len()).collect();
    let path = dir.join(file);
    std::fs::write(&path, format!("{head}\n{}\n", rows.join("\n"))).unwrap();
    path
}

/// The text of an identification, and its document.
fn identified(file: &Path, columns: [&str; 2], more: &[&str]) -> (String, Value) {
    let [input, output] = columns;
    let args = [
        "identify",
        "-q",
        arg(file),
        "--input",
        input,
        "--output",
        output,
    ];
    let model = file.with_extension("json");
    let kept = ["--force", "-o", arg(&model)];
    let text = run(&[&args[..], more, &kept].concat());
    (text, json(&model))
}

fn checks(document: &Value) -> Vec<&str> {
    let advice = document["advice"].as_array().unwrap();
    advice
        .iter()
        .map(|item| item["check"].as_str().unwrap())
        .collect()
}

/// A chirp of a hobby servo with its columns exchanged: many values in both.
#[test]
fn exchanged_columns_have_no_headline_but_that() {
    let dir = tempfile::tempdir().unwrap();
    let chirp = part(dir.path(), "miuzei_rc_servo_large.csv", 0..150);
    let (text, document) = identified(&chirp, ["y", "u"], &[]);
    assert!(!text.contains("This servo is"), "{text}");
    let first = text
        .find("The output runs ahead of the input by 180 ms")
        .unwrap();
    let second = text
        .find("Neither the linear model nor the servo model predicts")
        .unwrap();
    assert!(
        first < second && second < text.find("NO BOUNDS").unwrap(),
        "{text}"
    );
    let found = checks(&document);
    assert_eq!(&found[..2], ["output_leads", "prediction"]);
    // What follows from the exchange is not advised beside it.
    for check in ["feedback", "smooth_reference", "metrics", "model_error"] {
        assert!(!found.contains(&check), "{check}: {text}");
    }
    let (text, document) = identified(&chirp, ["u", "y"], &[]);
    assert!(text.starts_with("This servo is limited"), "{text}");
    assert!(!checks(&document).contains(&"output_leads"));
}

/// The report begins so, too, and an export of such a servo model says it.
#[test]
fn a_model_that_does_not_predict_says_so_wherever_it_goes() {
    let dir = tempfile::tempdir().unwrap();
    let chirp = part(dir.path(), "miuzei_rc_servo_large.csv", 0..150);
    let [model, page] = ["m.json", "m.html"].map(|name| dir.path().join(name));
    let exchanged = [arg(&chirp), "--input", "y", "--output", "u"];
    run(&[&["identify", "-q", "-o", arg(&model)], &exchanged[..]].concat());
    let args = ["export", arg(&model), "--to", "c", "--servo-model"];
    let output = servoid(&args).output().unwrap();
    let [file, said] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    for text in [file.replace("\n * ", " "), said] {
        assert!(
            text.contains("does not predict its own recording"),
            "{text}"
        );
    }
    run(&[&["report", "-q", "-o", arg(&page)], &exchanged[..]].concat());
    let page = std::fs::read_to_string(&page).unwrap();
    let verdict = page.split("id=\"verdict\"").nth(1).unwrap();
    assert!(
        verdict.starts_with(">The output runs ahead"),
        "{}",
        &verdict[..200]
    );
    // The numbers of the paper's figures are those of its reference, which another program's recording has not.
    assert!(!page.contains("Fig. 5 of the paper"));
}

/// A linear servo under noise as large as its motion fits to 30 %, and that is all that noise leaves: the sentence stands.
#[test]
fn noise_makes_a_fit_poor_and_not_a_right_model_wrong() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("noisy.csv");
    let (mut random, mut level, mut servo) = (1u32, 1.0, 0.0);
    let mut text = "t,u,y\n".to_owned();
    for k in 0..2000 {
        let mut next = || {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(random >> 8) / f64::from(1 << 24) - 0.5
        };
        if k % 20 == 0 {
            level = (10.0 * next()).round();
        }
        servo += 0.2 * (level - servo);
        let noise = 3.0 * (next() + next() + next() + next());
        writeln!(text, "{},{level},{}", f64::from(k) * 0.01, servo + noise).unwrap();
    }
    std::fs::write(&file, text).unwrap();
    let (text, document) = identified(&file, ["u", "y"], &["--servo-model"]);
    assert!(text.starts_with("This servo is"), "{text}");
    let unwrapped: Vec<&str> = text.split_whitespace().collect();
    let noise = "Noise alone would leave";
    assert!(unwrapped.join(" ").contains(noise), "{text}");
    assert!(!checks(&document).contains(&"prediction"));
}

/// A sum of sines that a planned command is has no loop behind it, however strange the response at its first sample is.
#[test]
fn a_smooth_reference_is_not_taken_for_a_closed_loop() {
    let dir = tempfile::tempdir().unwrap();
    let sines = part(dir.path(), "bam_xl330_pendulum.csv", 0..1200);
    let (text, document) = identified(&sines, ["u", "y"], &[]);
    assert!(!checks(&document).contains(&"feedback"), "{text}");
    assert_eq!(document["withdrawn"]["reason"], "input_unexcited");
    assert!(text.starts_with("This servo is"), "{text}");
}

/// Each run answers a step that came before its first sample.
#[test]
fn runs_of_one_command_ask_for_the_input_before_them() {
    let dir = tempfile::tempdir().unwrap();
    let files: Vec<PathBuf> = [10.0, -10.0]
        .iter()
        .enumerate()
        .map(|(number, level)| {
            let mut text = "t,u,y\n".to_owned();
            for k in 0..300 {
                let (time, noise) = (f64::from(k) * 0.005, f64::from(k * 7919 % 101) * 1e-3);
                let y = level * (1.0 - (-time / 0.05).exp()) + noise;
                writeln!(text, "{time},{level},{y}").unwrap();
            }
            let path = dir.path().join(format!("{number}.csv"));
            std::fs::write(&path, text).unwrap();
            path
        })
        .collect();
    let [a, b] = [arg(&files[0]), arg(&files[1])];
    let columns = ["--input", "u", "--output", "y"];
    let said = refusal(&[&["compare", "--a", a, b, "--b", b, a], &columns[..]].concat());
    assert!(
        said.contains("the step that each run answers came before"),
        "{said}"
    );
    assert!(said.contains("--at-rest INPUT"), "{said}");
    let short = part(dir.path(), "dcmotor_position_stairs.csv", 0..90);
    let said = refusal(&[&["compare", arg(&short), arg(&short)], &columns[..]].concat());
    assert!(
        said.contains("record longer") && !said.contains("--settling"),
        "{said}"
    );
}

/// Without a column of time only the response shows that a period cannot be.
#[test]
fn a_response_that_takes_longer_than_any_servo_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let recording = dir.path().join("bench.csv");
    run(&["simulate", "-q", "--servo", "linear", "-o", arg(&recording)]);
    let whole = std::fs::read_to_string(&recording).unwrap();
    let rows = whole.lines().filter(|line| !line.starts_with('#'));
    let columns: Vec<&str> = rows.clone().next().unwrap().split(',').collect();
    let place = |name: &str| columns.iter().position(|column| *column == name).unwrap();
    let (u, y) = (place("reference_deg"), place("position_deg"));
    let bare = dir.path().join("bare.csv");
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        format!("{},{}\n", cells[u], cells[y])
    };
    std::fs::write(&bare, rows.map(row).collect::<String>()).unwrap();
    let names = [columns[u], columns[y]];
    let (text, document) = identified(&bare, names, &["--period", "0.2"]);
    assert!(text.contains("longer than any R/C servo takes"), "{text}");
    assert_eq!(checks(&document)[0], "duration");
    assert!(!text.contains("is half way after"), "{text}");
    let (text, _) = identified(&bare, names, &["--period", "2"]);
    assert!(
        text.contains("times and frequencies are left out")
            && !text.contains("time to 50 %")
            && !text.contains("is half way after"),
        "{text}"
    );
    let (text, document) = identified(&bare, names, &["--period", "0.002"]);
    assert!(!checks(&document).contains(&"duration"), "{text}");
}

/// Triangles and squares under a servo that is not linear: what comes next in them is related to its errors, and no controller makes them.
#[test]
fn planned_triangles_are_not_taken_for_a_closed_loop() {
    let dir = tempfile::tempdir().unwrap();
    let runs_34_to_49 = part(dir.path(), "miuzei_rc_servo_large.csv", 3350..4950);
    let how = ["--run", "run", "--at-rest", "0"];
    let (text, document) = identified(&runs_34_to_49, ["u", "y"], &how);
    assert!(!checks(&document).contains(&"feedback"), "{text}");
    // Without intervals the sentence has what the record shows, and the table how far other fits go apart.
    assert!(
        text.starts_with("This servo is limited in its speed and moved at more than "),
        "{text}"
    );
    let delay = &document["servo_model"]["quantities"][0];
    assert_eq!(
        (&delay["name"], &delay["bounds"]),
        (&"delay".into(), &Value::Null)
    );
    let of = |key: &str| delay["other_fits"][key].as_f64().unwrap();
    assert!(of("least") + 0.01 < of("most"), "{delay}");
}

/// The drift is as large as the strokes, and no straight line.
#[test]
fn a_drift_that_hides_the_motion_is_named_before_wrong_columns() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("drift.csv");
    let random = |k: usize| (0.7 * (k * k) as f64).sin();
    let mut rows = "u_deg,y_deg\n".to_owned();
    let mut at = 0.0;
    for k in 0..2000 {
        let level = 3.0 * random(k / 20);
        at += 0.2 * (level - at);
        let drift = 2.0 * (f64::from(k as u32) / 250.0).sin();
        rows += &format!("{level:.4},{:.4}\n", at + drift + 0.05 * random(7 * k + 1));
    }
    std::fs::write(&file, rows).unwrap();
    let (text, document) = identified(&file, ["u_deg", "y_deg"], &["--period", "0.02"]);
    assert_eq!(checks(&document)[0], "prediction", "{text}");
    let remedy = document["advice"][0]["do"].as_str().unwrap();
    assert!(remedy.starts_with("The errors are slow"), "{remedy}");
    assert!(remedy.contains("--detrend linear"), "{remedy}");
}

/// A servo with a lag of 30 ms after 12 ms, at 50 rows a second: a logger reads command and position by its own clock. The sine of a
/// square stands for random numbers.
fn polled(path: &Path) {
    let random = |k: usize| (0.7 * (k * k) as f64).sin();
    let mut rows = "u_deg,y_deg\n".to_owned();
    let mut commands = vec![0.0; 500];
    while commands.len() < 25_000 {
        let (level, held) = (
            4.0 * random(commands.len()),
            150.0 + 100.0 * random(3 * commands.len()),
        );
        commands.extend(std::iter::repeat_n(level, held as usize));
    }
    let mut at = 0.0;
    for k in 0..25_000 {
        if k % 10 == 0 {
            rows += &format!("{:.4},{:.4}\n", commands[k], at + 0.05 * random(7 * k + 1));
        }
        at += 0.002 / 0.03 * (commands[k.saturating_sub(6)] - at);
    }
    std::fs::write(path, rows).unwrap();
}

#[test]
fn commands_that_change_between_rows_are_suspected_and_corrected() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("polled.csv");
    polled(&file);
    let names = ["u_deg", "y_deg"];
    let (text, document) = identified(&file, names, &["--period", "0.02"]);
    assert_eq!(checks(&document)[0], "commands_between_rows", "{text}");
    let said = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains("half a row, 10 ms, too early"), "{text}");
    let metrics = &document["metrics"];
    assert_eq!(document["withdrawn"]["reason"], "commands_between_rows");
    assert_eq!(metrics["t50_s"]["value"], Value::Null, "{text}");
    assert!(metrics["dc_gain"]["value"].is_number(), "{text}");
    let half_way = |document: &Value| {
        let metrics = &document["metrics"]["t50_s"];
        ["lower", "value", "upper"].map(|end| metrics[end].as_f64().unwrap())
    };
    // 12 ms + 30 ms ln 2.
    let truth = 0.0328;
    let (text, document) = identified(&file, names, &["--period", "0.02", "--polled"]);
    let found = checks(&document);
    assert!(!found.contains(&"commands_between_rows"), "{text}");
    assert!(document["linear"] == true && !document["bounds"].is_null());
    let [lower, value, upper] = half_way(&document);
    assert!((lower..upper).contains(&truth), "{text}");
    // A quarter of a row: the changes of this command do not lie evenly between rows.
    assert!((value - truth).abs() < 0.005, "{value}");
    // Another file of that model is not silently taken as polled, too.
    let model = file.with_extension("json");
    let taken = |more: &[&str]| {
        let validated = [&["validate", arg(&model), arg(&file)], more].concat();
        let said = servoid(&validated).output().unwrap().stderr;
        String::from_utf8_lossy(&said).contains("taken as polled")
    };
    assert!(taken(&[]) && !taken(&["--polled"]));
}

/// A linear servo (60 rad/s, damping 0.7) in rows of 10 ms, whose column of the command has noise that it was not sent.
fn with_noisy_command(path: &Path) {
    let random = |k: usize| (0.7 * (k * k) as f64).sin();
    let mut rows = "t,u_deg,y_deg\n".to_owned();
    let (mut angle, mut speed, mut k) = (0.0, 0.0, 0);
    for stroke in 0..70 {
        let level = 5.0 * (3.0 * random(7 * stroke + 1)).round();
        for _ in 0..(45.0 + 30.0 * random(3 * stroke + 2)) as usize {
            let command = level + 0.5 * (random(11 * k + 3) + random(13 * k + 5));
            let seen = angle + 0.1 * (random(17 * k + 1) + random(19 * k + 4));
            rows += &format!("{:.2},{command:.3},{seen:.3}\n", 0.01 * k as f64);
            k += 1;
            for _ in 0..100 {
                speed += 1e-4 * (3600.0 * (level - angle) - 84.0 * speed);
                angle += 1e-4 * speed;
            }
        }
    }
    std::fs::write(path, rows).unwrap();
}

#[test]
fn noise_in_the_column_of_the_command_is_no_fault_of_the_servo() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("noisy.csv");
    with_noisy_command(&file);
    let (text, document) = identified(&file, ["u_deg", "y_deg"], &[]);
    let said = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(!said.contains("servo is not linear"), "{text}");
    assert!(checks(&document).contains(&"command_noise"), "{text}");
    let hides =
        "What looks like noise in the column of the command hides whether this servo is linear";
    assert!(said.contains(hides), "{text}");
}

/// What a rig file leaves open, or gets wrong, is said where the servo was captured or identified.
#[test]
fn the_scale_the_direction_and_the_place_of_a_servo_are_doubted() {
    let dir = tempfile::tempdir().unwrap();
    let [against, narrow, recording] =
        ["against.toml", "narrow.toml", "r.csv"].map(|name| dir.path().join(name));
    let init = |file: &std::path::Path, option: &str| {
        run(&[
            "init",
            "-q",
            "--yes",
            "--port",
            "sim:linear",
            option,
            "-o",
            arg(file),
        ]);
    };
    init(&against, "--us-per-degree=-10");
    init(&narrow, "--pulse-type=narrow");
    let capture = |rig: &std::path::Path| {
        run(&[
            "capture",
            "-q",
            "--rig",
            arg(rig),
            "--port",
            "sim:linear",
            "--force",
            "-o",
            arg(&recording),
        ])
    };
    assert!(!capture(&against).contains("warning"));
    let said = run(&["identify", "-q", arg(&recording)]);
    assert!(
        said.contains("The position goes against the command"),
        "{said}"
    );
    // A rig file that was not calibrated.
    assert!(
        said.contains("The scale of the sensor is known to ±12.9 % only")
            && said.contains("Calibrate ('servoid calibrate')"),
        "{said}"
    );
    // One that was is not sent to be calibrated as if it were not.
    let rig = std::fs::read_to_string(&against).unwrap();
    let (before, after) = rig.split_once("scale_sd_percent = 5.0").unwrap();
    std::fs::write(&against, format!("{before}scale_sd_percent = 0.524{after}")).unwrap();
    capture(&against);
    let said = run(&["identify", "-q", arg(&recording)]);
    assert!(
        said.contains("known to ±1.3 % only")
            && said.contains("It was calibrated. More positions,"),
        "{said}"
    );
    assert!(!said.contains("Calibrate ('servoid calibrate')"), "{said}");
    let said = capture(&narrow);
    assert!(said.contains("warning: the position lies"), "{said}");
}

/// The page says no time of an end that the record does not show, which the table beside it has with a lower bound alone.
#[test]
fn a_page_has_no_settling_time_where_the_end_is_open() {
    let dir = tempfile::tempdir().unwrap();
    let page = dir.path().join("page.html");
    let recording = data("dcmotor_speed_prbs.csv");
    let columns = ["--input", "u", "--output", "y"];
    run(&[
        &["report", "-q", arg(&recording), "-o", arg(&page)],
        &columns[..],
    ]
    .concat());
    let page = std::fs::read_to_string(&page).unwrap();
    let screen = page.split("id=\"verdict\"").nth(1).unwrap();
    let (verdict, numbers) = screen.split_once("</p>").unwrap();
    assert!(numbers.contains("105.0 or more"), "{verdict}");
    assert!(
        verdict.contains("is half way after") && !verdict.contains("stays within"),
        "{verdict}"
    );
}

/// That there are no bounds is the answer, and comes before what follows from it.
#[test]
fn the_first_line_on_a_stop_is_that_there_are_no_bounds() {
    let dir = tempfile::tempdir().unwrap();
    let [file, model, page] =
        ["stop.csv", "stop.json", "stop.html"].map(|name| dir.path().join(name));
    let servo = "bench?stops-deg=-30:4";
    let stairs = ["--reference", "stairs", "--amplitude", "20", "--seed", "5"];
    run(&[
        &["simulate", "-q", "--servo", servo, "-o", arg(&file)],
        &stairs[..],
        // Half of the usual hold, in which this servo rests, too.
        &["--hold", "0.5"],
    ]
    .concat());
    let text = run(&["identify", "-q", arg(&file), "-o", arg(&model)]);
    let mut lines = text.lines().skip(1);
    let first = lines.next().unwrap_or_default();
    assert!(
        first.starts_with("No bounds can be given, because"),
        "{text}"
    );
    run(&["report", "-q", arg(&model), "-o", arg(&page)]);
    let page = std::fs::read_to_string(&page).unwrap();
    assert!(page.contains("id=\"verdict\">No bounds can be given. The output stops at"));
}
