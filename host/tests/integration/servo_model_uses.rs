//! What a servo model is used for: to be simulated, reported, compared and planned with.

use crate::report::embedded;
use crate::support::{
    SHORT_STAIRS, arg, data, identify_servo_model, json, modelled, refusal, run, withdraw,
};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A drive with a limit is later in larger strokes, which is no delay of the recording.
#[test]
fn a_servo_that_is_not_linear_is_not_called_late() {
    let dir = tempfile::tempdir().unwrap();
    let stairs = ["--reference", "stairs", "--length", "12", "--hold", "0.6"];
    let model = modelled(dir.path(), "stairs", "bench", &stairs);
    let other = dir.path().join("other.csv");
    let simulate = ["simulate", "-q", "--servo", "bench", "--seed", "2"];
    run(&[&simulate[..], &["-o", arg(&other)]].concat());
    let said = run(&["validate", "-q", arg(&model), arg(&other)]);
    assert!(
        said.contains("The linear model does not hold here") && !said.contains("It is a delay"),
        "{said}"
    );
}

/// Some of the rows of a recording as a table of another program.
fn table(recording: &Path, table: &Path, rows: impl Fn(usize) -> bool) {
    let text = std::fs::read_to_string(recording).unwrap();
    let lines = text
        .lines()
        .filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    let mut out = String::from("t_s,u_deg,y_deg\n");
    for (_, row) in lines.enumerate().filter(|(number, _)| rows(*number)) {
        let cells: Vec<&str> = row.split(',').collect();
        out += &format!("{},{},{}\n", cells[1], cells[2], cells[3]);
    }
    std::fs::write(table, out).unwrap();
}

#[test]
fn a_recording_without_the_column_of_runs_of_the_model_is_one_run() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name);
    let recording = path("a.csv");
    let simulate = ["simulate", "-q", "--servo", "bench", "-o", arg(&recording)];
    run(&[&simulate[..], &SHORT_STAIRS].concat());
    table(&recording, &path("plain.csv"), |_| true);
    let plain = std::fs::read_to_string(path("plain.csv")).unwrap();
    let with_run: String = plain
        .lines()
        .map(|line| {
            format!(
                "{line},{}\n",
                if line.starts_with('t') { "part" } else { "1" }
            )
        })
        .collect();
    std::fs::write(path("runs.csv"), with_run).unwrap();
    let columns = ["--input", "u_deg", "--output", "y_deg", "--run", "part"];
    let model = path("m.json");
    run(&[
        &["identify", "-q", arg(&path("runs.csv")), "-o", arg(&model)],
        &columns[..],
    ]
    .concat());
    let output = crate::support::servoid(&["validate", arg(&model), arg(&path("plain.csv"))])
        .output()
        .unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        output.status.success() && said.contains("there is no column \"part\" here"),
        "{said}"
    );
}

fn quantities(model: &Value) -> Vec<(String, f64, Value)> {
    let all = model["servo_model"]["quantities"].as_array().unwrap();
    let one = |quantity: &Value| {
        (
            quantity["name"].as_str().unwrap().to_owned(),
            quantity["value"].as_f64().unwrap(),
            quantity["bounds"].clone(),
        )
    };
    all.iter().map(one).collect()
}

/// A model is simulated, and the recording identified: the second model must not contradict the first.
#[test]
fn a_simulated_model_is_found_again() {
    let dir = tempfile::tempdir().unwrap();
    let first = modelled(dir.path(), "first", "bench", &SHORT_STAIRS);
    let again = modelled(
        dir.path(),
        "again",
        arg(&first),
        &[&SHORT_STAIRS[..], &["--seed", "2"]].concat(),
    );
    // Too short for the linear model, and of another sample period.
    let (short, seldom) = (dir.path().join("short.csv"), dir.path().join("seldom.csv"));
    table(&dir.path().join("again.csv"), &short, |row| {
        (395..440).contains(&row)
    });
    table(&dir.path().join("again.csv"), &seldom, |row| row % 10 == 0);
    for (recording, because) in [(&short, "no sample"), (&seldom, "every 20 ms")] {
        let args = ["validate", arg(&first), arg(recording), "--json"];
        let named = "--input u_deg --output y_deg --time t_s".split(' ');
        let args: Vec<&str> = args.into_iter().chain(named).collect();
        let found: Value = serde_json::from_str(&run(&args)).unwrap();
        assert!(found["fit_percent"].is_null(), "{found}");
        let fit = found["servo_model"]["fit_percent"].as_f64().unwrap();
        // Noise of .05 deg beside strokes of degrees; the rows of a table are taken to be at the edges of the command.
        assert!(fit > 90.0, "{found}");
        let said = found["advice"][0]["finding"].as_str().unwrap();
        assert!(
            said.starts_with("The servo model alone is validated") && said.contains(because),
            "{said}"
        );
    }
    let (first, again) = (json(&first), json(&again));
    assert_eq!(
        first["servo_model"]["terms"]["limit"], true,
        "the servo must not be linear"
    );
    assert!(
        again["servo_model"]["withdrawn"].is_null(),
        "{}",
        again["servo_model"]["withdrawn"]
    );
    let truth = quantities(&first);
    let mut compared = 0;
    for (name, _, bounds) in quantities(&again) {
        let Some((_, value, _)) = truth.iter().find(|(known, ..)| *known == name) else {
            continue;
        };
        let [lower, upper] = ["lower", "upper"].map(|end| bounds[end].as_f64());
        assert!(
            lower.is_none_or(|lower| lower <= *value) && upper.is_none_or(|upper| *value <= upper),
            "{name}: {value} is not in {bounds}"
        );
        compared += usize::from(lower.is_some() && upper.is_some());
    }
    // Delay, gain, offset, bandwidth, damping ratio, two accelerations, error of full drive; a top speed that the strokes do not
    // reach has a lower bound alone.
    assert!(compared >= 8, "{compared}");
}

#[test]
fn what_cannot_be_simulated_is_refused_in_a_sentence() {
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    let text = |value: &Value| serde_json::to_string(value).unwrap();
    let model = at("m.json");
    let file = data("dcmotor_position_stairs.csv");
    let columns = ["--input", "u", "--output", "y", "--period", "0.02"];
    identify_servo_model(&file, &model, &columns);
    let good = json(&model);
    let altered = |name: &str, alter: &dyn Fn(&mut Value)| {
        let mut document = good.clone();
        alter(&mut document);
        std::fs::write(at(name), text(&document)).unwrap();
        at(name)
    };
    let linear = altered("linear.json", &|of| {
        of.as_object_mut().unwrap().remove("servo_model");
    });
    let counts = altered("counts.json", &|of| {
        of["units"] = serde_json::json!({ "input": "counts", "output": "deg" });
    });
    let far = altered("far.json", &|of| {
        of["servo_model"]["values"][4] = 500.into(); // its offset
    });
    let two = altered("two.json", &|of| {
        let model = &mut of["servo_model"];
        model["controllers"] = 2.into();
        model["controller_names"] = serde_json::json!([400, 800]);
        let own = model["coordinates"].as_array_mut().unwrap();
        own.push(serde_json::json!({ "ln_own_stiffness": 1 }));
        model["values"].as_array_mut().unwrap().push(0.5.into());
        withdraw(model);
        model["alternatives"] = serde_json::json!([]);
    });
    let out = at("x.csv");
    let simulate =
        |model: &Path| ["simulate", "--servo", arg(model), "-o", arg(&out)].map(str::to_owned);
    for (model, further, words) in [
        (&linear, &[][..], "has no servo model"),
        (&counts, &[], "the command of"),
        (
            &far,
            &[],
            "subtract 500 from the column of the position, so that neutral is 0",
        ),
        (&two, &[], "has the controllers 400, 800: choose one"),
        (
            &two,
            &["--controller", "500"],
            "no controller 500: it has 400, 800",
        ),
        (
            &model,
            &["--controller", "500"],
            "no controller 500: all of its recording",
        ),
    ] {
        let args = simulate(model);
        let args: Vec<&str> = args.iter().map(String::as_str).collect();
        let said = refusal(&[&args[..], further].concat());
        assert!(said.contains(words), "{words}: {said}");
        assert!(!out.exists(), "{words}");
    }
    let args = simulate(&two);
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    run(&[&args[..], &["-q", "--controller", "800"]].concat());
}

/// The lines below "servo model:" of the terminal that are no row of its table, each joined to one.
fn remarks(text: &str) -> Vec<String> {
    let (_, of_servo) = text.split_once("\nservo model: ").unwrap();
    let words: Vec<&str> = of_servo.split_whitespace().collect();
    let joined = words.join(" ");
    let sentences = ["A stroke of 60 degrees takes ", "No intervals can be given"];
    let of = |start: &&str| Some(joined[joined.find(start)?..].split_once('.')?.0.to_owned());
    sentences.iter().filter_map(of).collect()
}

#[test]
fn a_page_says_of_a_servo_what_the_terminal_says() {
    let dir = tempfile::tempdir().unwrap();
    // Strokes that show the top speed.
    let stairs = "--reference stairs --levels 5 --amplitude 30 --hold 0.4 --length 8";
    let stairs: Vec<&str> = stairs.split(' ').collect();
    let model = modelled(dir.path(), "bench", "bench", &stairs);
    let mut document = json(&model);
    document["servo_model"]["stops"] = serde_json::json!({ "upper": 45 });
    std::fs::write(&model, document.to_string()).unwrap();
    let page = dir.path().join("page.html");
    run(&["report", "-q", arg(&model), "-o", arg(&page)]);
    let page = std::fs::read_to_string(&page).unwrap();
    let (_, of_servo) = page.split_once("The servo as a machine: ").unwrap();
    assert!(of_servo.contains("The servo has a stop at 45.00 deg."));
    assert!(of_servo.contains("s/60°</td>"));
    let said = run(&[
        "identify",
        "--servo-model",
        arg(&dir.path().join("bench.csv")),
    ]);
    let remarks = remarks(&said);
    assert!(!remarks.is_empty(), "{said}");
    for remark in remarks {
        assert!(of_servo.contains(&remark), "{remark}");
    }
    let [up, down] = [0, 1].map(|way| &document["servo_model"]["stroke_of_60_degrees_s"][way]);
    assert!(
        up.as_f64() > Some(0.05) && down.as_f64() > Some(0.05),
        "{up} {down}"
    );
}

#[test]
fn a_report_begins_with_the_servo_and_shows_a_stretch_that_it_has_not_seen() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("report.html");
    let file = data("dcmotor_position_stairs.csv");
    let columns = ["--input", "u", "--output", "y", "--period", "0.02"];
    let report = ["report", "-q", arg(&file), "--servo-model", "-o", arg(&out)];
    run(&[&report[..], &columns].concat());
    let page = std::fs::read_to_string(&out).unwrap();
    let body = page.split_once("</h1>").unwrap().1;
    let sentence = body.find("This servo is ").unwrap();
    let data = body.find("one run").unwrap();
    assert!(sentence < data, "the servo comes first");
    assert!(
        body.contains("The servo as a machine") && body.contains("the last fifth of the last run")
    );
    let figures = embedded(&page, "figures");
    let figures = figures.as_array().unwrap();
    let drawn = |name: &str| figures.iter().find(|figure| figure["name"] == name);
    let held_out = drawn("held-out-first").unwrap();
    let names: Vec<&str> = held_out["data"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|curve| curve["name"].as_str())
        .collect();
    for name in ["measured", "linear model, fit", "servo model, fit"] {
        assert!(
            names.iter().any(|drawn| drawn.starts_with(name)),
            "{names:?}"
        );
    }
    let models = embedded(&page, "models");
    assert!(models[0]["servo_model"]["quantities"].is_array());

    let plots = dir.path().join("plots");
    let identify = [
        "identify",
        "-q",
        arg(&file),
        "--servo-model",
        "--plots",
        arg(&plots),
    ];
    run(&[&identify[..], &columns].concat());
    let drawing = plots.join("dcmotor_position_stairs-servo-model.svg");
    let drawing = std::fs::read_to_string(drawing).unwrap();
    assert!(drawing.contains("servo model, fit") && drawing.contains("measured - model"));
}

#[test]
fn servo_models_are_compared_where_both_have_one() {
    let dir = tempfile::tempdir().unwrap();
    let model = |name: &str, servo: &str| modelled(dir.path(), name, servo, &SHORT_STAIRS);
    let (early, late) = (
        model("early", "linear?delay-ms=10"),
        model("late", "linear?delay-ms=20"),
    );
    let found = run(&["compare", arg(&early), arg(&late), "--json"]);
    let found: Value = serde_json::from_str(&found).unwrap();
    let servos = &found["servo_model"];
    assert_eq!(servos["bounds"]["level"], 0.99);
    let differences = servos["bounds"]["differences"].as_array().unwrap();
    let of = |name: &str| differences.iter().find(|one| one["name"] == name).unwrap();
    let delay = &of("delay")["difference"];
    let [lower, upper] = ["lower", "upper"].map(|end| delay[end].as_f64().unwrap());
    assert!(0.0 < lower && lower < 0.010 && 0.010 < upper, "{delay}");
    let text = run(&["compare", arg(&early), arg(&late)]);
    assert!(
        text.contains("As machines A and B differ in these") && text.contains(" ms in A, "),
        "{text}"
    );

    // Two levels only: no intervals, and nothing about the difference.
    let withdrawn = modelled(dir.path(), "two-levels", "linear", &[]);
    let found = run(&["compare", arg(&early), arg(&withdrawn), "--json"]);
    let found: Value = serde_json::from_str(&found).unwrap();
    let servos = &found["servo_model"];
    assert_eq!(servos["withdrawn"]["reason"], "few_levels");
    assert!(servos["bounds"].is_null() && servos["quantities"][0]["b"].is_f64());
    let text = run(&["compare", arg(&early), arg(&withdrawn)]);
    assert!(text.contains("no statement about the difference"), "{text}");
    let linear = dir.path().join("linear.json");
    let file = dir.path().join("early.csv");
    run(&["identify", "-q", arg(&file), "-o", arg(&linear)]);
    let said = refusal(&["compare", arg(&early), arg(&linear), "--servo-model"]);
    assert!(said.contains("has no servo model"), "{said}");
}

/// Steps under a servo whose speed alone is limited, at 100 samples a second. The sine of a square stands for random numbers.
fn rate_limited(dir: &Path, name: &str, first: usize, top_speed: f64) -> PathBuf {
    let levels = |k: usize| 30.0 * random(first + k);
    rate_limited_under(dir, (name, first), levels, top_speed)
}

fn random(k: usize) -> f64 {
    (0.7 * (k * k) as f64).sin()
}

/// The same under levels of a choice, by the row in which each begins.
fn rate_limited_under(
    dir: &Path,
    (name, first): (&str, usize),
    levels: impl Fn(usize) -> f64,
    top_speed: f64,
) -> PathBuf {
    let mut rows = "u_deg,y_deg\n".to_owned();
    let (mut at, mut level) = (0.0, 0.0);
    for k in 0..1200 {
        if k % 40 == 30 {
            level = levels(k);
        }
        rows += &format!("{level:.3},{:.4}\n", at + 0.04 * random(first + 7 * k));
        for _ in 0..100 {
            at += 1e-4 * (50.0 * (level - at)).clamp(-top_speed, top_speed);
        }
    }
    let file = dir.join(name);
    std::fs::write(&file, rows).unwrap();
    file
}

/// One servo under stairs that are the same on both sides, and random levels that are not: each answers its own sizes of strokes.
#[test]
fn sides_of_several_references_are_compared_reference_by_reference() {
    let dir = tempfile::tempdir().unwrap();
    let stairs = |k: usize| [-30.0, -15.0, 0.0, 15.0, 30.0, 15.0, 0.0, -15.0][k / 40 % 8];
    let of_side = |side: &str, first: usize, size: f64| {
        let names = [format!("{side}-stairs.csv"), format!("{side}-random.csv")];
        let small = |k: usize| size * random(first + k);
        [
            rate_limited_under(dir.path(), (&names[0], first), stairs, 200.0),
            rate_limited_under(dir.path(), (&names[1], first + 1), small, 200.0),
        ]
    };
    let (a, b) = (of_side("a", 1, 30.0), of_side("b", 5, 6.0));
    let columns = ["--input", "u_deg", "--output", "y_deg", "--period", "0.01"];
    let sides = ["--a", arg(&a[0]), arg(&a[1]), "--b", arg(&b[0]), arg(&b[1])];
    let text = run(&[&["compare", "--no-servo-model"], &sides[..], &columns[..]].concat());
    let text = text.replace('\n', " ");
    assert!(
        text.contains("references differ in their strokes"),
        "{text}"
    );
    assert!(!text.contains("recordings are different"), "{text}");
}

#[test]
fn servos_that_no_step_response_compares_are_compared_as_machines_and_that_is_said_first() {
    let dir = tempfile::tempdir().unwrap();
    let quick = rate_limited(dir.path(), "quick.csv", 1, 300.0);
    let slow = rate_limited(dir.path(), "slow.csv", 2, 250.0);
    let columns = ["--input", "u_deg", "--output", "y_deg", "--period", "0.01"];
    let text = run(&[&["compare", arg(&quick), arg(&slow)], &columns[..]].concat());
    assert!(
        text.replace('\n', " ").contains("  As machines A and B differ in these recordings, each quantity by itself at 99 % and however little: top speed 300.0 deg/s (0.200 s/60°) in A, 250."),
        "{text}"
    );
    // What a record leaves open has no ends that nobody reads.
    assert!(text.contains("not determined"), "{text}");
}

#[test]
fn what_speaks_against_a_recording_takes_the_intervals_of_its_machine_in_a_comparison_too() {
    let dir = tempfile::tempdir().unwrap();
    let sides = ["a.csv", "b.csv"].map(|name| dir.path().join(name));
    for (side, seed) in sides.iter().zip(["5", "6"]) {
        let stairs = [
            "--reference",
            "stairs",
            "--amplitude",
            "20",
            "--length",
            "16",
        ];
        let servo = [
            "simulate",
            "--servo",
            "bench?stops-deg=-30:4",
            "--seed",
            seed,
        ];
        run(&[&servo[..], &stairs, &["-o", arg(side)]].concat());
    }
    let text = run(&[
        "compare",
        "--servo-model",
        "--json",
        arg(&sides[0]),
        arg(&sides[1]),
    ]);
    let document: Value = serde_json::from_str(&text).unwrap();
    let machines = &document["servo_model"];
    assert_eq!(machines["withdrawn"]["reason"], "travel_end", "{machines}");
    assert_eq!(machines["bounds"], Value::Null);
}

#[test]
fn sides_with_different_times_between_samples_are_compared_as_machines_alone() {
    let dir = tempfile::tempdir().unwrap();
    let table = rate_limited(dir.path(), "10.csv", 1, 300.0);
    let models = ["10.json", "20.json"].map(|name| dir.path().join(name));
    let columns = ["--input", "u_deg", "--output", "y_deg", "--period", "0.01"];
    let out = ["--servo-model", "-o", arg(&models[0])];
    run(&[&["identify", "-q", arg(&table)], &columns[..], &out].concat());
    let mut coarser = json(&models[0]);
    coarser["sample_period_s"] = 0.02.into();
    std::fs::write(&models[1], coarser.to_string()).unwrap();
    let compare = ["compare", arg(&models[0]), arg(&models[1])];
    let text = run(&compare);
    let why = "The step responses are not compared, because one side has samples every 10 ms and the other every 20 ms. Rows as far apart on both sides make them comparable, such as every second one of the quicker side.";
    assert!(
        text.contains("\n\nAs machines") && text.replace('\n', " ").contains(why),
        "{text}"
    );
    let document: Value =
        serde_json::from_str(&run(&[&compare[..], &["--json"]].concat())).unwrap();
    assert_eq!(document["verdict"], "undecided");
    assert_eq!(document["summary"], why);
    assert!(document["servo_model"]["quantities"].is_array());
    // Without a servo model on both sides nothing is left, and the error says what would be.
    let mut linear = json(&models[0]);
    linear.as_object_mut().unwrap().remove("servo_model");
    std::fs::write(&models[0], linear.to_string()).unwrap();
    let refused = refusal(&compare);
    assert!(refused.contains("as machines"), "{refused}");
}

#[test]
#[ignore = "ten seconds: cargo test -p servoid --test integration -- --ignored a_plan_says_what_of"]
fn a_plan_says_what_of_the_servo_model_comes_out_determined() {
    let dir = tempfile::tempdir().unwrap();
    let model = modelled(dir.path(), "servo", "bench", &SHORT_STAIRS);
    let plan = |further: &[&str]| -> Value {
        let printed = run(&[&["plan", "--servo", arg(&model), "--json"], further].concat());
        serde_json::from_str(&printed).unwrap()
    };
    let stairs = plan(&SHORT_STAIRS);
    let found = &stairs["servo_model"];
    assert!(stairs["servo"].as_str().unwrap().ends_with("servo.json"));
    assert_eq!(found["bounds"], 0.99);
    let determined = found["quantities"].as_array().unwrap();
    let delay = determined
        .iter()
        .find(|one| one["name"] == "delay")
        .unwrap();
    assert_eq!(delay["determined"], true);
    let two_levels = plan(&[]);
    let found = &two_levels["servo_model"];
    assert!(found["bounds"].is_null());
    let remedy = found["remedies"][0].as_str().unwrap();
    assert!(remedy.contains("more than two levels"), "{remedy}");
}

/// A command in µs and one in degrees move the same servo alike.
#[test]
fn servos_are_compared_by_the_time_of_a_stroke_whatever_the_unit_of_the_command() {
    let dir = tempfile::tempdir().unwrap();
    let path = |name: &str| dir.path().join(name);
    let (recording, degrees, pulses) = (path("a.csv"), path("deg.json"), path("us.json"));
    let simulate = ["simulate", "-q", "--servo", "bench", "-o", arg(&recording)];
    let mut large = SHORT_STAIRS;
    large[5] = "35";
    run(&[&simulate[..], &large].concat());
    let identify = ["identify", "-q", arg(&recording), "--servo-model", "-o"];
    let named = ["--input", "pulse_us", "--output", "position_deg"];
    run(&[&identify[..], &[arg(&degrees)]].concat());
    run(&[&identify[..], &[arg(&pulses)], &named].concat());
    let found: Value =
        serde_json::from_str(&run(&["compare", arg(&degrees), arg(&pulses), "--json"])).unwrap();
    let compared = &found["servo_model"];
    let names: Vec<&str> = compared["quantities"]
        .as_array()
        .unwrap()
        .iter()
        .map(|of| of["name"].as_str().unwrap())
        .collect();
    assert!(
        names.contains(&"delay") && !names.contains(&"gain"),
        "{names:?}"
    );
    let times = |side: &str| {
        let both = compared["stroke"][side].as_array().unwrap();
        both.iter()
            .map(|time| time.as_f64().unwrap())
            .collect::<Vec<_>>()
    };
    // One recording, whose times lie 10 ms apart in no direction.
    for (a, b) in times("a_s").into_iter().zip(times("b_s")) {
        assert!((0.2..0.4).contains(&a) && (a - b).abs() < 0.01, "{a} {b}");
    }
    let text = run(&["compare", "-q", arg(&degrees), arg(&pulses)]);
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    for said in [
        "By the models a stroke of 60 degrees takes",
        "The step responses are not compared, because the command of",
        "A deg.json B us.json",
        "stroke of 60 degrees downwards",
    ] {
        assert!(text.contains(said), "{said}: {text}");
    }
}

/// The structure of both is that of the second, which has no bounds by itself: the first loses its own for that reason.
#[test]
fn bounds_that_one_side_loses_to_the_other_are_lost_for_its_reason() {
    let dir = tempfile::tempdir().unwrap();
    let of = |amplitude: &str, seed: &str| {
        let file = dir.path().join(format!("{amplitude}.csv"));
        let mut stairs = SHORT_STAIRS;
        stairs[5] = amplitude;
        let simulate = [
            "simulate",
            "-q",
            "--servo",
            "bench",
            "--seed",
            seed,
            "-o",
            arg(&file),
        ];
        run(&[&simulate[..], &stairs].concat());
        file
    };
    let [small, large] = [of("8", "1"), of("30", "2")];
    let found: Value =
        serde_json::from_str(&run(&["compare", arg(&small), arg(&large), "--json"])).unwrap();
    assert_eq!(
        found["withdrawn"]["reason"], "errors_not_noise",
        "{}",
        found["withdrawn"]
    );
}
